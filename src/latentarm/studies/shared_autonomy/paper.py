"""What the paper prints in section 8.2, as data.

It prints two figures: how much more time LA takes than LA+SA on the Franka Emika, a Panda. All its other
results are curves without printed numbers.
"""

from collections.abc import Sequence
from dataclasses import replace
from typing import Final

from latentarm.types import Row

EXTRA_TIME: Final = "extra_time_percent"
"""The measure: how much more time LA takes to reach the goal than LA+SA."""

MODEL: Final = "cae"
"""The model of the paper's study; equation 16, with lambda_1 above 0, is the cVAE's."""

PAPER: Final = {
    ("panda_two_cups", MODEL, EXTRA_TIME, "beta 75"): 45.0,
    ("panda_two_cups", MODEL, EXTRA_TIME, "beta 1000"): 30.0,
}
"""By task, model, measure and condition, %."""


def with_paper(rows: Sequence[Row]) -> list[Row]:
    """The same rows, with the paper's figure in those that have one."""
    return [replace(row, paper_mean=PAPER.get(_place(row))) for row in rows]


def _place(row: Row) -> tuple[str, str, str, str]:
    return row.task or "", row.model or "", row.measure, row.condition or ""
