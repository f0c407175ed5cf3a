"""Draws of equation 24 over continuous inputs, against fine quadrature of the density itself."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.stats import chisquare

from latentarm_research.people.density import CostModel, InputDensity, Lattice

TOOL = np.array([[0.10, 0.03], [0.0, 0.08], [0.02, 0.0]])
"""(3, 2), how far a full push along each axis moves the tool, m."""

FAR, NEAR = np.array([0.4, 0.3, 0.0]), np.array([0.03, 0.02, 0.01])
BINS = 12


def proportional(u, off):
    """What is left, m, by a tool that moves in proportion to the push."""
    return off - u @ TOOL.T[: u.shape[-1]]


def bending(u, off):
    """The same where the tool drifts at rest and turns with the push, as a decoder's may."""
    return proportional(u + 0.15 * np.sin(2.0 * u[..., ::-1] + 0.4), off)


def cost_of(residual):
    """What inputs cost, m²."""
    return lambda u: np.square(residual(u)).sum(axis=-1)


def lattice(axes, seed=0, dead_zone=0.0):
    return Lattice.of(axes, np.random.default_rng(seed), dead_zone)


def draws(residual, beta, axes, count, seed=0, dead_zone=0.0):
    grid = lattice(axes, seed, dead_zone)
    density = InputDensity(CostModel(grid, residual(grid.nodes)), beta)
    return density.draw(cost_of(residual), np.random.default_rng(seed), count)


def marginals(cost, beta, dead_zone):
    """Edges of cells of length and of angle, each with the probability below them."""
    # Cells crowd towards the rim, where a sharp density lives.
    crowded = 1.0 - np.geomspace(0.1, 1e-6, 200)
    length = np.concatenate([np.linspace(dead_zone, 0.9, 100), crowded, [1.0]])
    angle = np.linspace(-np.pi, np.pi, 721)
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


@pytest.mark.parametrize("dead_zone", [0.0, 0.3])
@pytest.mark.parametrize("residual", [proportional, bending])
@pytest.mark.parametrize(
    ("off", "beta"), [(FAR, 20.0), (FAR, 300.0), (FAR, 2000.0), (NEAR, 2000.0), (NEAR, 2e4)]
)
def test_draws_follow_equation_24(residual, off, beta, dead_zone):
    def here(u):
        return residual(u, off)

    by_length, by_angle = marginals(cost_of(here), beta, dead_zone)
    given = draws(here, beta, 2, 4000, dead_zone=dead_zone).inputs
    length = np.linalg.norm(given, axis=1)
    assert (length > dead_zone).all()
    assert p_value(by_length, length) > 1e-3
    assert p_value(by_angle, np.arctan2(given[:, 1], given[:, 0])) > 1e-3


@pytest.mark.parametrize("beta", [0.0, 30.0, 1000.0])
def test_draws_along_one_axis_follow_equation_24(beta):
    def here(u):
        return bending(np.concatenate([u, np.zeros_like(u)], axis=-1), NEAR)

    edges = np.linspace(-1.0, 1.0, 20001)
    weight = np.exp(-beta * cost_of(here)((edges[1:, None] + edges[:-1, None]) / 2))
    below = np.insert(np.cumsum(weight) / weight.sum(), 0, 0.0)
    assert p_value((edges, below), draws(here, beta, 1, 4000).inputs[:, 0]) > 1e-3


@pytest.mark.parametrize("axes", [1, 2, 3])
def test_without_reason_inputs_are_uniform_on_the_ball(axes):
    given = np.concatenate(
        [draws(lambda u: proportional(u[..., :2], FAR), 0.0, axes, 40, seed).inputs for seed in range(100)]
    )
    radius = np.linalg.norm(given, axis=1)
    assert radius.max() <= 1.0
    # The volume within a radius, and the angle in the first two axes, are uniform.
    volumes = np.histogram(radius**axes, bins=BINS, range=(0, 1))[0]
    assert chisquare(volumes).pvalue > 1e-3
    side = given[:, 0] if axes == 1 else np.arctan2(given[:, 1], given[:, 0]) / np.pi
    assert chisquare(np.histogram(side, bins=BINS, range=(-1, 1))[0]).pvalue > 1e-3


@given(st.floats(-np.pi, np.pi), st.floats(0.2, 1.0))
def test_endless_reason_aims_within_a_degree(angle, size):
    # The tool moves alike in all directions, so the best input points at the target.
    aim = np.array([np.cos(angle), np.sin(angle)])

    def here(u):
        return 0.1 * (size * aim - u)

    best = draws(here, np.inf, 2, 1).inputs[0]
    assert np.rad2deg(np.arccos(np.clip(best @ aim / np.linalg.norm(best), -1, 1))) < 1.0
    assert np.linalg.norm(best) == pytest.approx(size, abs=0.03)


@pytest.mark.parametrize("residual", [proportional, bending])
@pytest.mark.parametrize("beta", [0.0, 1.0, 100.0, 1e4, np.inf])
def test_a_choice_is_worth_what_equation_24_makes_of_it(residual, beta):
    def here(u):
        return residual(u, NEAR)

    # Sunflower points are spread evenly over the disc.
    points = 200_000
    turn = np.arange(points) * np.pi * (3.0 - np.sqrt(5.0))
    length = np.sqrt((np.arange(points) + 0.5) / points)
    everywhere = cost_of(here)(length[:, None] * np.stack([np.cos(turn), np.sin(turn)], axis=-1))
    least = everywhere.min()
    choices = draws(here, beta, 2, 500)
    if beta == 0.0:
        assert choices.value.mean() == pytest.approx(everywhere.mean(), rel=0.01)
    elif np.isinf(beta):
        assert choices.value.mean() == pytest.approx(least, rel=0.01)
    else:
        by_hand = np.exp(-beta * (everywhere - least)).mean()
        estimated = np.exp(-beta * (choices.value - least))
        assert estimated.mean() == pytest.approx(by_hand, rel=0.01)
        # One estimate is good enough to decide by.
        assert estimated.std() < 0.3 * by_hand
    assert (choices.least >= least - 1e-7).all()


def test_a_decoder_that_drifts_beyond_the_dead_zone_is_modelled_as_it_is_there():
    """At rest the tool stays 0.1 m away; the lightest push releases a drift that takes it to the target."""

    def drifting(u):
        pushed = np.linalg.norm(u, axis=-1, keepdims=True) > 0.02
        return np.where(pushed, 0.02 * u, 0.1)

    grid = lattice(2, dead_zone=0.02)
    model = CostModel(grid, drifting(grid.nodes))
    assert np.linalg.norm(model.best) == pytest.approx(0.02)
    assert model.at_edges[:, 0] == pytest.approx((0.02 * 0.02) ** 2, rel=0.1)


def test_where_the_model_is_wrong_only_true_costs_count():
    grid = lattice(2)
    shown = CostModel(grid, np.full((len(grid.nodes), 3), 0.05))
    choices = InputDensity(shown, 2000.0).draw(
        cost_of(lambda u: u[..., :1] - 0.3), np.random.default_rng(0), 50
    )
    off = np.abs(choices.inputs[:, 0] - 0.3)
    assert np.median(off) < 0.05
    assert (choices.least <= np.square(off) + 1e-12).all()


def test_what_cannot_be_imagined_is_never_given():
    grid = lattice(2)

    def half(u):
        return np.where(u[..., :1] > 0, np.nan, 0.0)

    density = InputDensity(CostModel(grid, half(grid.nodes)), 10.0)
    assert (density.draw(cost_of(half), np.random.default_rng(0), 500).inputs[:, 0] <= 0).all()
    unknown = CostModel(grid, np.full((len(grid.nodes), 3), np.inf))
    nothing = InputDensity(unknown, 10.0).draw(cost_of(half), np.random.default_rng(0))
    assert nothing.value == np.inf
    assert not nothing.inputs.any()
    assert not unknown.best.any()
