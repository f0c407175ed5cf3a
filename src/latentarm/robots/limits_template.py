"""A template of a limits file: it states the known limits of a robot and leaves the others blank."""

import json
import re
from collections.abc import Iterator
from typing import Final, cast

from latentarm.robots.limits import QUANTITIES
from latentarm.robots.limits_file import GRIPPER, PER_TIME, TOOL_SPEED, limits_document
from latentarm.robots.robot import Robot

_PLAIN: Final = re.compile(r"[A-Za-z0-9_-]+")


def limits_template(robot: Robot) -> str:
    """The file's text, in TOML; it states nothing that is only assumed."""
    return "\n".join(_lines(robot)) + "\n"


def _lines(robot: Robot) -> Iterator[str]:
    yield f"# Limits of {robot.name.splitlines()[0]}."
    yield "# A line that begins with # is not known: put the maker's figure in it and take away the #."
    yield ""
    yield _line(TOOL_SPEED, robot.tool_speed_limit, known=robot.tool_speed_source != "assumed")
    limits = robot.limits
    for joint, name in enumerate(robot.joint_names):
        yield ""
        yield f"[joints.{name if _PLAIN.fullmatch(name) else json.dumps(name)}]"
        unit = "m" if robot.chain.slide[joint] else "rad"
        known = limits.sources["position"][joint] != "assumed"
        yield _line(f"lower_{unit}", float(limits.lower[joint]), known=known)
        yield _line(f"upper_{unit}", float(limits.upper[joint]), known=known)
        for quantity in QUANTITIES[1:]:
            figure = float(getattr(limits, quantity)[joint])
            known = limits.sources[quantity][joint] != "assumed"
            yield _line(f"{quantity}_{unit}{PER_TIME[quantity]}", figure, known=known)
    if robot.stated_limits is not None and robot.stated_limits.gripper is not None:
        yield ""
        yield "[gripper]"
        gripper = cast("dict[str, object]", limits_document(robot.stated_limits)[GRIPPER])
        yield from (f"{key} = {json.dumps(value)}" for key, value in gripper.items())


def _line(key: str, figure: float, *, known: bool) -> str:
    return f"{key} = {figure!r}" if known else f"# {key} =    # {figure:g} is assumed"
