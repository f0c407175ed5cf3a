"""Validation of options before any work starts."""

import math

from latentarm.core.errors import UserError


def check_seed(seed: int) -> None:
    """Refuse a seed that is negative or above 2³¹ - 1, the largest that NumPy and torch both take."""
    if not 0 <= seed < 2**31:
        raise UserError(f"The seed is {seed}: it must be from 0 to {2**31 - 1}.")


def check_count(name: str, count: int) -> None:
    """Refuse a count below one."""
    if count < 1:
        raise UserError(f"The number of {name} is {count}: it must be at least 1.")


def check_positive(name: str, value: float) -> None:
    """Refuse a figure that is not above zero and finite."""
    if not (math.isfinite(value) and value > 0):
        raise UserError(f"The {name} is {value:g}: it must be above zero and finite.")
