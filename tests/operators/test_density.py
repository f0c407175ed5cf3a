"""Draws of equation 24 over continuous inputs, against fine quadrature of the density itself."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.stats import chisquare

from latentarm.errors import UserError
from latentarm.operators.density import CostModel, InputDensity, Lattice

TOOL = np.array([[0.10, 0.03], [0.0, 0.08], [0.02, 0.0]])
"""(3, 2), how far a full push along each axis moves the tool, m."""

FAR, NEAR = np.array([0.4, 0.3, 0.0]), np.array([0.03, 0.02, 0.01])
BINS = 12


def proportional(u, off):
    """Squared distance left, m², by a tool that moves in proportion to the push."""
    return np.square(off - u @ TOOL.T[: u.shape[-1]]).sum(axis=-1)


def bending(u, off):
    """The same where the tool drifts at rest and turns with the push, as a decoder's may."""
    return proportional(u + 0.15 * np.sin(2.0 * u[..., ::-1] + 0.4), off)


def lattice(axes, seed=0):
    return Lattice.of(axes, np.random.default_rng(seed))


def drawn(cost, beta, axes, count, seed=0):
    grid = lattice(axes, seed)
    return InputDensity(CostModel(grid, cost(grid.nodes)), beta).draw(
        cost, np.random.default_rng(seed), count
    )


def marginals(cost, beta):
    """Edges of cells of length and of angle, each with the probability below them."""
    # Cells crowd towards the rim, where a sharp density lives.
    length = np.concatenate([np.linspace(0.0, 0.9, 200), 1.0 - np.geomspace(0.1, 1e-6, 400), [1.0]])
    angle = np.linspace(-np.pi, np.pi, 2001)
    r, a = ((edges[1:] + edges[:-1]) / 2 for edges in (length, angle))
    u = r[:, None, None] * np.stack([np.cos(a), np.sin(a)], axis=-1)
    loss = beta * cost(u)
    weight = np.exp(loss.min() - loss) * (r * np.diff(length))[:, None]
    return tuple(
        (edges, np.insert(np.cumsum(weight.sum(axis=other)) / weight.sum(), 0, 0.0))
        for edges, other in ((length, 1), (angle, 0))
    )


def p_value(marginal, draws):
    """Of the test that draws fall as often into each of `BINS` cells of equal probability."""
    edges, below = marginal
    inner = np.interp(np.arange(1, BINS) / BINS, below, edges)
    return chisquare(np.bincount(np.searchsorted(inner, draws), minlength=BINS)).pvalue


@pytest.mark.parametrize("cost", [proportional, bending])
@pytest.mark.parametrize(
    ("off", "beta"), [(FAR, 20.0), (FAR, 300.0), (FAR, 2000.0), (NEAR, 2000.0), (NEAR, 2e4)]
)
def test_draws_follow_equation_24(cost, off, beta):
    def here(u):
        return cost(u, off)

    by_length, by_angle = marginals(here, beta)
    draws = drawn(here, beta, 2, 4000)
    assert p_value(by_length, np.linalg.norm(draws, axis=1)) > 1e-3
    assert p_value(by_angle, np.arctan2(draws[:, 1], draws[:, 0])) > 1e-3


@pytest.mark.parametrize("beta", [0.0, 30.0, 1000.0])
def test_draws_along_one_axis_follow_equation_24(beta):
    def here(u):
        return bending(np.concatenate([u, np.zeros_like(u)], axis=-1), NEAR)

    edges = np.linspace(-1.0, 1.0, 20001)
    weight = np.exp(-beta * here((edges[1:, None] + edges[:-1, None]) / 2))
    below = np.insert(np.cumsum(weight) / weight.sum(), 0, 0.0)
    assert p_value((edges, below), drawn(here, beta, 1, 4000)[:, 0]) > 1e-3


@pytest.mark.parametrize("axes", [1, 2, 3])
def test_without_reason_inputs_are_uniform_on_the_ball(axes):
    draws = np.concatenate(
        [drawn(lambda u: proportional(u[..., :2], FAR), 0.0, axes, 40, seed) for seed in range(100)]
    )
    radius = np.linalg.norm(draws, axis=1)
    assert radius.max() <= 1.0
    # The volume within a radius, and the angle in the first two axes, are uniform.
    volumes = np.histogram(radius**axes, bins=BINS, range=(0, 1))[0]
    assert chisquare(volumes).pvalue > 1e-3
    side = draws[:, 0] if axes == 1 else np.arctan2(draws[:, 1], draws[:, 0]) / np.pi
    assert chisquare(np.histogram(side, bins=BINS, range=(-1, 1))[0]).pvalue > 1e-3


@given(st.floats(-np.pi, np.pi), st.floats(0.2, 1.0))
def test_endless_reason_aims_within_a_degree(angle, size):
    # The tool moves alike in all directions, so the best input points at the target.
    aim = np.array([np.cos(angle), np.sin(angle)])

    def here(u):
        return np.square(0.1 * (size * aim - u)).sum(axis=-1)

    best = drawn(here, np.inf, 2, 1)[0]
    assert np.rad2deg(np.arccos(np.clip(best @ aim / np.linalg.norm(best), -1, 1))) < 1.0
    assert np.linalg.norm(best) == pytest.approx(size, abs=0.03)


def test_the_value_of_a_choice_is_between_the_best_and_the_mean():
    grid = lattice(2)
    cost = CostModel(grid, proportional(grid.nodes, NEAR))
    value = [InputDensity(cost, beta).value for beta in (0.0, 1.0, 100.0, 1e4, 1e8, np.inf)]
    assert value == sorted(value, reverse=True)
    # Sunflower points are spread evenly over the disc.
    turn = np.arange(20000) * np.pi * (3.0 - np.sqrt(5.0))
    u = np.sqrt((np.arange(20000) + 0.5) / 20000)[:, None] * np.stack([np.cos(turn), np.sin(turn)], axis=-1)
    everywhere = proportional(u, NEAR)
    assert value[0] == pytest.approx(everywhere.mean(), rel=0.1)
    by_hand = -np.log(np.exp(-100.0 * everywhere).mean()) / 100.0
    assert value[2] == pytest.approx(by_hand, rel=1e-3)


def test_what_cannot_be_imagined_is_never_given():
    grid = lattice(2)

    def half(u):
        return np.where(u[..., 0] > 0, np.nan, 0.0)

    density = InputDensity(CostModel(grid, half(grid.nodes)), 10.0)
    assert (density.draw(half, np.random.default_rng(0), 500)[:, 0] <= 0).all()
    nothing = InputDensity(CostModel(grid, np.full(len(grid.nodes), np.inf)), 10.0)
    assert nothing.value == np.inf
    assert not nothing.draw(half, np.random.default_rng(0)).any()


@pytest.mark.parametrize("beta", [-1.0, np.nan])
def test_a_rationality_that_cannot_be(beta):
    grid = lattice(2)
    with pytest.raises(UserError, match="beta"):
        InputDensity(CostModel(grid, np.zeros(len(grid.nodes))), beta)
