"""Converts a file's columns and units to a robot's joints in rad, with a record of all decisions."""

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Final

import numpy as np

from latentarm.core.errors import UserError
from latentarm.core.types import Demonstrations, Episode
from latentarm.demonstrations.gripper import (
    ACTION_GRIPPER,
    GRIPPER,
    GRIPPER_OPENING,
    GRIPPER_WIDTH,
    OBSERVED,
    widths_from_toggles,
)
from latentarm.demonstrations.importers.columns import Columns, find_columns, is_width
from latentarm.demonstrations.importers.options import ImportOptions
from latentarm.demonstrations.importers.robot_names import is_so_arm, may_be
from latentarm.demonstrations.importers.source import SourceData
from latentarm.demonstrations.importers.turns import unwrapped
from latentarm.demonstrations.importers.unit_evidence import check_degrees, radians_after_all
from latentarm.demonstrations.importers.units import (
    TARGET_POSITION,
    Conversion,
    Unit,
    conversion,
    parse_units,
)
from latentarm.robots.robot import Robot

PER_JOINT: Final = ("observation.velocity", "observation.effort", "action.human", "action.assist")
LEROBOT_SUFFIX: Final = ".pos"
"""Ends the names of positions of LeRobot's own arms: degrees or -100 to 100, the gripper 0 to 100."""

_OLD_PREFIX: Final = "main_"
_EARLIER: Final = "before: "  # marks decisions of an earlier import of the same data


def translate(data: SourceData, robot: Robot, told: ImportOptions, source: str) -> Demonstrations:
    """A file's demonstrations in the robot's joints and order, rad and rad/s.

    The gripper and commanded positions become features; ``import_record`` holds all decisions.
    """
    given = data.demonstrations
    _check_robot(given.robot, robot, told.recorded_on, source)
    if not 0.0 <= told.clip_rad < np.pi:
        raise UserError(f"--clip-rad is {told.clip_rad:g}: give a distance from 0 to pi.")
    names = given.joint_names
    columns = find_columns(names, robot.joint_names, told.joints, told.gripper, source)
    suffixed = any(names[index].endswith(LEROBOT_SUFFIX) for index in columns.joints)
    motors = not data.in_rad and (suffixed or is_so_arm(given.robot))
    if motors and not told.joints and all(names[index].startswith(_OLD_PREFIX) for index in columns.joints):
        raise UserError(
            f"{source}: LeRobot named columns {_OLD_PREFIX}* before June 2025, when zero was the arm"
            " stretched out and not the middle of each range: convert the positions first, then name the"
            " columns with --joints."
        )
    units, how = _units(data, robot, told, columns, motors, source)
    turned = conversion(
        units, robot.joint_names, robot.limits, robot.chain.slide, full_turn=is_so_arm(given.robot)
    )
    kind = data.actions if told.actions == "known" else told.actions.removeprefix("joint_")
    found = None if columns.gripper is None else _gripper_feature(names[columns.gripper], motors, robot)
    gripper, per_unit = found or ("", 1.0)
    episodes = tuple(_episode(one, columns, turned, kind, gripper, per_unit) for one in given.episodes)
    episodes, turns = unwrapped(episodes, robot)
    episodes, clipped = _clipped(episodes, robot, told.clip_rad)
    episodes, opening = widths_from_toggles(episodes, robot.gripper, told.gripper_starts, source)
    record = {
        "source": f"{Path(source).name}, {data.layout}",
        "recorded on": given.robot or "not said",
        "joints": f"{_pairs(robot, names, columns)} ({columns.how})",
        "units": how,
        "gripper": opening or _gripper_text(given, columns, gripper, motors, robot),
        "columns left out": ", ".join(names[index] for index in columns.dropped) or "none",
        "actions": _action_text(given.episodes[0], kind) if given.episodes else "none",
    }
    record |= {subject: said for subject, said in (("turns", turns), ("clipped", clipped)) if said}
    record |= data.record
    record |= {
        subject if subject.startswith(_EARLIER) else f"{_EARLIER}{subject}": decision
        for subject, decision in given.import_record.items()
    }
    warning = radians_after_all(given, columns.joints, units, robot)
    if warning:
        record["warning"] = "; ".join(filter(None, (record.get("warning"), warning)))
    return replace(
        given,
        episodes=episodes,
        robot=robot.name,
        joint_names=robot.joint_names,
        end_effector=robot.end_effector,
        limits=robot.stated_limits,
        import_record=record,
    )


def _check_robot(named: str, robot: Robot, recorded_on: str | None, source: str) -> None:
    if recorded_on is not None and recorded_on != named:
        raise UserError(f"{source} says that it was recorded on {named!r}, not on {recorded_on!r}.")
    if named and recorded_on is None and not may_be(named, robot):
        raise UserError(
            f"{source} says that it was recorded on {named!r}, and the robot is {robot.name}: name the robot"
            f" that was recorded with --robot, or pass --recorded-on {named} if these are the same."
        )


def _units(
    data: SourceData, robot: Robot, told: ImportOptions, columns: Columns, motors: bool, source: str
) -> tuple[list[Unit], str]:
    """A unit for each joint, and how they are known."""
    general, single = parse_units(told.units, robot.joint_names)
    missing = any(joint not in single for joint in robot.joint_names)
    if missing and general is None and motors and not data.in_rad:
        raise UserError(
            f"{source} does not say its units, and LeRobot records these joints in degrees or from -100 to"
            " 100 alike: say which with --units deg (recorded with use_degrees=true) or --units normalized."
        )
    units: list[Unit] = [single.get(joint, general or "rad") for joint in robot.joint_names]
    if told.units:
        how = "as told"
    else:
        how = "said by the file or its layout" if data.in_rad else "assumed: the file does not say"
    check_degrees(data.demonstrations, columns.joints, units, robot, source)
    each = ", ".join(map("=".join, zip(robot.joint_names, units, strict=True)))
    named = units[0] if len(set(units)) == 1 else each
    text = f"{named} ({how}), stored in rad"
    if "normalized" in units:
        text += "; -100 to 100 is assumed to be each joint's range in the robot's model"
        if is_so_arm(data.demonstrations.robot):
            text += ", and a full turn for wrist_roll, as LeRobot calibrates it"
    return units, text


def _gripper_feature(column: str, motors: bool, robot: Robot) -> tuple[str, float]:
    """The feature for the gripper's column, and the factor to its unit."""
    if motors:
        opens = robot.gripper
        return (GRIPPER_OPENING, 0.01) if opens is None else (GRIPPER_WIDTH, 0.01 * opens.width_m)
    return (GRIPPER_WIDTH if is_width(column) else GRIPPER), 1.0


def _episode(
    episode: Episode, columns: Columns, turned: Conversion, kind: str, gripper: str, per_unit: float
) -> Episode:
    if episode.state.ndim != 2:
        return episode  # validation says what is wrong
    joints, width = list(columns.joints), episode.state.shape[1]
    extras = dict(episode.extras)
    for name in PER_JOINT:
        if name in extras and extras[name].ndim == 2 and extras[name].shape[1] == width:
            picked = extras[name][:, joints]
            extras[name] = picked if name == "observation.effort" else turned.rates(picked)
    if columns.gripper is not None:
        extras[gripper] = per_unit * episode.state[:, [columns.gripper]]
    action = episode.action
    if action is not None and kind != "unknown" and action.ndim == 2 and action.shape[1] == width:
        if columns.gripper is not None and np.isfinite(action[:, columns.gripper]).all():
            extras[ACTION_GRIPPER] = per_unit * action[:, [columns.gripper]]
        if kind == "position":
            extras[TARGET_POSITION] = turned.positions(action[:, joints])
        action = turned.rates(action[:, joints]) if kind == "velocity" else None
    elif kind != "velocity":
        action = None
    return replace(episode, state=turned.positions(episode.state[:, joints]), action=action, extras=extras)


def _clipped(episodes: tuple[Episode, ...], robot: Robot, clip_rad: float) -> tuple[tuple[Episode, ...], str]:
    """Move positions a little outside the limits to them, and count these."""
    if clip_rad == 0.0:
        return episodes, ""
    limits = robot.limits
    moved, largest, kept = 0, 0.0, list[Episode]()
    for episode in episodes:
        excess = limits.violation(episode.state)
        near = (excess > 0.0) & (excess <= clip_rad)
        moved += int(near.any(axis=1).sum())
        largest = max(largest, float(excess[near].max(initial=0.0)))
        state = np.where(near, np.clip(episode.state, limits.lower, limits.upper), episode.state)
        kept.append(replace(episode, state=state))
    text = f"{moved} samples were up to {largest:.3f} rad outside the joint limits and were moved to them"
    return tuple(kept), text if moved else "no sample was outside the joint limits"


def _pairs(robot: Robot, names: Sequence[str], columns: Columns) -> str:
    return ", ".join(
        joint if joint == names[index] else f"{joint} = {names[index]}"
        for joint, index in zip(robot.joint_names, columns.joints, strict=True)
    )


def _gripper_text(given: Demonstrations, columns: Columns, feature: str, motors: bool, robot: Robot) -> str:
    if columns.gripper is None:
        extras = given.episodes[0].extras if given.episodes else {}
        return ", ".join(name for name in OBSERVED if name in extras) or "none"
    column = given.joint_names[columns.gripper]
    if feature == GRIPPER_OPENING:
        return f"{column}, 0 to 100, stored as {GRIPPER_OPENING} from 0 (closed) to 1 (open)"
    if motors and robot.gripper is not None:
        most = f"{robot.gripper.width_m:g} m"
        return f"{column}, 0 to 100, stored as {GRIPPER_WIDTH} from 0 to {most}, taken to grow evenly"
    if feature == GRIPPER_WIDTH:
        return f"{column}, stored as {GRIPPER_WIDTH}, m by its name"
    return f"{column}, stored as {GRIPPER} as recorded: its unit is not known"


def _action_text(first: Episode, kind: str) -> str:
    if first.action is None:
        return "none in the file that could be joint velocities; taken from the states' displacements"
    if kind == "velocity":
        return "joint velocities, rad/s"
    if kind == "position":
        stored = f"target positions, stored as {TARGET_POSITION}"
        return f"{stored}; velocities come from the states' displacements"
    return "left out: the file does not say what they are (--actions takes your word); taken from the states"
