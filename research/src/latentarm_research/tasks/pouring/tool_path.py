"""Paths of the hand, and the joints that follow them."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final, Self, final

import numpy as np

from latentarm.core.types import FloatArray, Pose
from latentarm.robots.kinematics.chain import Chain
from latentarm.robots.kinematics.rotations import pose_error

RATE_HZ: Final = 20.0
"""Of the demonstrations."""

SPEED_M_S: Final = 0.15
"""Fastest motion of the hand along an axis."""

TURN_RAD_S: Final = 0.75
"""Fastest tilt of the hand."""

WAVES: Final = 3
"""Sines that a smooth random course is the sum of, along each axis."""

FREQUENCIES_HZ: Final = (0.1, 0.35)
"""Slowest and fastest of them."""

LOUDNESS: Final = 1.2
"""Sum of the waves at which a course is as fast as may be; where it is more, the speed is cut."""

STEPS_PER_SAMPLE: Final = 2
"""Of resolved rate: the second takes up the millimetres by which the first leaves the path."""


@final
@dataclass(frozen=True, eq=False)
class ToolPath:
    """Where a hand that points down is at each sample, and how far it is tilted about the base's x axis."""

    position: FloatArray  # (T, 3), m
    tilt: FloatArray  # (T,), rad

    def __len__(self) -> int:
        """T."""
        return len(self.tilt)

    def poses(self, sample: int) -> Pose:
        """The pose at one sample."""
        cos, sin = np.cos(self.tilt[sample]), np.sin(self.tilt[sample])
        turned = np.array([[1.0, 0.0, 0.0], [0.0, cos, -sin], [0.0, sin, cos]])
        return Pose(self.position[sample], turned @ np.diag([1.0, -1.0, -1.0]))

    def then(self, position: FloatArray, tilt: FloatArray) -> Self:
        """This path and, after it, the samples (K, 3) and (K,)."""
        return type(self)(np.concatenate([self.position, position]), np.concatenate([self.tilt, tilt]))


def wander(
    seconds: float, low: FloatArray, high: FloatArray, fastest: FloatArray, rng: np.random.Generator
) -> FloatArray:
    """A smooth random course (T, k), T = seconds times `RATE_HZ`, plus one, through a box of low and high.

    ``fastest`` (k,) is the speed along each axis, per s.
    """
    while True:
        way = _stroll(round(seconds * RATE_HZ), fastest, rng)
        room = high - low - np.ptp(way, axis=0)
        if (room >= 0).all():
            return low - way.min(axis=0) + rng.uniform(0.0, 1.0, len(low)) * room + way


def wander_from(
    start: FloatArray,
    seconds: float,
    low: FloatArray,
    high: FloatArray,
    fastest: FloatArray,
    rng: np.random.Generator,
) -> FloatArray:
    """As `wander`, from a start (k,) in the box."""
    while True:
        way = start + _stroll(round(seconds * RATE_HZ), fastest, rng)
        if ((way >= low) & (way <= high)).all():
            return way


def follow(chain: Chain, start: FloatArray, paths: Sequence[ToolPath]) -> list[FloatArray]:
    """States (T, n), rad, of an arm whose hand goes along each path, the joints by the shortest way.

    Resolved motion rate control (Whitney 1969), at each step towards the hand's next pose.
    """
    states = [start]
    for sample in range(1, max(map(len, paths))):
        wanted = [path.poses(min(sample, len(path) - 1)) for path in paths]
        next_pose = Pose(
            np.stack([pose.position for pose in wanted]), np.stack([pose.rotation for pose in wanted])
        )
        state = states[-1]
        for _ in range(STEPS_PER_SAMPLE):
            error = pose_error(chain.forward(state), next_pose)
            state = state + (np.linalg.pinv(chain.jacobian(state)) @ error[..., None])[..., 0]
        states.append(state)
    every = np.stack(states, axis=1)
    return [state[: len(path)] for state, path in zip(every, paths, strict=True)]


def _stroll(steps: int, fastest: FloatArray, rng: np.random.Generator) -> FloatArray:
    """Smooth random displacements (steps + 1, k) from zero, no faster than ``fastest``."""
    shape = (WAVES, len(fastest))
    time = np.arange(steps)[:, None, None] / RATE_HZ
    frequency = rng.uniform(*FREQUENCIES_HZ, shape)
    phase = rng.uniform(0.0, 2 * np.pi, shape)
    waves = rng.normal(size=shape) * np.sin(2 * np.pi * frequency * time + phase)
    velocity = fastest * np.clip(waves.sum(axis=1) / LOUDNESS, -1.0, 1.0)
    return np.concatenate([np.zeros((1, len(fastest))), np.cumsum(velocity, axis=0) / RATE_HZ])
