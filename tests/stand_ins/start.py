"""Start what stands in for an arm, print the command that looks at it, and end it with Ctrl-D.

python tests/stand_ins/start.py franka, lerobot, ros2 or xarm
"""

import json
import sys
from collections.abc import Callable
from contextlib import ExitStack
from pathlib import Path
from tempfile import TemporaryDirectory

TESTS = Path(__file__).parents[1]
sys.path.insert(0, str(TESTS))

MOTORS = ("shoulder_pan", "shoulder_lift", "elbow_flex", "wrist_flex", "wrist_roll", "gripper")


def franka(until: ExitStack) -> str:
    """Franky's own simulation, which needs `latentarm[franka,franka-sim]` and an idle computer."""
    from franka_server import FrankaStandIn

    server = until.enter_context(FrankaStandIn("127.0.7.1"))
    return f"'franka://{server.host}?realtime=ignore' --robot fr3"


def lerobot(until: ExitStack) -> str:
    """Servos of an SO-101 on a serial port. Its model is a file to get, see docs/your-arm/lerobot.md."""
    from arms.feetech_bus import FeetechBus

    bus = until.enter_context(FeetechBus())
    calibration = Path(until.enter_context(TemporaryDirectory())) / "calibration.json"
    ranges = {"drive_mode": 0, "homing_offset": 0, "range_min": 1000, "range_max": 3000}
    calibration.write_text(json.dumps({name: {"id": 1 + n, **ranges} for n, name in enumerate(MOTORS)}))
    address = f"lerobot://so101_follower?port={bus.port}&calibration={calibration}"
    limits = TESTS.parent / "docs" / "your-arm" / "so101_limits.toml"
    return f"'{address}' --robot so101_new_calib.xml --limits {limits}"


def ros2(until: ExitStack) -> str:
    """An FR3 behind rosbridge, with the watchdog."""
    from rosbridge_server import RosbridgeServer

    from latentarm.robots.panda import fr3

    server = until.enter_context(RosbridgeServer(fr3()))
    return f"'{server.address}' --robot fr3"


def xarm(until: ExitStack) -> str:
    """The controller of an xArm 7."""
    from arms.xarm_server import serving

    server = until.enter_context(serving(q=[0.0, -0.4, 0.0, 0.9, 0.0, 1.3, 0.0]))
    model = TESTS / "arms" / "xarm7.xml"
    return f"'{server.address()}' --robot {model} --limits {model.with_suffix('.toml')} --joint-speed 0.3"


KNOWN: dict[str, Callable[[ExitStack], str]] = {
    "franka": franka,
    "lerobot": lerobot,
    "ros2": ros2,
    "xarm": xarm,
}

if __name__ == "__main__":
    if len(sys.argv) != 2 or sys.argv[1] not in KNOWN:
        sys.exit(f"Name one of {', '.join(KNOWN)}.")
    with ExitStack() as stack:
        sys.stdout.write(f"latentarm arms check {KNOWN[sys.argv[1]](stack)}\n")
        sys.stdout.flush()
        sys.stdin.read()
