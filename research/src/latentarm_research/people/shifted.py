"""Where a twist takes the tool."""

from scipy.spatial.transform import Rotation

from latentarm.core.types import FloatArray, Pose


def shifted(pose: Pose, change: FloatArray) -> Pose:
    """Poses (...) after changes of one pose.

    Args:
        pose: from which they begin.
        change: (..., 6), m and rad, in the base frame; see `pose_error` in `latentarm.robots.kinematics`.
    """
    turn = Rotation.from_rotvec(change[..., 3:].reshape(-1, 3)).as_matrix()
    return Pose(
        position=pose.position + change[..., :3],
        rotation=turn.reshape(*change.shape[:-1], 3, 3) @ pose.rotation,
    )
