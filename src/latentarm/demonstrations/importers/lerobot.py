"""Importing datasets of LeRobot (layouts v2.0, v2.1 and v3.0) or `write_dataset`."""

from dataclasses import replace
from pathlib import Path
from typing import Final

from latentarm.demonstrations.importers.source import ActionKind, SourceData
from latentarm.demonstrations.info import ACTION, OLDER_VERSIONS, STATE, Info, read_info
from latentarm.demonstrations.reader import read_episodes, read_episodes_v2

PLUGIN: Final = "latentarm"
"""LeRobot's name for the robot of `lerobot_robot_latentarm`, whatever arm it drives: positions in rad, the
gripper's width in m."""


def read_lerobot(source: Path) -> SourceData:
    """Read a dataset of a LeRobotDataset layout.

    Float vectors are kept; pictures, video, text and integers are omitted. The layout states neither the unit
    of positions nor the meaning of actions; columns called ``*.pos``, as by LeRobot's own robots, are target
    positions.
    """
    info = read_info(source)
    episodes = (read_episodes_v2 if info.version in OLDER_VERSIONS else read_episodes)(source, info)
    by_plugin = info.about.robot == PLUGIN
    kind = None if by_plugin else _actions(info)
    if kind is None:
        episodes = tuple(replace(episode, action=None) for episode in episodes)
    return SourceData(
        replace(info.about, episodes=episodes, robot="" if by_plugin else info.about.robot),
        layout=_layout(info),
        in_rad=info.native or by_plugin,
        actions=kind or "unknown",
    )


def _layout(info: Info) -> str:
    if info.native:
        return "dataset of this package"
    return f"LeRobot {info.version}{', recorded through latentarm' if info.about.robot == PLUGIN else ''}"


def _actions(info: Info) -> ActionKind | None:
    """The kind of the actions; None where they are not about the columns of the states."""
    if info.native:
        return "velocity"
    names = {feature.name: feature.names for feature in info.features}
    widths = {feature.name: feature.width for feature in info.features}
    if widths.get(ACTION) != widths[STATE]:
        return None
    commanded = names[ACTION] or ()
    positions = commanded == names[STATE] and all(name.endswith(".pos") for name in commanded)
    return "position" if commanded and positions else "unknown"
