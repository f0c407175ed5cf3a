"""`latentarm robots`: the properties of a robot."""

import json as json_format
from pathlib import Path
from typing import Annotated

from rich.table import Table
from tyro.conf import Positional, arg

from latentarm.commands.options import LimitsFile
from latentarm.commands.output import print_renderables, say
from latentarm.core.errors import UserError
from latentarm.core.files import write_text
from latentarm.core.types import FloatArray
from latentarm.core.untrusted.opening import is_missing
from latentarm.robots.limits import QUANTITIES, Quantity, Source
from latentarm.robots.notices import assumed_limits, notices
from latentarm.robots.robot import Robot
from latentarm.runs.options import EndEffector, Json

_SOURCES: dict[Source, str] = {
    "model": "from the model",
    "manufacturer": "from the manufacturer",
    "limits_file": "from the limits file",
    "assumed": "assumed",
}


def _robots(name: str | None, end_effector: str | None, limits: Path | None) -> list[Robot]:
    """One robot by name or model file, or all built-in ones."""
    from latentarm.robots.catalogue import ROBOTS, load_robot
    from latentarm.robots.limits_file import read_limits

    if name is None and (end_effector or limits):
        raise UserError(
            "An end-effector and limits belong to one robot: name it, as in `latentarm robots PATH`."
        )
    stated = None if limits is None else read_limits(limits)
    return [load_robot(one, end_effector, stated) for one in ([name] if name is not None else list(ROBOTS))]


def _written(name: str | None, end_effector: str | None, limits: Path | None, path: Path) -> str:
    """Write a robot's limits file; what is left to fill in, a sentence."""
    from latentarm.robots.limits_template import limits_template

    if name is None:
        raise UserError("--write-limits is for one robot: name it, as in `latentarm robots PATH`.")
    if path.suffix.lower() != ".toml":
        raise UserError(f"{path} must be a TOML file: name it .toml.")
    if not is_missing(path):
        raise UserError(f"{path} is there already: name a new file.")
    (robot,) = _robots(name, end_effector, limits)
    write_text(path, limits_template(robot))
    missing = assumed_limits(robot)
    return f"Wrote {path}. " + (f"Fill in: {missing}." if missing else "It states all limits.")


def _overview(robots: list[Robot]) -> Table:
    table = Table("robot", "joints", "arms", "joint speed limits, rad/s", title="Built-in robots")
    for robot in robots:
        low, high = robot.limits.velocity.min(), robot.limits.velocity.max()
        table.add_row(robot.name, str(robot.dof), str(len(robot.chain.tools)), f"{low:.3g} to {high:.3g}")
    table.caption = "Any MJCF or URDF file works too: latentarm robots PATH --end-effector NAME"
    return table


def _facts(robot: Robot) -> dict[str, object]:
    limits = robot.limits
    return {
        "name": robot.name,
        "end_effectors": [tool.name for tool in robot.chain.tools],
        "tool_speed_limit_m_per_s": robot.tool_speed_limit,
        "tool_speed_source": robot.tool_speed_source,
        "still_joints": list(robot.still_joints),
        "joints": [
            {
                "name": joint,
                "prismatic": bool(robot.chain.slide[index]),
                "lower": float(limits.lower[index]),
                "upper": float(limits.upper[index]),
                "velocity": float(limits.velocity[index]),
                "acceleration": float(limits.acceleration[index]),
                "jerk": float(limits.jerk[index]),
                "home": float(robot.home[index]),
                "source": {quantity: limits.sources[quantity][index] for quantity in QUANTITIES},
            }
            for index, joint in enumerate(robot.joint_names)
        ],
        "capsules": len(robot.capsules.name),
        "self_pairs": len(robot.self_pairs),
        "notices": notices(robot),
    }


def _sheet(robot: Robot) -> Table:
    table = Table(title=robot.name)
    for heading in ("joint", "lower", "upper", "home", "velocity", "acceleration", "jerk"):
        table.add_column(heading, justify="left" if heading == "joint" else "right")
    limits = robot.limits
    figures: tuple[tuple[FloatArray, Quantity | None], ...] = (
        (limits.lower, "position"),
        (limits.upper, "position"),
        (robot.home, None),
        (limits.velocity, "velocity"),
        (limits.acceleration, "acceleration"),
        (limits.jerk, "jerk"),
    )
    for index, joint in enumerate(robot.joint_names):
        cells: list[str] = []
        for figure, quantity in figures:
            assumed = quantity is not None and limits.sources[quantity][index] == "assumed"
            cells.append(f"{figure[index]:.4g}{' assumed' if assumed else ''}")
        table.add_row(joint, *cells)
    tools = ", ".join(tool.name for tool in robot.chain.tools)
    assumed = " (assumed)" if robot.tool_speed_source == "assumed" else ""
    table.caption = (
        f"end-effector: {tools}; limits in rad, rad/s, rad/s², rad/s³ (m for a sliding joint);"
        f" {_known_from(robot)}; tool at most {robot.tool_speed_limit:g} m/s{assumed};"
        f" {len(robot.capsules.name)} capsules, {len(robot.self_pairs)} pairs of them watched"
        + "".join(f"\n{sentence}" for sentence in notices(robot))
    )
    return table


def _known_from(robot: Robot) -> str:
    """The sources of the limits, such as "position: from the model; jerk: assumed"."""
    texts: dict[str, list[str]] = {}
    for quantity in QUANTITIES:
        sources = dict.fromkeys(robot.limits.sources[quantity])
        texts.setdefault(" or ".join(_SOURCES[source] for source in sources), []).append(quantity)
    return "; ".join(f"{', '.join(quantities)}: {text}" for text, quantities in texts.items())


def robots(
    robot: Annotated[
        Positional[str | None],
        arg(metavar="ROBOT", help="One robot, by name or path; all known ones without."),
    ] = None,
    end_effector: EndEffector = None,
    limits: LimitsFile = None,
    write_limits: Annotated[
        Path | None,
        arg(metavar="FILE", help="Write a new limits file to fill in: a TOML file with what is known."),
    ] = None,
    json: Json = False,
) -> int:
    """List the robots, or show one: joints, limits and end-effector.

    For example: latentarm robots panda
    """
    if write_limits is not None:
        say(_written(robot, end_effector, limits, write_limits), json)
        return 0
    found = _robots(robot, end_effector, limits)
    if json:
        print(json_format.dumps([_facts(one) for one in found], indent=2))
    else:
        print_renderables(_overview(found) if robot is None else _sheet(found[0]))
    return 0
