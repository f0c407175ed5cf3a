"""`latentarm arms`: the arms that there are, and checks of a real one before it moves."""

import json as json_format
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from shlex import join
from typing import TYPE_CHECKING, Annotated, Final

from rich.table import Column, Table
from tyro.conf import Positional, arg

from latentarm.arms.address import is_address
from latentarm.arms.catalogue import ARMS, REAL_ARMS, address_form, make_real_arm
from latentarm.arms.checking import look_at
from latentarm.arms.real import Findings
from latentarm.commands.options import JointSpeed, LimitsFile, LinkSpeed, ZonesFile
from latentarm.commands.output import print_renderables, refuse, say
from latentarm.control.clock import MonotonicClock
from latentarm.core.errors import UserError
from latentarm.runs.options import EndEffector, Json
from latentarm.web.arm_process.speed_limits import Speeds

if TYPE_CHECKING:
    from latentarm.web.arm_process.initial_state import RobotOptions

FIRST_RAD_S: Final = 0.2
FIRST_M_PER_S: Final = 0.05  # limits for a first drive


def check_arm_at(
    address: str,
    run: Path | None,
    robot: "RobotOptions",
    speeds: Speeds,
    guide: Callable[[str], None] | None = None,
    zones: Path | None = None,
) -> Findings:
    """Check a real arm, such as ``franka://172.16.0.2``, before it is driven from the page; nothing moves.

    ``robot`` describes the arm where there is no run. ``guide`` compares its tool pose at three more poses,
    see `latentarm.commands.guided_check.look_guided`. ``zones`` is a file to tell the distances from. Raises
    UserError where the address, the run, the robot or the zones cannot be used; a refusal by the arm is among
    the findings instead.
    """
    from latentarm.commands.abilities import abilities
    from latentarm.commands.guided_check import look_guided
    from latentarm.commands.zone_check import with_distances, zones_for
    from latentarm.runs.folder import read_run
    from latentarm.web.arm_process.drive_setup import PERIOD_S, Spec, load_setup
    from latentarm.web.arm_process.initial_state import begin_real

    if not is_address(address):
        raise UserError(
            f"{address} is not the address of a real arm: `latentarm arms list` shows their form."
        )
    stated = zones_for(zones, speeds)
    trained = None if run is None else read_run(run)
    driven = begin_real(trained, None if trained is None else trained.task, 0, robot).place.robot
    facts, refusals = abilities(driven, speeds)
    if not refusals:
        load_setup(Spec(run, arm=address, robot=robot, speeds=speeds))  # what else could be in the way
    arm = make_real_arm(address, driven, MonotonicClock().now_s)
    try:
        found = look_at(arm, driven, PERIOD_S)
        if guide is not None and not found.refusals:
            by_hand = look_guided(address, driven, guide)
            found = replace(found, facts=(*found.facts, *by_hand.facts), refusals=by_hand.refusals)
        if zones is not None and not found.refusals:
            arm.watch()
            found = with_distances(found, stated, driven, arm.read().q)
    except UserError as error:
        found = Findings((), (str(error),))
    finally:
        arm.close()
    return replace(found, facts=(*found.facts, *facts), refusals=(*refusals, *found.refusals))


def _ask(what: str) -> None:
    """Say what to do and wait for Enter."""
    try:
        input(f"{what} Then press Enter: ")
    except EOFError as error:
        raise UserError("--guided asks a person: run it in a terminal.") from error


def check(
    address: Annotated[Positional[str], arg(metavar="URL", help="Where the arm is: SCHEME://HOST[:PORT].")],
    run: Annotated[
        Positional[Path | None], arg(metavar="RUN", help="A trained run that the arm is to be driven with.")
    ] = None,
    robot: Annotated[
        str | None,
        arg(help="A robot's name or the path of an MJCF or URDF file; that of the run, where one is named."),
    ] = None,
    end_effector: EndEffector = None,
    limits: LimitsFile = None,
    zones: ZonesFile = None,
    joint_speed: JointSpeed = None,
    link_speed: LinkSpeed = None,
    guided: Annotated[
        bool, arg(help="Then let go of the arm, for you to move it by hand to three more poses, and compare.")
    ] = False,
    json: Json = False,
) -> int:
    """Look at a real arm without moving it: what it is, whether it can be driven, and if not, why.

    Exits with 2 where it is refused. For example:
    latentarm arms check franka://172.16.0.2 --robot fr3
    """
    from latentarm.web.arm_process.initial_state import RobotOptions

    speeds = Speeds.asked(joint_speed, link_speed)
    named = RobotOptions(robot, end_effector, limits)
    found = check_arm_at(address, run, named, speeds, _ask if guided else None, zones)
    if json:
        facts = [{"name": fact.name, "value": fact.value} for fact in found.facts]
        told = {"address": address, "facts": facts, "notices": found.notices, "refusals": found.refusals}
        print(json_format.dumps(told, indent=2))
    elif found.facts:
        table = Table("what", Column("found", overflow="fold"), title=address)
        for fact in found.facts:
            table.add_row(fact.name, fact.value)
        print_renderables(table)
    for notice in found.notices:
        say(notice, json)
    if found.refusals:
        refuse(found.refusals)
        return 2
    slowly = speeds == Speeds.asked(None, None)
    options = {
        "--arm": address,
        "--robot": robot,
        "--end-effector": end_effector,
        "--limits": limits,
        "--zones": zones,
        "--joint-speed": FIRST_RAD_S if slowly else joint_speed,
        "--link-speed": FIRST_M_PER_S if slowly else link_speed,
    }
    given = [word for name, value in options.items() if value is not None for word in (name, str(value))]
    words = join(["latentarm", "teleop", *([] if run is None else [str(run)]), *given])
    first = " slowly, as is right for a first drive" if slowly else ""
    say(f"It can be driven. Nothing was moved. To drive it{first}: {words}", json)
    say("Add --shadow to that line at first: it does all but send.", json)
    return 0


def list_arms(json: Json = False) -> int:
    """List what `--arm` takes: simulated arms by name, real ones by the scheme of their address.

    For example: latentarm arms list
    """
    if json:
        print(json_format.dumps({"simulated": list(ARMS), "real": list(REAL_ARMS)}, indent=2))
        return 0
    table = Table("--arm", "what it is")
    for name in ARMS:
        table.add_row(name, "simulated")
    for name in REAL_ARMS:
        table.add_row(address_form(name), "real")
    print_renderables(table)
    return 0
