"""The planar tasks of section 8.1: the parts that all four share, and those of the tasks with one arm."""

from abc import ABC, abstractmethod
from collections.abc import Sequence
from typing import ClassVar, Final, final

import numpy as np

from latentarm.core.errors import UserError
from latentarm.core.types import BoolArray, Demonstrations, Episode, FloatArray
from latentarm.robots.planar import planar
from latentarm.robots.robot import Robot
from latentarm_research.tasks.planar.paths import Path
from latentarm_research.tasks.planar.resolved_rate import (
    Constraint,
    Recording,
    ToolPlace,
    curled,
    follow,
    settle,
)

DEMONSTRATION_S: Final = 4.0
"""Duration of a demonstration that goes back and forth."""

DRAWS: Final = 20
"""How often postures are drawn, at most, before too few pass."""


class PlanarMotion(ABC):
    """A continuous motion to be demonstrated and learned, without discrete goals."""

    name: ClassVar[str]  # in snake_case
    words: ClassVar[str]  # what is done
    latent_dim: ClassVar[int]  # size d of the latent action that the paper gives the task
    closing: ClassVar[tuple[int, ...]]  # joints that bring the tool to its place where the others are drawn
    duration_s: ClassVar[float] = DEMONSTRATION_S  # of a demonstration, s
    # How a simulated person holds and moves the arm, the same on all tasks: the paper leaves it open.
    # SD of a demonstration's first posture about the nominal one: the arm has more joints than the task
    # needs, and nobody begins twice in the same posture. The joints that the task leaves free are drawn
    # whatever the place, and the others bring the tool there, so that the place says nothing about the
    # posture
    spread_rad: ClassVar[float] = 0.05
    # a demonstration in which the smallest singular value of the task's Jacobian falls below this share of
    # its value in the nominal posture is drawn anew: there the joints would have to race, and a few such
    # pairs would make up all of a mean
    least_conditioning: ClassVar[float] = 2 / 3
    samples: ClassVar[int] = 10  # state-action pairs of a demonstration, spread evenly over its duration

    def __init__(self, robot: Robot) -> None:
        self.robot = robot  # the arm, or the two arms

    @property
    @abstractmethod
    def nominal(self) -> FloatArray:
        """The nominal posture (n,), rad."""

    @property
    @abstractmethod
    def constraint(self) -> Constraint:
        """What the task constrains."""

    @abstractmethod
    def paths(self, count: int, rng: np.random.Generator) -> Path:
        """The paths of some demonstrations, each from its beginning."""

    @final
    def demonstrate(self, episodes: int, rng: np.random.Generator) -> Demonstrations:
        """Demonstrations by a simulated person: in each `samples` states with the actions there."""
        if episodes < 1:
            raise UserError("Ask for at least one demonstration.")
        kept: list[Recording] = []
        missing = episodes
        for _ in range(DRAWS):
            recording = self._draw(missing + missing // 2 + 4, rng)
            kept.append(recording.of(np.flatnonzero(recording.sound)[:missing]))
            missing -= len(kept[-1].states)
            if not missing:
                return self._as_demonstrations(kept)
        raise UserError(
            f"Too few postures of {self.name} pass a least conditioning of {self.least_conditioning:g}"
            f" at a spread of {self.spread_rad:g} rad: lower one of them."
        )

    def _draw(self, count: int, rng: np.random.Generator) -> Recording:
        """Some demonstrations, those among them that are to be drawn anew not yet left out."""
        path = self.paths(count, rng)
        posture = self.nominal + rng.normal(0.0, self.spread_rad, (count, self.robot.dof))
        moved = np.array(self.closing)
        posture[:, moved] = self.nominal[moved]
        start = settle(posture, path.now, self.constraint, moved)
        recording = follow(self.constraint, start, path, self.samples, self.duration_s)
        return recording.judged(self._sound(recording.states))

    def _sound(self, states: FloatArray) -> BoolArray:
        """Which demonstrations (E, T, n) are well conditioned, within limits, and on the nominal branch.

        Two ways to bend the closing joints lead to the same place; a person keeps to one.
        """
        jacobian, nominal = self.constraint.jacobian(states), self.constraint.jacobian(self.nominal)
        least = np.sqrt(np.linalg.eigvalsh(nominal @ nominal.mT)[0]) * self.least_conditioning
        conditioned = np.linalg.eigvalsh(jacobian @ jacobian.mT)[..., 0] > least**2
        closing = np.array(self.closing)
        branch = np.linalg.det(jacobian[..., closing]) * np.linalg.det(nominal[:, closing]) > 0
        within = ~self.robot.limits.violation(states).any(axis=-1)
        return (conditioned & branch & within).all(axis=-1)

    def _as_demonstrations(self, recordings: Sequence[Recording]) -> Demonstrations:
        rate_hz = self.samples / self.duration_s
        timestamp = np.arange(self.samples) / rate_hz
        return Demonstrations(
            episodes=tuple(
                Episode(state=state, timestamp=timestamp, action=action, task=self.words)
                for one in recordings
                for state, action in zip(one.states, one.actions, strict=True)
            ),
            rate_hz=rate_hz,
            joint_names=self.robot.joint_names,
            robot=self.robot.name,
        )


class OneArm(PlanarMotion, ABC):
    """One arm of 5 joints, curled, whose tool's place is what the task constrains."""

    closing = (0, 1)  # the first two joints

    def __init__(self) -> None:
        super().__init__(planar(5))

    @property
    def nominal(self) -> FloatArray:
        """See `PlanarMotion`."""
        return curled(self.robot)

    @property
    def constraint(self) -> Constraint:
        """The tool's place."""
        return ToolPlace(self.robot)
