"""Motions that simulated people imagine: of the tool, and of what it holds."""

from dataclasses import replace

import numpy as np
from scipy.spatial.transform import Rotation

from latentarm.core.types import BoolArray, Context, FloatArray, Pose
from latentarm.robots.kinematics.chain import Chain
from latentarm.robots.kinematics.pose_rows import moved_along


def shifted(pose: Pose, change: FloatArray) -> Pose:
    """Poses (...) after changes (..., 6) of one pose, m and rad, in the base frame, as by `pose_error`."""
    turn = Rotation.from_rotvec(change[..., 3:].reshape(-1, 3)).as_matrix()
    return Pose(
        position=pose.position + change[..., :3],
        rotation=turn.reshape(*change.shape[:-1], 3, 3) @ pose.rotation,
    )


def carried(
    chain: Chain,  # the arm, whose first tool holds things
    context: Context,
    held: BoolArray,  # (K,), which of its things are held
    state: FloatArray,  # (..., n), where the arm is then, rad
) -> Context:
    """The context once the arm is elsewhere, and with it what it holds."""
    if not held.any():
        return replace(context, state=state)
    moved = moved_along(context.objects, chain.forward(context.state), chain.forward(state))
    return replace(context, state=state, objects=np.where(held[:, None], moved, context.objects))
