"""Make a `Robot` of a MuJoCo model."""

from collections.abc import Sequence

import mujoco
import numpy as np

from latentarm.kinematics.reader import Reading, read
from latentarm.robots.limits import JointLimits, Source
from latentarm.robots.robot import Robot
from latentarm.robots.self_pairs import self_pairs
from latentarm.robots.shapes import read_capsules
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
        self_pairs=self_pairs(reading.chain, capsules, limits, home, _excluded_links(model, reading)),
        mjcf=mjcf,
        tool_speed_limit=tool_speed_limit,
        tool_speed_source=tool_speed_source,
        model_path=model_path,
    )


def _excluded_links(model: mujoco.MjModel, reading: Reading) -> BoolArray:
    """(n + 1, n + 1), pairs of links (the base is the last) that the model's <exclude> elements name."""
    n = reading.chain.dof
    excluded = np.zeros((n + 1, n + 1), dtype=np.bool_)
    for signature in model.exclude_signature:
        first, second = reading.body_link[signature >> 16], reading.body_link[signature & 0xFFFF]
        excluded[first, second] = excluded[second, first] = True
    return excluded
