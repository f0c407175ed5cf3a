"""Resolved-rate demonstrators: the tool follows a path, the joints take the shortest way.

The paper does not say how its demonstrators resolve redundancy. Here it is Whitney's resolved motion rate
control (1969): of all joint velocities that move the tool as wanted, the one of least norm,
``a = J^+ dx / dt``. So the action depends on the state and on the tool's motion alone, going back is the
opposite of going forth, and the same place is passed in many postures.
"""

from abc import ABC, abstractmethod
from dataclasses import dataclass, replace
from typing import Final, final

import numpy as np

from latentarm.core.types import BoolArray, FloatArray, IntArray
from latentarm.robots.robot import Robot
from latentarm_research.tasks.planar.paths import STEP_S, Path, least_norm

SETTLING_STEPS: Final = 60
LARGEST_STEP_RAD: Final = 0.3
"""Bound on a joint's step while settling, so that a far start does not jump to another posture."""
SETTLED: Final = 1e-6
"""Distance from the path's beginning, m or rad, above which a posture has not settled."""

RACING_RAD_S: Final = 20.0
"""Joint speed above which an arm races through a singular posture; such a demonstration is unsound."""

CURL_RAD: Final = 0.95
"""Bend of every joint but the first in the nominal posture of one arm. So curled, its tool moves about as
readily to all sides (J J^T is near a multiple of 1), which is how a person would hold such an arm."""

BEARING_RAD: Final = 0.75 * np.pi
"""Direction from the base to the tool in that posture; the tool then lies near (-0.22, 0.22) m."""


class Constraint(ABC):
    """What a task constrains: coordinates in the plane, m or rad."""

    @abstractmethod
    def coordinates(self, state: FloatArray) -> FloatArray:
        """From states (..., n) to task coordinates (..., k)."""

    @abstractmethod
    def jacobian(self, state: FloatArray) -> FloatArray:
        """The derivative (..., k, n) of `coordinates`."""


@final
class ToolPlace(Constraint):
    """The place of one arm's tool."""

    def __init__(self, robot: Robot) -> None:
        self._robot = robot

    def coordinates(self, state: FloatArray) -> FloatArray:
        """See `Constraint`."""
        return plane_point(self._robot, state)

    def jacobian(self, state: FloatArray) -> FloatArray:
        """See `Constraint`."""
        return self._robot.chain.jacobian(state)[..., :2, :]


@final
@dataclass(frozen=True, eq=False)
class Recording:
    """E demonstrations in arrays."""

    states: FloatArray  # (E, T, n), rad
    actions: FloatArray  # (E, T, n), rad/s
    sound: BoolArray  # (E,), whether a person would have gone through with it

    def of(self, rows: IntArray) -> "Recording":
        """Only some of the demonstrations."""
        return Recording(self.states[rows], self.actions[rows], self.sound[rows])

    def judged(self, sound: BoolArray) -> "Recording":
        """The same, sound only where they also pass (E,)."""
        return replace(self, sound=self.sound & sound)


def curled(robot: Robot) -> FloatArray:
    """The nominal posture of one planar arm, (n,), rad: see `CURL_RAD` and `BEARING_RAD`."""
    posture = np.full(robot.dof, CURL_RAD)
    posture[0] = 0.0
    tool = robot.chain.forward(posture).position
    posture[0] = BEARING_RAD - np.arctan2(tool[1], tool[0])
    return posture


def plane_point(robot: Robot, state: FloatArray) -> FloatArray:
    """Place (..., 2) of the tool in the plane at states (..., n), m."""
    return robot.chain.forward(state).position[..., :2]


def settle(start: FloatArray, wanted: FloatArray, constraint: Constraint, moved: IntArray) -> FloatArray:
    """Postures near ``start`` (E, n), rad, with the wanted task coordinates (E, k), if there are any.

    Only the joints ``moved`` may move, at least k.
    """
    state = start.copy()
    for _ in range(SETTLING_STEPS):
        away = wanted - constraint.coordinates(state)
        if np.abs(away).max() < SETTLED**2:
            break
        # The pseudo-inverse also serves where the place is out of reach; such postures are not kept.
        inverse = np.linalg.pinv(constraint.jacobian(state)[..., moved], rcond=1e-3)
        step = (inverse @ away[..., None])[..., 0]
        state[:, moved] += np.clip(step, -LARGEST_STEP_RAD, LARGEST_STEP_RAD)
    return state


def follow(
    constraint: Constraint, start: FloatArray, path: Path, samples: int, duration_s: float
) -> Recording:
    """Demonstrations along paths, all at once.

    ``s + a dt`` with dt = `STEP_S` is on the path to first order. Between two recorded samples are further
    steps.

    Args:
        constraint: what the task constrains.
        start: (E, n), postures at the beginning of the paths; where one is not, the demonstration is unsound.
        path: of all of them.
        samples: T, state-action pairs of each.
        duration_s: length of each, a multiple of ``samples`` steps, s.
    """
    sound = np.abs(path.now - constraint.coordinates(start)).max(axis=-1) < SETTLED
    state = np.where(sound[:, None], start, start[np.argmax(sound)])
    states, actions = np.empty((2, len(start), samples, start.shape[1]))
    stride = round(duration_s / STEP_S) // samples
    for step in range(samples * stride):
        jacobian = constraint.jacobian(state)
        path.advance(jacobian)
        action = least_norm(jacobian, (path.now - constraint.coordinates(state)) / STEP_S)
        if step % stride == 0:
            states[:, step // stride], actions[:, step // stride] = state, action
        sound &= np.abs(action).max(axis=-1) < RACING_RAD_S
        state = state + np.clip(action, -RACING_RAD_S, RACING_RAD_S) * STEP_S
    return Recording(states, actions, sound)
