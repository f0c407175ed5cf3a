"""Refusing parameters and arrays that make no sense, in one sentence each."""

import math
from collections.abc import Mapping, Sequence
from typing import Final

import numpy as np

from latentarm.errors import UserError
from latentarm.types import FloatArray

WHOLE: Final = {
    "latent_dim": 1,
    "window": 1,
    "seeds": 1,
    "seed": 0,
    "data_seed": 0,
    "epochs": 1,
    "batch_size": 1,
    "patience": 1,
}
"""Whole-numbered parameters and the least that each may be."""

POSITIVE: Final = ("learning_rate",)
NOT_NEGATIVE: Final = (
    "state_noise_rad",
    "checkpoint_interval_s",
    "kl_weight",
    "zero_weight",
    "bend_weight",
    "smoothness_weight",
)
CHOICES: Final = {
    "context": ("state", "state_belief"),
    "actions": ("displacement", "recorded"),
    "device": ("cpu", "cuda", "auto"),
}
WIDEST: Final = 4096
"""Units of a hidden layer, at most."""
MOST_SEEDS: Final = 1000
"""Models trained side by side, at most: memory grows with them."""
LARGEST: Final = 2**31 - 1
"""A whole-numbered parameter or a seed, at most."""


def check_parameters(parameters: Mapping[str, object]) -> None:
    """Check the values of a model's parameters, whoever wrote them.

    Raises:
        UserError: a value has the wrong type or lies outside its range.
    """
    for name, value in parameters.items():
        problem = _problem(name, value)
        if problem:
            raise UserError(f"The model parameter {name} is {value!r}; it must be {problem}.")
    first, seeds = parameters.get("seed"), parameters.get("seeds")
    if isinstance(first, int) and isinstance(seeds, int) and first + seeds - 1 > LARGEST:
        raise UserError(f"{seeds} seeds from {first} on end beyond {LARGEST}: choose a smaller first seed.")


def _problem(name: str, value: object) -> str:
    """What the value should have been, or nothing where it is right."""
    number = value if isinstance(value, int | float) and not isinstance(value, bool) else math.nan
    if name in WHOLE:
        most = MOST_SEEDS if name == "seeds" else LARGEST
        fits = isinstance(number, int) and WHOLE[name] <= number <= most
        return "" if fits else f"a whole number from {WHOLE[name]} to {most}"
    if name in POSITIVE:
        return "" if 0 < number < math.inf else "a positive number"
    if name in NOT_NEGATIVE:
        return "" if 0 <= number < math.inf else "a finite number, zero or more"
    if name in CHOICES:
        return "" if value in CHOICES[name] else f"one of {', '.join(CHOICES[name])}"
    if name == "validation_fraction":
        return "" if 0 < number < 1 else "a number between 0 and 1"
    if name == "hidden":
        fits = isinstance(value, tuple) and all(
            type(units) is int and 1 <= units <= WIDEST for units in value
        )
        return "" if fits else f"a tuple of whole numbers from 1 to {WIDEST}"
    return "absent: no such parameter is known"


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
