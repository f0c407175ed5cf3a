"""`latentarm doctor`: this computer and the way to the arm, before somebody drives."""

import json as json_format
import subprocess
import sys
import threading
from collections.abc import Iterable
from dataclasses import asdict
from pathlib import Path
from typing import Annotated, Final

from tyro.conf import arg

from latentarm.commands.options import LimitsFile
from latentarm.commands.output import say
from latentarm.core.errors import UserError
from latentarm.core.journal_limits import JournalLimits
from latentarm.core.machine import Finding, examine_machine
from latentarm.core.untrusted.terminal import one_line
from latentarm.runs.options import EndEffector, Json

ARM_WITHIN_S: Final = 30.0
GL_WITHIN_S: Final = 30.0
_MEASURED_S: Final = 3.0
_CODES: Final = {"good": 0, "warning": 1, "fault": 2}

# In a process of its own: a driver that is missing may end it.
_DRAW: Final = """
try:
    import mujoco
except Exception as error:
    raise SystemExit(f"MuJoCo does not load: {error}") from error
from OpenGL import GL
model = mujoco.MjModel.from_xml_string("<mujoco><worldbody><geom size='1'/></worldbody></mujoco>")
with mujoco.Renderer(model, 16, 16) as renderer:
    renderer.update_scene(mujoco.MjData(model))
    renderer.render()
    print(GL.glGetString(GL.GL_RENDERER).decode())
"""


def lines_of(findings: Iterable[Finding]) -> list[str]:
    """A line for each finding: what was found, what it means and what to do."""
    return [f"{one.name}: {one.found}.{f' {one.means}' if one.means else ''}" for one in findings]


def look_at_gl() -> Finding:
    """Draw a picture with MuJoCo."""
    words = [sys.executable, "-c", _DRAW]
    try:
        drawn = subprocess.run(words, capture_output=True, text=True, timeout=GL_WITHIN_S, check=False)
    except subprocess.TimeoutExpired:
        said = ["no picture in time"]
    else:
        if drawn.returncode == 0:
            return Finding("GL", f"draws with {one_line(drawn.stdout.strip())}")
        said = drawn.stderr.strip().splitlines()[-1:] or [f"code {drawn.returncode}"]
    if said[0].startswith("MuJoCo does not load"):
        means = "Nothing of latentarm starts: unset MUJOCO_GL, or install the library of what it names."
        return Finding("GL", one_line(said[0]), "fault", means)
    means = (
        "Only films of simulated drives need it, not the page: set MUJOCO_GL=egl (or osmesa) and install"
        " its library, such as libegl1 and libgl1-mesa-dri."
    )
    return Finding("GL", f"draws nothing ({one_line(said[0])})", "good", means)


def look_at_port(host: str, port: int) -> Finding:
    """Listen where the page would be, for a moment."""
    from latentarm.web.arm_process.drive_setup import Spec
    from latentarm.web.server.config import TeleopConfig, listen

    try:
        listen(TeleopConfig(Spec(), host, port)).close()
    except UserError as error:
        return Finding("port", f"{host}:{port} cannot be used", "fault", str(error))
    return Finding("port", f"{host}:{port} is free")


def look_at_arm(
    address: str, run: Path | None, robot: str | None, end_effector: str | None, limits: Path | None
) -> Finding:
    """Look at an arm as `arms check` does, which commands nothing."""
    from latentarm.commands.arms import check_arm_at
    from latentarm.web.arm_process.initial_state import RobotOptions
    from latentarm.web.arm_process.speed_limits import Speeds

    said: list[str] = [f"{address} has not answered for {ARM_WITHIN_S:g} s: check power, cable and address."]

    def check() -> None:
        try:
            named = RobotOptions(robot, end_effector, limits)
            said[:] = check_arm_at(address, run, named, Speeds()).refusals
        except UserError as error:
            said[:] = [str(error)]

    checking = threading.Thread(target=check, daemon=True)
    checking.start()
    checking.join(ARM_WITHIN_S)
    if refusals := list(said):
        return Finding("arm", f"{address} cannot be driven", "fault", " ".join(refusals))
    return Finding("arm", f"{address} answers and can be driven")


def doctor(
    run: Annotated[Path | None, arg(metavar="RUN", help="A trained run that the arm is driven with.")] = None,
    arm: Annotated[
        str | None, arg(metavar="URL", help="A real arm to look at, as `arms check` does; nothing moves.")
    ] = None,
    robot: Annotated[str | None, arg(help="Its name or model file, where there is no run.")] = None,
    end_effector: EndEffector = None,
    limits: LimitsFile = None,
    host: Annotated[str, arg(help="The page's address, as for teleop.")] = "127.0.0.1",
    port: Annotated[int, arg(help="The page's port, as for teleop.")] = 8460,
    out: Annotated[Path, arg(metavar="DIR", help="Folder for what is recorded, as for teleop.")] = Path(
        "teleop"
    ),
    json: Json = False,
) -> int:
    """Look at this computer: priority, cores, pauses, clock, disk, GL, and the port; and at an arm.

    Exit code 1 for what matters with a real arm, 2 for what must be changed first. For example:
    latentarm doctor --arm franka://172.16.0.2 --robot fr3
    """
    found = [*examine_machine(out, JournalLimits().least_free_bytes, _MEASURED_S), look_at_gl()]
    if found[-1].level != "fault":  # else the rest cannot be imported
        found.append(look_at_port(host, port))
        if arm is not None:
            found.append(look_at_arm(arm, run, robot, end_effector, limits))
    if json:
        print(json_format.dumps([asdict(one) for one in found], indent=2))
    else:
        for one, line in zip(found, lines_of(found), strict=True):
            say(f"{one.level:8} {line}", json)
    return max(_CODES[one.level] for one in found)
