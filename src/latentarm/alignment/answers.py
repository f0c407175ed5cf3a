"""Motions shown to a person, and the inputs with which the person would ask for them."""

from dataclasses import dataclass, field
from typing import Self, final

import numpy as np

from latentarm.core.errors import UserError
from latentarm.core.types import FloatArray, IntArray


@final
@dataclass(frozen=True, eq=False)
class Motions:
    """N motions ``(s, s*)`` of one arm, in ``duration_s`` each.

    Raises UserError where sizes do not fit each other, there is no motion, or a number is not finite.
    """

    start: FloatArray  # (N, n), states before, rad
    end: FloatArray  # (N, n), states ``s*`` after, rad
    duration_s: float
    rest: FloatArray = field(default_factory=lambda: np.empty((0, 0)))
    """(N, c - n), the context at the start besides the state (beliefs, poses of things); (N, 0) without."""

    def __post_init__(self) -> None:
        if self.start.ndim != 2 or len(self.start) == 0 or self.start.shape != self.end.shape:
            raise UserError(
                f"Motions begin and end at states of one arm, N times n numbers, not {self.start.shape} and"
                f" {self.end.shape}."
            )
        if self.rest.size == 0:
            object.__setattr__(self, "rest", np.empty((len(self.start), 0)))
        if self.rest.ndim != 2 or len(self.rest) != len(self.start):
            raise UserError(f"{len(self.start)} motions have as many contexts, not {self.rest.shape}.")
        if not all(np.isfinite(values).all() for values in (self.start, self.end, self.rest)):
            raise UserError("A motion holds a NaN or an infinity.")
        if not 0 < self.duration_s < np.inf:
            raise UserError(f"A motion takes a positive time, not {self.duration_s:g} s.")

    def __len__(self) -> int:
        return len(self.start)

    def __getitem__(self, rows: IntArray) -> Self:
        """The motions (K,) at some rows."""
        return type(self)(self.start[rows], self.end[rows], self.duration_s, self.rest[rows])

    @property
    def context(self) -> FloatArray:
        """(N, c), contexts at the start."""
        return np.concatenate([self.start, self.rest], axis=1)

    @property
    def action(self) -> FloatArray:
        """(N, n), the constant joint velocities from start to end, rad/s."""
        return (self.end - self.start) / self.duration_s


@final
@dataclass(frozen=True, eq=False)
class Answers:
    """A person's answers: the input with which they would ask for each of N motions.

    Raises UserError where sizes do not match, or an input is invalid.
    """

    motions: Motions
    u: FloatArray  # (N, d), each entry in [-1, 1]

    def __post_init__(self) -> None:
        if self.u.ndim != 2 or len(self.u) != len(self.motions) or self.u.shape[1] == 0:
            raise UserError(f"{len(self.motions)} motions have as many answers, not {self.u.shape}.")
        # Written so that a value that is not a number fails too.
        wrong = ~((self.u >= -1) & (self.u <= 1)).all(axis=1)
        if wrong.any():
            row = int(wrong.argmax())
            raise UserError(f"Answer {row} is {self.u[row].tolist()}; each number must be in [-1, 1].")

    def __len__(self) -> int:
        return len(self.u)

    def __getitem__(self, rows: IntArray) -> Self:
        """The answers (K,) at some rows."""
        return type(self)(self.motions[rows], self.u[rows])
