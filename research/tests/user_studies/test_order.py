from collections import Counter
from itertools import pairwise

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from latentarm_research.user_studies.designs import orders, williams


@given(st.integers(2, 12))
def test_a_williams_design_is_balanced(count: int) -> None:
    rows = williams(count)
    assert len(rows) == (count if count % 2 == 0 else 2 * count)
    assert all(sorted(row) == list(range(count)) for row in rows)
    places = Counter((place, entry) for row in rows for place, entry in enumerate(row))
    follows = Counter(pair for row in rows for pair in pairwise(row))
    assert set(places.values()) == {len(rows) // count}
    assert set(follows.values()) == {len(rows) // count}
    assert len(follows) == count * (count - 1)


@settings(max_examples=30)
@given(st.integers(2, 6), st.integers(1, 30), st.integers(0, 100))
def test_orders_are_balanced_as_far_as_the_people_go(count: int, people: int, seed: int) -> None:
    names = [f"c{index}" for index in range(count)]
    found = orders(names, people, np.random.default_rng(seed))
    assert len(found) == people
    assert all(sorted(order) == names for order in found)
    assert found == orders(names, people, np.random.default_rng(seed))
    rows = len(williams(count))
    whole = found[: people - people % rows]
    first = Counter(order[0] for order in whole)
    assert len(set(first.values())) <= 1
