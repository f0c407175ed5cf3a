"""Importing datasets that LeRobot (layout v3.0) or `write_dataset` wrote."""

from dataclasses import replace
from pathlib import Path
from typing import Literal

from latentarm.demonstrations.info import read_info
from latentarm.demonstrations.reader import read_episodes
from latentarm.errors import UserError
from latentarm.types import Demonstrations


def read_lerobot(source: Path, actions: Literal["known", "joint_velocity"] = "known") -> Demonstrations:
    """Read a dataset of the LeRobotDataset v3.0 layout.

    ``observation.state`` must hold joint positions in rad. Every other vector of floats is kept;
    pictures, video, text and whole numbers are left out. The layout does not say what an action
    is, and in most datasets it is a joint position: the actions of a dataset that another program
    wrote are left out unless the caller vouches for them.

    Args:
        source: the dataset's folder.
        actions: ``"known"`` keeps actions only of datasets that say they are joint velocities,
            ``"joint_velocity"`` keeps them all.

    Raises:
        UserError: the folder is no such dataset, or a damaged one, or the actions that the caller
            vouches for are missing.
    """
    info = read_info(source)
    episodes = read_episodes(source, info)
    if actions == "joint_velocity" and any(episode.action is None for episode in episodes):
        raise UserError(f"{source} has no feature 'action' of floats to take joint velocities from.")
    if actions == "known" and not info.native:
        episodes = tuple(replace(episode, action=None) for episode in episodes)
    return Demonstrations(
        episodes=episodes,
        rate_hz=info.rate_hz,
        joint_names=info.joint_names,
        robot=info.robot,
        goals=info.goals,
        end_effector=info.end_effector,
        limits=info.limits,
    )
