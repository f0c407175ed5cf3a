"""In which order people meet the conditions: Williams designs, seeded."""

from collections.abc import Sequence

import numpy as np

from latentarm.core.errors import UserError


def williams(count: int) -> list[list[int]]:
    """A Williams design (Williams, Aust. J. Sci. Res. A 2:149, 1949).

    Every condition stands at every place equally often, and follows every other one equally often.

    Returns:
        Orders of 0 to ``count - 1``: as many as conditions where their number is even, else twice as many.

    Raises:
        UserError: there is no condition.
    """
    if count < 1:
        raise UserError(f"An order needs one condition or more, not {count}.")
    zigzag = [place // 2 + 1 if place % 2 else (count - place // 2) % count for place in range(count)]
    square = [[(entry + shift) % count for entry in zigzag] for shift in range(count)]
    return square if count % 2 == 0 else square + [row[::-1] for row in square]


def assigned(conditions: Sequence[str], people: int, rng: np.random.Generator) -> list[str]:
    """A condition for each person: random blocks, each with every condition once.

    At any time the numbers of people differ by one at most; they are equal after whole blocks.

    Raises:
        UserError: there is no condition.
    """
    if not conditions:
        raise UserError("People cannot be assigned: there is no condition.")
    blocks = -(-people // len(conditions))
    places = [place for _ in range(blocks) for place in rng.permutation(len(conditions))]
    return [str(conditions[place]) for place in places[:people]]


def orders(conditions: Sequence[str], people: int, rng: np.random.Generator) -> list[tuple[str, ...]]:
    """An order for each person: whole Williams designs, the conditions and the rows of each in random order.

    The balance is complete where the number of people is a multiple of the design's rows.

    Raises:
        UserError: there is no condition.
    """
    found: list[tuple[str, ...]] = []
    while len(found) < people:
        names = rng.permutation(np.array(conditions, dtype=object))
        rows = williams(len(conditions))
        found += [tuple(str(names[entry]) for entry in rows[row]) for row in rng.permutation(len(rows))]
    return found[:people]
