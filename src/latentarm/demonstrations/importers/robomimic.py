"""Importing HDF5 files in robomimic's layout (robosuite, LIBERO and others).

States are ``data/demo_*/obs/robot0_joint_pos`` (robosuite; a second arm's ``robot1_joint_pos`` is appended)
or ``data/demo_*/obs/joint_states`` (LIBERO), rad. Timestamps follow from the control frequency in the
environment's arguments. Recorded actions mostly are scaled end-effector displacements; they are kept, scaled
to rad/s, only where the environment's arguments name a ``JOINT_VELOCITY`` controller of one arm.

The gripper is ``obs/robot0_gripper_qpos`` (robosuite) or ``obs/gripper_states`` (LIBERO). robosuite's gripper
of the Panda has two fingers that slide from 0 to 0.04 m, the second one negative, and takes the last entry of
an action as open (below zero) or close (above): its opening and its target are kept in m. Joints of other
grippers are kept as recorded.
"""

import math
import re
from collections.abc import Mapping
from pathlib import Path
from typing import Any, Final, cast

import h5py
import numpy as np

from latentarm.core.errors import UserError
from latentarm.core.types import Demonstrations, Episode, FloatArray
from latentarm.core.untrusted.documents import parse_object
from latentarm.demonstrations.bounds import check_values
from latentarm.demonstrations.gripper import ACTION_GRIPPER, GRIPPER, GRIPPER_WIDTH, going_to
from latentarm.demonstrations.importers.hdf5_tables import group, member, opened_hdf5, path_in, table
from latentarm.demonstrations.importers.options import ImportOptions
from latentarm.demonstrations.importers.source import SourceData
from latentarm.demonstrations.info import MAX_RATE_HZ, default_joint_names

STATE_KEYS: Final = ("robot0_joint_pos", "joint_states")
SECOND_ARM_KEY: Final = "robot1_joint_pos"
GRIPPER_KEYS: Final = ("robot0_gripper_qpos", "gripper_states")
_PANDAS: Final = frozenset({"Panda", "MountedPanda", "OnTheGroundPanda"})
_PANDA_GRIPPERS: Final = (None, "default", "PandaGripper")
_PANDA_OPEN_M: Final = 0.08


def read_robomimic(source: Path, options: ImportOptions) -> SourceData:
    """Read demonstrations from a robomimic HDF5 file.

    The task is the environment's name by default, else the file's. Actions are kept as described above, or
    their first n entries where these are stated to be joint velocities in rad/s.
    """
    with opened_hdf5(source) as file:
        data = group(file, "data", source)
        arguments = _environment(data, source)
        demos = (re.fullmatch(r"demo_(\d+)", str(name)) for name in data)
        names = [f"demo_{number}" for number in sorted(int(demo[1]) for demo in demos if demo)]
        if not names:
            raise UserError(f"{source} has no demonstrations: there is no group data/demo_0.")
        demonstrated = [group(data, name, source) for name in names]
        check_values(source, "it", sum(_declared_count(demo) for demo in demonstrated))
        if "obs" not in demonstrated[0] and "states" in demonstrated[0]:
            raise UserError(
                f"{source} was recorded by robosuite and holds the simulator's states, not the robot's: add"
                " observations with robomimic's script dataset_states_to_obs.py, then import its file."
            )
        rate = options.rate_hz or _rate(arguments, source)
        scale = 1.0 if options.actions == "joint_velocity" else _velocity_scale(arguments)
        what = options.instruction or str(arguments.get("env_name", source.stem))
        panda = _has_panda_gripper(arguments)
        episodes = tuple(
            _episode(demo, index, rate, what, scale, panda, source) for index, demo in enumerate(demonstrated)
        )
    width = episodes[0].state.shape[1]
    demonstrations = Demonstrations(
        episodes=episodes, rate_hz=rate, joint_names=default_joint_names(width), robot=_robot(arguments)
    )
    return SourceData(demonstrations, "robomimic HDF5", in_rad=True, names=tuple(names))


def _robot(arguments: Mapping[str, Any]) -> str:
    """The environment's name for its robot, or ""."""
    robots = _nested(arguments, "env_kwargs", "robots")
    listed = cast(list[object], robots) if isinstance(robots, list) else [robots]
    return " and ".join(dict.fromkeys(name for name in listed if isinstance(name, str)))


def _declared_count(demo: h5py.Group) -> int:
    observations = member(demo, "obs")
    found = [member(demo, "actions")]
    if isinstance(observations, h5py.Group):
        found += [member(observations, key) for key in (*STATE_KEYS, SECOND_ARM_KEY, *GRIPPER_KEYS)]
    return sum(math.prod(one.shape or ()) for one in found if isinstance(one, h5py.Dataset))


def _environment(data: h5py.Group, source: Path) -> Mapping[str, Any]:
    text = data.attrs.get("env_args", "{}")
    where = f"{source}: the attribute env_args of data"
    if not isinstance(text, str | bytes):
        raise UserError(f"{where} is not a text.")
    return parse_object(text, where)


def _nested(mapping: Mapping[str, Any], *keys: str) -> Any:
    value: Any = mapping
    for key in keys:
        value = cast(Mapping[str, Any], value).get(key) if isinstance(value, dict) else None
    return value


def _rate(arguments: Mapping[str, Any], source: Path) -> float:
    rate = _nested(arguments, "env_kwargs", "control_freq")
    if isinstance(rate, bool) or not isinstance(rate, int | float) or abs(rate) >= MAX_RATE_HZ:
        raise UserError(f"{source} does not say its control frequency; say the sampling rate.")
    if not (math.isfinite(rate) and rate > 0):
        raise UserError(
            f"{source}: the control frequency is {rate:g} Hz; it must be a finite number above zero."
        )
    return float(rate)


def _velocity_scale(arguments: Mapping[str, Any]) -> float | None:
    """rad/s of a full action for a joint-velocity controller, else None."""
    controller = _nested(arguments, "env_kwargs", "controller_configs")
    if _nested(arguments, "env_kwargs", "controller_configs", "body_parts", "right") is not None:
        controller = controller["body_parts"]["right"]
    if _nested({"c": controller}, "c", "type") != "JOINT_VELOCITY":
        return None
    largest_in, largest_out = controller.get("input_max"), controller.get("output_max")
    numbers = isinstance(largest_in, int | float) and isinstance(largest_out, int | float)
    return largest_out / largest_in if numbers and largest_in > 0 else None


def _has_panda_gripper(arguments: Mapping[str, Any]) -> bool:
    """Whether the environment's one arm is a Panda with its own gripper."""
    types = _nested(arguments, "env_kwargs", "gripper_types")
    one = cast(list[object], types)[0] if isinstance(types, list) and len(types) == 1 else types
    return _robot(arguments) in _PANDAS and one in _PANDA_GRIPPERS


def _gripper(demo: h5py.Group, panda: bool, source: Path) -> dict[str, FloatArray]:
    found = (table(group(demo, "obs", source), key, source) for key in GRIPPER_KEYS)
    joints = next((values for values in found if values is not None), None)
    if joints is None:
        return {}
    if not panda or joints.shape[1] != 2:
        return {GRIPPER: joints}
    width_m = np.maximum(joints[:, 0] - joints[:, 1], 0.0)
    recorded = table(demo, "actions", source)
    if recorded is None or len(recorded) != len(width_m):
        return {GRIPPER_WIDTH: width_m[:, None]}
    asked = recorded[:, -1]
    commanded = np.select([asked > 0.0, asked < 0.0], [0.0, _PANDA_OPEN_M], np.nan)
    # These files do not say whether something is held.
    target_m = going_to(commanded, width_m, np.zeros(len(width_m), dtype=np.bool_))
    return {GRIPPER_WIDTH: width_m[:, None], ACTION_GRIPPER: target_m[:, None]}


def _episode(
    demo: h5py.Group, index: int, rate_hz: float, task: str, scale: float | None, panda: bool, source: Path
) -> Episode:
    observations = group(demo, "obs", source)
    found = (table(observations, key, source) for key in STATE_KEYS)
    state = next((values for values in found if values is not None), None)
    if state is None:
        raise UserError(
            f"{source}: {path_in(demo, 'obs')} has no joint positions ({' or '.join(STATE_KEYS)})."
        )
    second = table(observations, SECOND_ARM_KEY, source)
    if second is not None:
        if len(second) != len(state):
            raise UserError(
                f"{source}: episode {index} is ragged: its arms have {len(state)} and {len(second)} samples."
            )
        state = np.concatenate([state, second], axis=1)
    action = None
    if scale is not None and second is None:
        recorded = table(demo, "actions", source)
        action = None if recorded is None else recorded[:, : state.shape[1]] * scale
    return Episode(
        state=state,
        timestamp=np.arange(len(state)) / rate_hz,
        action=action,
        task=task,
        extras={} if second is not None else _gripper(demo, panda, source),
    )
