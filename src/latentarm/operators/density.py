"""Equation 24 over continuous inputs: how likely each deflection of the stick is, and draws from that.

The inputs are the unit ball: [-1, 1] for one axis, the disc of a round stick for two. What an input costs is
known at the nodes of a lattice in polar coordinates, and modelled between them: along each direction by the
parabola through its three nodes, which is exact where the tool moves in proportion to the push, and between
the directions of a disc by cubics. The model proposes inputs; what they truly cost then corrects the model's
error (sampling importance resampling, Rubin 1987). So the draws tend to equation 24 as the proposals become
many, whatever the model's error.
"""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from typing import Final, Self, final

import numpy as np

from latentarm.errors import UserError
from latentarm.types import BoolArray, FloatArray, IntArray

RADII: Final = np.array([0.2, 0.6, 1.0])
"""Lengths of an input at which its cost is known."""

DIRECTIONS: Final = 64
"""Directions of a disc in which the cost is known, ..."""

REFINED: Final = 2
"""... and how many times as many are modelled."""

MANY_DIRECTIONS: Final = 256
"""Directions of more than two axes; between these nothing is modelled."""

RINGS: Final = 32
"""Cells along a direction; in each, the logarithm of the density is modelled as linear."""

PROPOSALS: Final = 64
"""Inputs that are proposed for each one that is drawn."""

SHARPEST: Final = 5e4
"""Largest beta times range of the costs of the model that proposes: its cells are no finer. Beyond, the true
costs choose among less sharp proposals."""


@final
@dataclass(frozen=True, eq=False)
class Lattice:
    """Directions of the stick, and the inputs along them whose cost must be known.

    Attributes:
        directions: (D, d), unit vectors.
        nodes: (D * 3, d), each direction at every one of `RADII`.
        refinement: (F, D), costs in the F directions of the model from those in the D known ones.
        ring_volume: (RINGS,), integral of r^(d - 1) over each cell.
    """

    directions: FloatArray
    nodes: FloatArray
    refinement: FloatArray
    ring_volume: FloatArray

    @classmethod
    def of(cls, axes: int, rng: np.random.Generator) -> Self:
        """The lattice of a stick: fixed for one axis and two, randomly turned for more.

        Args:
            axes: d.
            rng: of the turn.
        """
        fixed = _lattice(axes)
        if axes <= 2:
            return cls(*fixed)
        directions, nodes, *others = fixed
        turn = np.linalg.qr(rng.normal(size=(axes, axes)))[0]
        return cls(directions @ turn, nodes @ turn, *others)

    @property
    def axes(self) -> int:
        """Number of axes d."""
        return self.directions.shape[1]

    def near(self, direction: IntArray, rng: np.random.Generator) -> FloatArray:
        """Unit vectors (..., d) about directions of the model, by index (...), so that no gap is left."""
        if self.axes != 2:
            return self.directions[direction]
        angle = (direction + rng.uniform(-0.5, 0.5, direction.shape)) * (2.0 * np.pi / len(self.refinement))
        return np.stack([np.cos(angle), np.sin(angle)], axis=-1)


@final
class CostModel:
    """What inputs cost between the nodes of a lattice.

    Args:
        lattice: of the stick.
        cost: (K,), of the lattice's nodes, zero or more, m². Directions with one that is not finite are left
            out.

    Attributes:
        lattice: the same.
        direction: (F',), index of each direction of the model that is not left out.
        at_edges: (F', RINGS + 1), cost along each of these at the edges of the cells, m².
        least: the least of these, m²; infinity where every direction is left out.
    """

    def __init__(self, lattice: Lattice, cost: FloatArray) -> None:
        by_direction = cost.reshape(-1, len(RADII))
        known: BoolArray = np.logical_and.reduce(np.isfinite(by_direction), axis=1)
        usable = np.abs(lattice.refinement[:, ~known]).sum(axis=1) == 0.0
        at_nodes = np.where(known[:, None], by_direction, 0.0)
        self.lattice = lattice
        self.direction = np.flatnonzero(usable)
        # Cubics may overshoot, but no cost is negative.
        self.at_edges = np.maximum(lattice.refinement[usable] @ (at_nodes @ _TO_EDGES), 0.0)
        self.least = float(self.at_edges.min(initial=np.inf))


@final
class InputDensity:
    """The density ``p(u) ∝ exp(-beta cost(u))`` over the unit ball.

    Args:
        model: what inputs cost, nearly.
        beta: zero or more, 1/m²; infinity leaves only the best input.

    Attributes:
        value: the cost of one certain input that is worth as much as the choice among all of these, m²:
            ``-log(mean exp(-beta cost)) / beta`` over the ball. The least cost where beta is infinite, the
            mean cost where it is zero, and infinity where no cost is finite.

    Raises:
        UserError: beta is negative or not a number.
    """

    def __init__(self, model: CostModel, beta: float) -> None:
        if not beta >= 0:
            raise UserError("A simulated person's rationality beta must be zero or more.")
        self._model, self._beta = model, beta
        if not len(model.direction):
            self.value = np.inf
            return
        volume = model.lattice.ring_volume
        spread = max(float(model.at_edges.max()) - model.least, float(np.finfo(float).tiny))
        sharpness = min(beta, SHARPEST / spread)
        self._exponent = sharpness * (model.at_edges - model.least)
        self._cumulative = np.cumsum(volume * _mean_exponential(self._exponent))
        if beta == 0.0:
            in_cells = (model.at_edges[:, :-1] + model.at_edges[:, 1:]) / 2.0
            self.value = float(np.average(in_cells.mean(axis=0), weights=volume))
        elif np.isinf(beta):
            self.value = model.least
        else:
            mean = self._cumulative[-1] / (len(model.lattice.refinement) * volume.sum())
            self.value = model.least - float(np.log(mean)) / sharpness

    def draw(
        self, cost_of: Callable[[FloatArray], FloatArray], rng: np.random.Generator, count: int = 1
    ) -> FloatArray:
        """Draw inputs, each by itself: (count, d). All proposals are looked at in one call.

        Args:
            cost_of: what inputs (N, d) truly cost, (N,), m².
            rng: source of all randomness.
            count: how many.

        Returns:
            Inputs of length 1 at most; zero, which is to let go, where no proposal has a finite cost.
        """
        axes = self._model.lattice.axes
        if not len(self._model.direction):
            return np.zeros((count, axes))
        proposed, log_weight = self._proposed(rng, count)
        cost = cost_of(proposed.reshape(-1, axes)).reshape(log_weight.shape)
        above = np.where(np.isfinite(cost), cost - self._model.least, np.inf)
        least = above.min(axis=1, keepdims=True)
        with np.errstate(invalid="ignore", over="ignore"):
            loss = np.where(above > least, self._beta * (above - least), 0.0)
            # The proposals' own density says nothing where only the best one counts.
            log_weight = -loss + (0.0 if np.isinf(self._beta) else log_weight)
        log_weight[~np.isfinite(above)] = -np.inf
        # The largest of log-weights with Gumbel noise is a draw in proportion to the weights.
        chosen = (log_weight + rng.gumbel(size=log_weight.shape)).argmax(axis=1)
        rows = np.arange(count)
        return np.where(np.isfinite(above[rows, chosen])[:, None], proposed[rows, chosen], 0.0)

    def _proposed(self, rng: np.random.Generator, count: int) -> tuple[FloatArray, FloatArray]:
        """Inputs (count, P, d) out of the model, and the logarithm (count, P) of volume over density."""
        shape = (count, PROPOSALS)
        strata = (np.arange(PROPOSALS) + rng.random(shape)) / PROPOSALS
        cell = np.searchsorted(self._cumulative, strata * self._cumulative[-1], side="right")
        row, ring = np.divmod(np.minimum(cell, len(self._cumulative) - 1), RINGS)
        near, far = self._exponent[row, ring], self._exponent[row, ring + 1]
        share = _from_exponential(far - near, rng.random(shape))
        radius = (ring + share) / RINGS
        lattice = self._model.lattice
        volume = (lattice.axes - 1) * np.log(radius) - np.log(lattice.ring_volume[ring])
        direction = lattice.near(self._model.direction[row], rng)
        return radius[..., None] * direction, volume + near + share * (far - near)


def _mean_exponential(exponent: FloatArray) -> FloatArray:
    """Mean of exp(-x) over each cell, (F, RINGS), where x is linear between its edges (F, RINGS + 1)."""
    steep = np.abs(np.diff(exponent, axis=1))
    shape = np.divide(-np.expm1(-steep), steep, out=np.ones_like(steep), where=steep > 1e-9)
    return np.exp(-np.minimum(exponent[:, :-1], exponent[:, 1:])) * shape


def _from_exponential(slope: FloatArray, chance: FloatArray) -> FloatArray:
    """Draws from the density ∝ exp(-slope t) on (0, 1], from chances in [0, 1)."""
    steep = np.abs(slope)
    shares = np.where(steep > 1e-9, -np.log1p(chance * np.expm1(-steep)) / np.maximum(steep, 1e-9), chance)
    return np.clip(np.where(slope < 0, 1.0 - shares, shares), 1e-9, 1.0)


def _to_edges() -> FloatArray:
    """(3, RINGS + 1): costs at `RADII` to those of the parabola through them at the cells' edges."""
    edges = np.linspace(0.0, 1.0, RINGS + 1)
    others = [np.delete(RADII, one) for one in range(len(RADII))]
    return np.stack(
        [((edges - b) * (edges - c)) / ((a - b) * (a - c)) for a, (b, c) in zip(RADII, others, strict=True)]
    )


_TO_EDGES: Final = _to_edges()


@cache
def _lattice(axes: int) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
    """The fields of `Lattice`, not turned."""
    if axes == 1:
        directions = np.array([[1.0], [-1.0]])
    elif axes == 2:
        angle = np.arange(DIRECTIONS) * (2.0 * np.pi / DIRECTIONS)
        directions = np.stack([np.cos(angle), np.sin(angle)], axis=-1)
    else:
        spread = np.random.default_rng(0).normal(size=(MANY_DIRECTIONS, axes))
        directions = spread / np.linalg.norm(spread, axis=1, keepdims=True)
    nodes = (directions[:, None] * RADII[:, None]).reshape(-1, axes)
    refinement = _cubics() if axes == 2 else np.eye(len(directions))
    return directions, nodes, refinement, np.diff(np.linspace(0.0, 1.0, RINGS + 1) ** axes) / axes


def _cubics() -> FloatArray:
    """(F, D): values at equal angles to values at `REFINED` times as many, by cubics through four."""
    matrix = np.zeros((REFINED * DIRECTIONS, DIRECTIONS))
    for fine in range(len(matrix)):
        before, step = divmod(fine, REFINED)
        t = step / REFINED
        weights = (
            -t * (t - 1) * (t - 2) / 6,
            (t + 1) * (t - 1) * (t - 2) / 2,
            -(t + 1) * t * (t - 2) / 2,
            (t + 1) * t * (t - 1) / 6,
        )
        for offset, weight in zip((-1, 0, 1, 2), weights, strict=True):
            matrix[fine, (before + offset) % DIRECTIONS] += weight
    return matrix
