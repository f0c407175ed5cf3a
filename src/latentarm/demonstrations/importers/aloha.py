"""Importing HDF5 files of ALOHA and ACT: one file is one episode of two arms of six joints.

``observations/qpos`` has each arm's joints, rad, and its gripper; ``action`` has their targets. The files
lack the sampling rate; ALOHA records at 50 Hz.
"""

import math
from pathlib import Path
from typing import Final

import h5py
import numpy as np

from latentarm.core.errors import UserError
from latentarm.core.types import Demonstrations, Episode
from latentarm.demonstrations.bounds import check_values
from latentarm.demonstrations.importers.hdf5_tables import group, member, opened_hdf5, table
from latentarm.demonstrations.importers.options import ImportOptions
from latentarm.demonstrations.importers.source import SourceData
from latentarm.demonstrations.info import default_joint_names

_ARM: Final = ("waist", "shoulder", "elbow", "forearm_roll", "wrist_angle", "wrist_rotate", "gripper")
COLUMNS: Final = tuple(f"{side}_{joint}" for side in ("left", "right") for joint in _ARM)
"""Columns of ALOHA's own ``qpos``."""


def is_aloha(source: Path) -> bool:
    """Whether an HDF5 file is in this layout."""
    with opened_hdf5(source) as file:
        observations = member(file, "observations")
        return isinstance(observations, h5py.Group) and "qpos" in observations


def read_aloha(source: Path, options: ImportOptions) -> SourceData:
    """Read one episode; the task is the folder's name by default."""
    rate_hz, task = options.rate_hz, options.instruction or source.parent.name
    if rate_hz is None:
        raise UserError(f"{source} is of ALOHA and does not say its rate: pass --rate-hz 50, ALOHA's own.")
    with opened_hdf5(source) as file:
        observations = group(file, "observations", source)
        both = [member(observations, "qpos"), member(file, "action")]
        check_values(source, "it", sum(math.prod(one.shape) for one in both if isinstance(one, h5py.Dataset)))
        state, action = table(observations, "qpos", source), table(file, "action", source)
    if state is None:
        raise UserError(f"{source}: observations/qpos is no table of joint positions.")
    episode = Episode(state, np.arange(len(state)) / rate_hz, action, task)
    width = state.shape[1]
    names = COLUMNS if width == len(COLUMNS) else default_joint_names(width)
    return SourceData(Demonstrations((episode,), rate_hz, names), "ALOHA HDF5", True, "position")
