"""Resolved-rate demonstrators: the tool follows a path, the joints take the shortest way.

The paper does not say how its demonstrators resolve redundancy. Here it is Whitney's resolved motion rate
control (1969): of all joint velocities that move the tool as wanted, the one of least norm,
``a = J^+ dx / dt``. So the action depends on the state and on the tool's motion alone, going back is the
opposite of going forth, and the same place is passed in many postures.
"""

from collections.abc import Callable

import numpy as np

from latentarm.errors import UserError
from latentarm.robots.robot import Robot
from latentarm.tasks.planar.motion import BEARING_RAD, CURL_RAD, SAMPLES, STEP_S
from latentarm.types import Demonstrations, Episode, FloatArray

_SETTLING_STEPS = 100
_LARGEST_STEP_RAD = 0.3
"""Bound on a joint's step while settling, so that a far start does not jump to another posture."""

Forward = Callable[[FloatArray], FloatArray]
"""From states (E, n) to what the task constrains (E, k): coordinates in the plane, m or rad."""


def curled(robot: Robot) -> FloatArray:
    """The nominal posture of one planar arm, (n,), rad: see `CURL_RAD` and `BEARING_RAD`."""
    posture = np.full(robot.dof, CURL_RAD)
    posture[0] = 0.0
    tool = robot.chain.forward(posture).position
    posture[0] = BEARING_RAD - np.arctan2(tool[1], tool[0])
    return posture


def plane_point(robot: Robot, state: FloatArray, tool: int = 0) -> FloatArray:
    """Place (..., 2) of a tool in the plane at states (..., n), m."""
    return robot.chain.forward(state, tool).position[..., :2]


def follow(
    robot: Robot,
    start: FloatArray,
    path: Callable[[float], FloatArray],
    forward: Forward,
    jacobian: Forward,
    duration_s: float,
    task: str,
) -> Demonstrations:
    """Demonstrations along paths, all at once.

    Args:
        robot: the arm.
        start: (E, n), postures to begin near; each is first settled onto its path.
        path: from time, s, to the wanted task coordinates (E, k).
        forward: from states to task coordinates.
        jacobian: from states (E, n) to (E, k, n), the derivative of ``forward``.
        duration_s: length of every demonstration, a multiple of `SAMPLES` steps, s.
        task: what is done, in words.

    Returns:
        E episodes of `SAMPLES` states with the actions ``a`` taken there: ``s + a dt`` with dt = `STEP_S` is
        on the path to first order. Between two recorded samples are further steps.

    Raises:
        UserError: no episode is asked for.
    """
    if not len(start):
        raise UserError("Ask for at least one demonstration.")
    state = _settle(start, path(0.0), forward, jacobian)
    states, actions = np.empty((2, len(start), SAMPLES, robot.dof))
    stride = round(duration_s / STEP_S) // SAMPLES
    for step in range(SAMPLES * stride):
        to_go = path((step + 1) * STEP_S) - forward(state)
        action = _least_norm(jacobian(state), to_go / STEP_S)
        if step % stride == 0:
            states[:, step // stride], actions[:, step // stride] = state, action
        state = state + action * STEP_S
    rate_hz = SAMPLES / duration_s
    timestamp = np.arange(SAMPLES) / rate_hz
    return Demonstrations(
        episodes=tuple(
            Episode(state=state, timestamp=timestamp, action=action, task=task)
            for state, action in zip(states, actions, strict=True)
        ),
        rate_hz=rate_hz,
        joint_names=robot.joint_names,
        robot=robot.name,
    )


def _settle(start: FloatArray, wanted: FloatArray, forward: Forward, jacobian: Forward) -> FloatArray:
    """Postures near ``start`` at which the task coordinates are the wanted ones."""
    state = start
    for _ in range(_SETTLING_STEPS):
        step = _least_norm(jacobian(state), wanted - forward(state))
        state = state + np.clip(step, -_LARGEST_STEP_RAD, _LARGEST_STEP_RAD)
    return state


def _least_norm(jacobian: FloatArray, rate: FloatArray) -> FloatArray:
    """``J^+ x``: (E, k, n) and (E, k) to (E, n)."""
    return np.einsum("enk,ek->en", np.linalg.pinv(jacobian), rate)
