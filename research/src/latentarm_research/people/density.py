"""Equation 24 over continuous inputs: draws of the stick's deflection, and what the choice is worth.

The inputs are the unit ball without the stick's dead zone: for one axis [-1, 1], for two the disc of a round
stick, each without its middle. What an input leaves to the target, as a vector, is known at the nodes of a
lattice in polar coordinates, and modelled between them: along each direction by the cubic through its four
nodes, and between the directions of a disc by cubics too. The square of that is the modelled cost: exact
where the tool moves in proportion to the push, and never negative. The model only proposes inputs; what they
truly cost then corrects its errors (sampling importance resampling, Rubin 1987). So draws and worth tend to
equation 24 as the proposals become many, whatever the model's error.
"""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from typing import Final, Self, final

import numpy as np
from scipy.special import logsumexp

from latentarm.core.types import BoolArray, FloatArray, IntArray

STRETCHES: Final[FloatArray] = np.array([0.01, 0.3, 0.65, 1.0])
"""Where along a direction it is known what an input leaves: 0 at the edge of the dead zone, 1 at full
deflection. None is at the edge, where the arm still rests: a decoder that drifts jumps there."""

DIRECTIONS: Final = 64  # directions of a disc in which it is known, ...
REFINED: Final = 2  # ... and how many times as many are modelled
MANY_DIRECTIONS: Final = 256  # directions of more than two axes; between these nothing is modelled
RINGS: Final = 32  # cells along a direction; in each, the logarithm of the density is modelled as linear
PROPOSALS: Final = 64  # inputs that are proposed for each one that is drawn

SHARPEST: Final = 5e4
"""Largest beta times range of the costs of the model that proposes: its cells are no finer. Beyond, the true
costs choose among less sharp proposals."""


@final
@dataclass(frozen=True, eq=False)
class Lattice:
    """Directions of the stick, and the inputs along them of which it must be known what they leave."""

    directions: FloatArray  # (D, d), unit vectors
    nodes: FloatArray  # (D * 4, d), each direction at every one of `STRETCHES`
    refinement: FloatArray  # (F, D), values in the F directions of the model from those in the D known ones
    ring_edges: FloatArray  # (RINGS + 1,), lengths of an input at the edges of the cells along a direction
    ring_volume: FloatArray  # (RINGS,), integral of r^(d - 1) over each cell

    @classmethod
    def of(
        cls,
        axes: int,
        rng: np.random.Generator,
        dead_zone: float = 0.0,  # inputs no longer than this are neutral, in [0, 1)
    ) -> Self:
        """The lattice of a stick: fixed for one axis and two, randomly turned for more."""
        fixed = _lattice(axes, dead_zone)
        if axes <= 2:
            return cls(*fixed)
        directions, nodes, *others = fixed
        turn = np.linalg.qr(rng.normal(size=(axes, axes)))[0]
        return cls(directions @ turn, nodes @ turn, *others)

    @property
    def axes(self) -> int:
        """Number of axes d."""
        return self.directions.shape[1]

    def unit(self, direction: IntArray | FloatArray) -> FloatArray:
        """Unit vectors (..., d) of directions of the model, by index (...); of two axes, also between."""
        if self.axes != 2:
            return self.directions[direction.astype(np.intp)]
        angle = direction * (2.0 * np.pi / len(self.refinement))
        return np.stack([np.cos(angle), np.sin(angle)], axis=-1)

    def near(self, direction: IntArray, rng: np.random.Generator) -> FloatArray:
        """Unit vectors (..., d) about directions of the model, by index (...), so that no gap is left."""
        if self.axes != 2:
            return self.unit(direction)
        return self.unit(direction + rng.uniform(-0.5, 0.5, direction.shape))


@final
class CostModel:
    """What inputs cost between the nodes of a lattice.

    Args:
        lattice: of the stick.
        residual: (K, r), how far the lattice's nodes leave the tool from the target, m. Directions with one
            that is not finite are left out.

    Attributes:
        lattice: the same.
        direction: (F',), index of each direction of the model that is not left out.
        at_edges: (F', RINGS + 1), cost along each of these at the edges of the cells, m².
        least: the least of these, m²; infinity where every direction is left out.
    """

    def __init__(self, lattice: Lattice, residual: FloatArray) -> None:
        by_direction = residual.reshape(-1, len(STRETCHES) * residual.shape[-1])
        known: BoolArray = np.logical_and.reduce(np.isfinite(by_direction), axis=1)
        usable = np.abs(lattice.refinement[:, ~known]).sum(axis=1) == 0.0
        at_nodes = lattice.refinement[usable] @ np.where(known[:, None], by_direction, 0.0)
        at_edges = at_nodes.reshape(-1, len(STRETCHES), residual.shape[-1]).mT @ _TO_EDGES
        self.lattice = lattice
        self.direction = np.flatnonzero(usable)
        self.at_edges = np.square(at_edges).sum(axis=1)
        self.least = float(self.at_edges.min(initial=np.inf))

    @property
    def best(self) -> FloatArray:
        """(d,), the input that costs least by the model; zero where every direction is left out."""
        if not len(self.direction):
            return np.zeros(self.lattice.axes)
        row, edge = np.unravel_index(self.at_edges.argmin(), self.at_edges.shape)
        return self.lattice.ring_edges[edge] * self.lattice.unit(self.direction[row])


@final
@dataclass(frozen=True, eq=False)
class Draws:
    """Choices of equation 24, each by itself."""

    # (N, d), longer than the dead zone, and 1 at most; zero, which is to let go, where no proposal has a
    # finite cost
    inputs: FloatArray
    # (N,), the cost of one certain input that is worth as much as the choice among all of them, m²:
    # `-log(mean exp(-beta cost)) / beta`. The least cost where beta is infinite, the mean cost where it is
    # zero, and infinity where no cost is finite
    value: FloatArray
    least: FloatArray  # (N,), the least cost of the proposals, m²; infinity where none is finite


@final
class InputDensity:
    """The density ``p(u) ∝ exp(-beta cost(u))`` over the unit ball without the dead zone; beta in 1/m²."""

    def __init__(self, model: CostModel, beta: float) -> None:
        self._model, self._beta = model, beta
        if not len(model.direction):
            return
        spread = max(float(model.at_edges.max()) - model.least, float(np.finfo(float).tiny))
        self._exponent = min(beta, SHARPEST / spread) * (model.at_edges - model.least)
        self._cumulative = np.cumsum(model.lattice.ring_volume * _mean_exponential(self._exponent))

    def draw(
        self,
        cost_of: Callable[[FloatArray], FloatArray],  # what inputs (N, d) truly cost, (N,), m²
        rng: np.random.Generator,
        count: int = 1,
    ) -> Draws:
        """Draw inputs, each by itself. All proposals are looked at in one call."""
        axes = self._model.lattice.axes
        if not len(self._model.direction):
            nothing = np.full(count, np.inf)
            return Draws(np.zeros((count, axes)), nothing, nothing)
        proposed, log_weight = self._proposed(rng, count)
        cost = cost_of(proposed.reshape(-1, axes)).reshape(log_weight.shape)
        cost = np.where(np.isfinite(cost), cost, np.inf)
        least = cost.min(axis=1)
        # The proposals' own density says nothing where only the best one counts.
        log_weight = np.where(np.isfinite(cost), 0.0 if np.isinf(self._beta) else log_weight, -np.inf)
        with np.errstate(invalid="ignore", over="ignore"):
            above = np.where(cost > least[:, None], self._beta * (cost - least[:, None]), 0.0)
        # The largest of log-weights with Gumbel noise is a draw in proportion to the weights.
        chosen = (log_weight - above + rng.gumbel(size=cost.shape)).argmax(axis=1)
        finite = np.isfinite(least)
        inputs = np.where(finite[:, None], proposed[np.arange(count), chosen], 0.0)
        value = np.full(count, np.inf)
        value[finite] = self._worth(cost[finite], log_weight[finite], above[finite])
        return Draws(inputs, value, least)

    def _worth(self, cost: FloatArray, log_weight: FloatArray, above: FloatArray) -> FloatArray:
        """What choices (N,) among proposals (N, P) are worth, m²."""
        if np.isinf(self._beta):
            return cost.min(axis=1)
        if self._beta == 0.0:
            weight = np.exp(log_weight - log_weight.max(axis=1, keepdims=True))
            return np.vecdot(weight, np.where(weight > 0, cost, 0.0)) / weight.sum(axis=1)
        lattice = self._model.lattice
        cells = len(lattice.refinement) * lattice.ring_volume.sum() / np.diff(lattice.ring_edges).mean()
        mean = logsumexp(log_weight - above, axis=1) - np.log(cost.shape[1])
        return cost.min(axis=1) - (mean + np.log(self._cumulative[-1] / cells)) / self._beta

    def _proposed(self, rng: np.random.Generator, count: int) -> tuple[FloatArray, FloatArray]:
        """Inputs (count, P, d) out of the model, and the logarithm (count, P) of volume over density."""
        shape = (count, PROPOSALS)
        strata = (np.arange(PROPOSALS) + rng.random(shape)) / PROPOSALS
        cell = np.searchsorted(self._cumulative, strata * self._cumulative[-1], side="right")
        row, ring = np.divmod(np.minimum(cell, len(self._cumulative) - 1), RINGS)
        near, far = self._exponent[row, ring], self._exponent[row, ring + 1]
        share = _from_exponential(far - near, rng.random(shape))
        lattice = self._model.lattice
        radius = lattice.ring_edges[ring] + share * np.diff(lattice.ring_edges)[ring]
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
    """(4, RINGS + 1): values at `STRETCHES` to those of the cubic through them at the cells' edges."""
    power = np.arange(len(STRETCHES), dtype=np.float64)[:, None]
    edges = np.linspace(0.0, 1.0, RINGS + 1)
    return np.linalg.solve(STRETCHES**power, edges**power).astype(np.float64)


_TO_EDGES: Final = _to_edges()


@cache
def _lattice(
    axes: int, dead_zone: float
) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray, FloatArray]:
    """The fields of `Lattice`, not turned."""
    if axes == 1:
        directions = np.array([[1.0], [-1.0]])
    elif axes == 2:
        angle = np.arange(DIRECTIONS) * (2.0 * np.pi / DIRECTIONS)
        directions = np.stack([np.cos(angle), np.sin(angle)], axis=-1)
    else:
        spread = np.random.default_rng(0).normal(size=(MANY_DIRECTIONS, axes))
        directions = spread / np.linalg.norm(spread, axis=1, keepdims=True)
    lengths = dead_zone + (1.0 - dead_zone) * STRETCHES
    nodes = (directions[:, None] * lengths[:, None]).reshape(-1, axes)
    refinement = _cubics() if axes == 2 else np.eye(len(directions))
    edges = np.linspace(dead_zone, 1.0, RINGS + 1)
    return directions, nodes, refinement, edges, np.diff(edges**axes) / axes


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
