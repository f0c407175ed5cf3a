"""Ranges of parameters, kept in the fields' metadata, and checks against them."""

import math
from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, fields
from typing import TYPE_CHECKING, Final, cast, final

import numpy as np

from latentarm.core.context import FEATURES, JOINTS, Named, feature_names
from latentarm.core.errors import UserError
from latentarm.core.types import FloatArray

if TYPE_CHECKING:
    from _typeshed import DataclassInstance

RANGE: Final = "range"
"""Key of a parameter's `Range` in the metadata of its field."""

WIDEST: Final = 4096
"""Units of a hidden layer, at most."""
MOST_SEEDS: Final = 1000
"""Models trained side by side, at most: memory grows with them."""
LARGEST: Final = 2**31 - 1
"""A whole-numbered parameter or a seed, at most."""


class Range(ABC):
    """Allowed values of a parameter. Its ``str()`` completes "it must be ..."."""

    @abstractmethod
    def __contains__(self, value: object) -> bool: ...


@final
@dataclass(frozen=True)
class Whole(Range):
    """A whole number.

    Attributes:
        least: the smallest.
        most: the largest.
    """

    least: int = 1
    most: int = LARGEST

    def __contains__(self, value: object) -> bool:
        return type(value) is int and self.least <= value <= self.most

    def __str__(self) -> str:
        return f"a whole number from {self.least} to {self.most}"


@final
@dataclass(frozen=True)
class Real(Range):
    """A finite number.

    Attributes:
        least: the smallest.
        below: exclusive upper bound.
        strictly: whether ``least`` itself is too small.
    """

    least: float = 0.0
    below: float = math.inf
    strictly: bool = False

    def __contains__(self, value: object) -> bool:
        if isinstance(value, bool) or not isinstance(value, int | float):
            return False
        return (value > self.least if self.strictly else value >= self.least) and value < self.below

    def __str__(self) -> str:
        if self.below < math.inf:
            return f"a number between {self.least:g} and {self.below:g}"
        return f"a finite number {'above' if self.strictly else 'of at least'} {self.least:g}"


@final
@dataclass(frozen=True)
class Choice(Range):
    """One of a few strings.

    Attributes:
        among: the strings.
    """

    among: tuple[str, ...]

    def __contains__(self, value: object) -> bool:
        return value in self.among

    def __str__(self) -> str:
        return f"one of {', '.join(self.among)}"


@final
class Features(Range):
    """Features of a context by name."""

    def __contains__(self, value: object) -> bool:
        if not isinstance(value, str | tuple):
            return False
        try:
            feature_names(cast(Named, value))
        except UserError:
            return False
        return True

    def __str__(self) -> str:
        return f"a tuple of distinct names of {', '.join(FEATURES)}, {JOINTS} first"


@final
class Widths(Range):
    """Units of each hidden layer."""

    def __contains__(self, value: object) -> bool:
        return isinstance(value, tuple) and all(units in Whole(1, WIDEST) for units in value)

    def __str__(self) -> str:
        return f"a tuple of whole numbers from 1 to {WIDEST}"


def check_parameters(model: "type[DataclassInstance]", parameters: Mapping[str, object]) -> None:
    """Check a model's parameters against the ranges in its fields' metadata, also for models of plug-ins.

    Raises:
        UserError: a value has the wrong type or lies outside its range.
    """
    for entry in fields(model):
        allowed: Range | None = entry.metadata.get(RANGE)
        if allowed is not None and entry.name in parameters and parameters[entry.name] not in allowed:
            said = repr(parameters[entry.name])
            raise UserError(f"The model parameter {entry.name} is {said}; it must be {allowed}.")
    first, seeds = parameters.get("seed"), parameters.get("seeds")
    if isinstance(first, int) and isinstance(seeds, int) and first + seeds - 1 > LARGEST:
        raise UserError(f"{seeds} seeds from {first} on end beyond {LARGEST}: choose a smaller first seed.")


def check_validation(validation: Sequence[int], episodes: int) -> None:
    """Check that the indices of validation episodes name some of the episodes and leave others to train on.

    Raises:
        UserError: they do not.
    """
    for index in validation:
        if not 0 <= index < episodes:
            raise UserError(
                f"Episode {index} is to be a validation episode, but the dataset's {episodes} end at"
                f" {episodes - 1}."
            )
    held = len(set(validation))
    if not 0 < held < episodes:
        raise UserError(
            f"{held} of {episodes} episodes are for validation: at least one must be, and one must be left to"
            " train on."
        )


def check_rows(
    name: str, values: FloatArray, columns: int, *, seeds: int = 0, rows: int | None = None
) -> None:
    """Check an array of shape (N, columns), or (seeds, N, columns) where ``seeds`` is given.

    Args:
        name: what the array is, for the message.
        values: the array.
        columns: the size that its last axis must have.
        seeds: the size that a leading third axis may have; 0 where there must be none.
        rows: N, where another array fixes it.

    Raises:
        UserError: the shape is wrong or a value is not finite.
    """
    stacked = values.ndim == 3 and seeds > 0 and values.shape[0] == seeds
    fits = (values.ndim == 2 or stacked) and values.shape[-1] == columns and rows in (None, values.shape[-2])
    if not fits:
        wanted = f"({'N' if rows is None else rows}, {columns})"
        stack = f" or ({seeds}, {'N' if rows is None else rows}, {columns})" if seeds else ""
        raise UserError(f"{name} has shape {values.shape}; this model wants {wanted}{stack}.")
    if not np.isfinite(values).all():
        place = [int(index) for index in np.argwhere(~np.isfinite(values))[0]]
        raise UserError(f"{name} holds a NaN or an infinity at {place}.")
