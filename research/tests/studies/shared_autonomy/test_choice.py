"""The continuous choice against the density that it draws from."""

from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from latentarm_research.studies.shared_autonomy.choice import DEAD_ZONE, KNOWN, choose


def density(cost, at_rest, beta, points=200_001):
    """p(u) on a fine grid, the dead zone at 0."""
    u = np.linspace(-1.0, 1.0, points)
    fine = np.where(np.abs(u) < DEAD_ZONE, at_rest, np.interp(u, KNOWN, cost))
    weight = np.exp(-beta * (fine - fine.min()))
    return np.where(np.abs(u) < DEAD_ZONE, 0.0, u), weight / weight.sum()


@pytest.mark.parametrize("beta", [0.0, 30.0, 1e3, 1e5])
def test_inputs_are_drawn_from_the_density_itself(beta):
    cost, at_rest = 0.01 * (KNOWN - 0.37) ** 2 + 0.002 * np.sin(5.0 * KNOWN), 0.0009
    n = 50_000
    # Evenly spaced chances: what is left of the error is the grids'.
    chance = (np.arange(n) + 0.5) / n
    u = choose(np.tile(cost, (n, 1)), np.full(n, at_rest), np.full(n, beta), chance)
    grid, weight = density(cost, at_rest, beta)
    assert u.mean() == pytest.approx((weight * grid).sum(), abs=1e-4)
    assert np.square(u).mean() == pytest.approx((weight * grid**2).sum(), abs=1e-4)
    assert (u == 0.0).mean() == pytest.approx(weight[grid == 0.0].sum(), abs=1e-4)
    edges = np.linspace(-1.0, 1.0, 8)
    share = [weight[(low <= grid) & (grid < high)].sum() for low, high in pairwise(edges)]
    np.testing.assert_allclose(np.histogram(u, edges)[0] / n, share, atol=2e-4)


@given(
    st.lists(st.floats(0.0, 10.0), min_size=len(KNOWN), max_size=len(KNOWN)),
    st.floats(0.0, 10.0),
    st.floats(0.0, np.inf),
    st.floats(0.0, 1.0, exclude_max=True),
)
def test_any_costs_give_an_input_and_perfect_people_the_cheapest(cost, at_rest, beta, chance):
    costs = np.array(cost)[None]
    one = (np.array([chance]),)
    (u,) = choose(costs, np.array([at_rest]), np.array([beta]), *one)
    assert -1.0 <= u <= 1.0
    assert u == 0.0 or abs(u) >= DEAD_ZONE - 1e-12
    (best,) = choose(costs, np.array([at_rest]), np.array([np.inf]), *one)
    near = 0.75 * costs[0, 5] + 0.25 * costs[0, [4, 6]]  # at the ends of the dead zone
    cheapest = min(at_rest, *near, *np.delete(costs[0], 5))
    assert (at_rest if best == 0.0 else np.interp(best, KNOWN, costs[0])) == pytest.approx(cheapest, abs=1e-6)
