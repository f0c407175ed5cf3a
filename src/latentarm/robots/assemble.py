"""Make a `Robot` of a MuJoCo model."""

from collections.abc import Sequence

import mujoco
import numpy as np

from latentarm.kinematics.capsules import Capsules
from latentarm.kinematics.reader import read
from latentarm.robots.limits import JointLimits, Source
from latentarm.robots.robot import Robot
from latentarm.robots.self_pairs import self_pairs
from latentarm.robots.shapes import body_name, read_capsules
from latentarm.types import BoolArray, FloatArray


def assemble(
    name: str,
    mjcf: str,
    end_effectors: Sequence[str],
    limits: JointLimits,
    home: FloatArray,
    tool_speed_limit: float,
    model_path: str | None = None,
    model: mujoco.MjModel | None = None,
    tool_speed_source: Source = "assumed",
) -> Robot:
    """Read a robot's kinematics and shape from its model, and add what the model does not say.

    Args:
        name: what to call it.
        mjcf: its model as MJCF text. The chain is read from this text, so that the two agree to
            rounding, whatever the digits in it.
        end_effectors: names of sites or bodies, "the" tool first.
        limits: of its joints.
        home: (n,), rad.
        tool_speed_limit: m/s.
        model_path: the file that the model was read from.
        model: compiled from ``mjcf``, where the caller has it: large meshes take seconds to compile.
        tool_speed_source: how the limit of the tool's speed is known.

    Returns:
        The robot.

    Raises:
        UserError: see `latentarm.kinematics.reader.read`.
    """
    if model is None:
        model = mujoco.MjModel.from_xml_string(mjcf)
    reading = read(model, end_effectors)
    capsules = read_capsules(model, reading)
    return Robot(
        name=name,
        chain=reading.chain,
        limits=limits,
        home=home,
        capsules=capsules,
        self_pairs=self_pairs(reading.chain, capsules, limits, home, _excluded(model, capsules)),
        mjcf=mjcf,
        tool_speed_limit=tool_speed_limit,
        tool_speed_source=tool_speed_source,
        model_path=model_path,
    )


def _excluded(model: mujoco.MjModel, capsules: Capsules) -> BoolArray:
    """(K, K), pairs of capsules whose bodies the model's <exclude> elements name.

    What else rides on the same links stays watched: a hand may hit a forearm that the flange before it
    cannot reach. So does a capsule that several bodies share, which has the name of none of them.
    """
    excluded = np.zeros((len(capsules), len(capsules)), dtype=np.bool_)
    names = np.array(capsules.name)
    for signature in model.exclude_signature:
        first, second = (
            names == body_name(model, int(body)) for body in (signature >> 16, signature & 0xFFFF)
        )
        excluded |= np.outer(first, second) | np.outer(second, first)
    return excluded
