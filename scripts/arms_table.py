"""Load every arm of scripts/arms.toml in a process of its own, within 4 GB and 60 s, and write docs/arms.md.

    python scripts/fetch_arms.py && python scripts/arms_table.py [--check]

With --check nothing is written; the exit code is 1 where an arm does not do what arms.toml says.
"""

import json
import os
import resource
import subprocess
import sys
import time
import tomllib
from pathlib import Path
from typing import Any

ARMS = Path(__file__).with_name("arms.toml")
CACHE = Path(os.environ.get("LATENTARM_ARMS") or Path.home() / ".cache" / "latentarm" / "arms")
PAGE = Path(__file__).parents[1] / "docs" / "arms.md"
BEGIN, END = "<!-- arms: written by scripts/arms_table.py -->", "<!-- arms: end -->"
MEMORY_BYTES = 4 * 1024**3
DEADLINE_S = 60.0


def measure(path: Path, end_effector: str | None) -> None:
    """The child: load one arm and print what came of it."""
    import mujoco

    from latentarm.core.errors import UserError
    from latentarm.robots.catalogue import load_robot
    from latentarm.robots.limits import QUANTITIES

    before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    began = time.process_time()
    try:
        robot = load_robot(str(path), end_effector)
    except UserError as error:
        print(json.dumps({"refused": str(error).removeprefix(f"{path}: ")}))
        return
    took_s = time.process_time() - began
    peak_mb = (resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before) / 1024
    kinds = (int(mujoco.mjtJoint.mjJNT_HINGE), int(mujoco.mjtJoint.mjJNT_SLIDE))
    known = [quantity for quantity in QUANTITIES if set(robot.limits.sources[quantity]) == {"model"}]
    print(
        json.dumps(
            {
                "joints": robot.dof,
                "model_joints": sum(kind in kinds for kind in robot.model().jnt_type),
                "end_effector": robot.chain.tools[0].name,
                "known": known,
                "capsules": len(robot.capsules),
                "took_s": took_s,
                "peak_mb": peak_mb,
            }
        )
    )


def load(arm: dict[str, Any], packages: dict[str, Any]) -> dict[str, Any]:
    """What came of one arm."""
    path = CACHE / f"{arm['package']}-{packages[arm['package']]['version']}" / arm["file"]
    if not path.is_file():
        sys.exit(f"{path} is not there: run `python scripts/fetch_arms.py` first.")
    words = [sys.executable, __file__, "--one", str(path), arm.get("end_effector", "")]
    try:
        done = subprocess.run(
            words,
            capture_output=True,
            text=True,
            check=False,
            timeout=DEADLINE_S,
            preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_AS, (MEMORY_BYTES, MEMORY_BYTES)),
        )
    except subprocess.TimeoutExpired:
        return {"refused": f"Not loaded within {DEADLINE_S:.0f} s."}
    if done.returncode:
        return {"refused": f"Failed: {(done.stderr.strip().splitlines() or ['no word'])[-1]}"}
    found: dict[str, Any] = json.loads(done.stdout)
    return found


def row(arm: dict[str, Any], version: str, found: dict[str, Any]) -> str:
    """One line of the table."""
    name, source = arm["name"], f"{arm['package']} {version}"
    if "refused" in found:
        sentence = found["refused"].replace(str(CACHE), "").replace("|", "\\|")
        short = sentence if len(sentence) < 240 else f"{sentence[:240]} ..."
        return f"| {name} | {source} | no | | | | | | {short} |"
    known = ", ".join(found["known"]) or "none"
    passed = f"`--end-effector {arm['end_effector']}`" if "end_effector" in arm else "nothing"
    shape = "" if found["capsules"] else "; no shape in the model, so no collisions are watched for"
    joints = f"{found['joints']} of {found['model_joints']}"
    return (
        f"| {name} | {source} | yes | {joints} | {found['end_effector']} |"
        f" {known} | {found['took_s']:.1f} | {found['peak_mb']:.0f} | {passed}{shape} |"
    )


def expected(arm: dict[str, Any], found: dict[str, Any]) -> bool:
    """Whether the arm does what arms.toml says of it."""
    if "refused" in arm:
        return arm["refused"] in found.get("refused", "")
    return found.get("joints") == arm["joints"]


def main() -> int:
    """Load all arms and write the table."""
    document = tomllib.loads(ARMS.read_text(encoding="utf-8"))
    lines = [
        "| arm | package | loads | joints driven of those in the model | end-effector | limits from the model"
        " (all others assumed) | s | MB | what to pass, or the sentence it gets |",
        "|---|---|---|---|---|---|--:|--:|---|",
    ]
    surprises = 0
    for arm in document["arm"]:
        found = load(arm, document["packages"])
        surprises += not expected(arm, found)
        lines.append(row(arm, document["packages"][arm["package"]]["version"], found))
        print(lines[-1], flush=True)
    if "--check" not in sys.argv:
        page = PAGE.read_text(encoding="utf-8")
        before, after = page[: page.index(BEGIN)], page[page.index(END) :]
        PAGE.write_text(f"{before}{BEGIN}\n\n" + "\n".join(lines) + f"\n\n{after}", encoding="utf-8")
    return 1 if surprises else 0


if __name__ == "__main__":
    if sys.argv[1:2] == ["--one"]:
        measure(Path(sys.argv[2]), sys.argv[3] or None)
    else:
        sys.exit(main())
