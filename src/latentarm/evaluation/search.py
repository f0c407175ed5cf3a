"""The search encoder: the input whose decoded action is nearest, whatever the decoder.

What a decoder can express is a property of the decoder alone. An encoder network may miss it, and the
encoders of some models are themselves searches, each over a range of its own. So this search answers the same
question for every decoder:

    z*(c, a) = argmin ‖a - phi(z, c)‖^2 over z in [-1, 1]^d,

the range that a person's stick has (inputs are scaled so that the demonstrations fill it, see
`latentarm.models.scaling`).

Nothing but `decode` is used. A decoder that is affine in z, which is checked, has a convex problem and its
exact solution. Any other is tried at a fixed set of inputs: an even grid, which finds the valleys of smooth
decoders; rays from rest at full and half length, which find those that turn fast with the stick, and at the
length that would be best if the action grew in proportion, which finds slow motions; and, where they are
given, an encoder's codes, brought into the range, so that the result is never worse than these. The best of
them that lie apart are refined by Levenberg-Marquardt steps within the box (Nocedal and Wright, Numerical
Optimization, section 10.3), in rounds after each of which only the better ones go on.
"""

import itertools
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np

from latentarm.core.types import BoolArray, FloatArray, IntArray
from latentarm.evaluation.bounded_least_squares import bounded_least_squares
from latentarm.evaluation.contract import DecodesActions

GRID: Final = {1: 33, 2: 7, 3: 5}  # values per axis, by d; beyond that `SCATTERED` points
RAYS: Final = 48  # directions from rest for d > 1
SCATTERED: Final = 128
ROUNDS: Final = ((12, 2), (6, 3), (3, 6), (1, 40))
"""Of each pair, how many of the best searches go on, and for how many steps at most."""

APART: Final = 0.35
"""Two starts differ on some axis by this share of the larger one's size, so that slow motions, near rest,
have starts in several directions too."""

LEAST_SIZE: Final = 0.05  # inputs nearer to rest than this count as this large
AT_ONCE: Final = 4096
"""Inputs tried at a time, so that the values of a hidden layer stay in the processor's cache."""

BLOCK: Final = 256  # pairs refined at a time
DIFFERENCE: Final = 1e-4  # of z, for numeric derivatives
STOPPED: Final = 1e-5  # a search whose next step would change no axis by more than this has ended
FIRST_DAMPING: Final = 1e-3
"""Relative to the mean curvature; ten times less after a step that helped, ten times more after another."""

AFFINE: Final = 1e-9  # deviation from an affine map, relative to the largest action, that is rounding
Decode = Callable[[FloatArray, FloatArray], FloatArray]


def nearest_latents(
    decoders: Sequence[DecodesActions],
    context: FloatArray,
    action: FloatArray,
    codes: FloatArray | None = None,
) -> FloatArray:
    """The inputs (S, N, d) in [-1, 1] whose decoded actions are nearest to ``action`` (N, m), rad/s.

    ``codes`` (S, N, d), such as an encoder's, are brought into [-1, 1] and then inputs to beat.
    """
    found = np.zeros((len(decoders), len(action), decoders[0].latent_dim))
    fixed = _fixed_inputs(found.shape[-1])
    for seed, decoder in enumerate(decoders):
        for first in range(0, len(action), BLOCK):
            block = slice(first, first + BLOCK)
            given = None if codes is None else np.clip(codes[seed, block], -1.0, 1.0)
            # A decoder may overflow far from its data; such inputs lose every comparison.
            with np.errstate(over="ignore", invalid="ignore"):
                found[seed, block] = _nearest(decoder.decode, fixed, context[block], action[block], given)
    return found


@dataclass(frozen=True)
class _FixedInputs:
    """Inputs that are tried in every context."""

    grid: FloatArray  # (G, d), over the whole range
    rim: FloatArray  # (R, d), on its surface, one for each ray from rest


def _fixed_inputs(latent_dim: int) -> _FixedInputs:
    if latent_dim in GRID:
        values = np.linspace(-1.0, 1.0, GRID[latent_dim])
        grid = np.array(list(itertools.product(values, repeat=latent_dim)))
    else:
        grid = np.random.default_rng(0).uniform(-1.0, 1.0, (SCATTERED, latent_dim))
    rays = np.concatenate([np.eye(latent_dim), -np.eye(latent_dim)])
    if latent_dim == 2:
        angle = np.arange(RAYS) * (2.0 * np.pi / RAYS)
        rays = np.stack([np.cos(angle), np.sin(angle)], axis=-1)
    elif latent_dim > 2:
        rays = np.concatenate([rays, np.random.default_rng(1).normal(size=(RAYS, latent_dim))])
    return _FixedInputs(grid, rays / np.abs(rays).max(axis=-1, keepdims=True))


def _nearest(
    decode: Decode, fixed: _FixedInputs, context: FloatArray, action: FloatArray, codes: FloatArray | None
) -> FloatArray:
    """`nearest_latents` of one decoder and a bounded number of pairs, (N, d)."""
    solved = _if_affine(decode, fixed, context, action)
    if solved is not None:
        return solved
    rows = max(1, AT_ONCE // (len(fixed.grid) + 3 * len(fixed.rim)))
    parts = [slice(first, first + rows) for first in range(0, len(action), rows)]
    starts = [
        _starts(decode, fixed, context[part], action[part], None if codes is None else codes[part])
        for part in parts
    ]
    search = _Search(decode, context, action, *(np.concatenate(of) for of in zip(*starts, strict=True)))
    for searches, steps in ROUNDS:
        search.keep(searches)
        search.refine(steps)
    return search.z[:, 0]


def _starts(
    decode: Decode, fixed: _FixedInputs, context: FloatArray, action: FloatArray, codes: FloatArray | None
) -> tuple[FloatArray, FloatArray]:
    """Inputs (N, K, d) to refine, and their decoded actions (N, K, m)."""
    dim, rays = fixed.rim.shape[1], len(fixed.rim)
    inputs = np.concatenate([np.zeros((1, dim)), fixed.rim, fixed.rim / 2.0, fixed.grid])
    tried = _repeated(inputs, len(context))
    came = decode(tried, context[:, None])
    rest, swing = came[:, 0], came[:, 1 : 1 + rays] - came[:, :1]
    along = np.vecdot(swing, (action - rest)[:, None])
    share = np.clip(along / np.maximum(np.vecdot(swing, swing), np.finfo(float).tiny), 0.0, 1.0)
    further = share[..., None] * fixed.rim
    if codes is not None:
        further = np.concatenate([further, codes[:, None]], axis=1)
    tried = np.concatenate([tried, further], axis=1)
    came = np.concatenate([came, decode(further, context[:, None])], axis=1)
    row = np.arange(len(context))[:, None]
    chosen = _apart(tried, _cost(came, action[:, None]))
    return tried[row, chosen], came[row, chosen]


def _repeated(inputs: FloatArray, rows: int) -> FloatArray:
    """The same inputs (K, d) in every context: (rows, K, d)."""
    return np.broadcast_to(inputs, (rows, *inputs.shape))


def _cost(came: FloatArray, action: FloatArray) -> FloatArray:
    """Squared distances (...,), infinite where a decoder overflows."""
    cost = np.square(came - action).sum(axis=-1)
    return np.where(np.isfinite(cost), cost, np.inf)


def _if_affine(
    decode: Decode, fixed: _FixedInputs, context: FloatArray, action: FloatArray
) -> FloatArray | None:
    """The exact solution where the decoder is affine in z, as far as inputs all over the range tell."""
    d = fixed.rim.shape[1]
    probes = np.concatenate([np.zeros((1, d)), np.eye(d), -np.eye(d), fixed.grid[:: len(fixed.grid) // 5]])
    came = decode(_repeated(probes, len(context)), context[:, None])
    rest = came[:, 0]
    columns = np.swapaxes(came[:, 1 : 1 + d] - came[:, :1], 1, 2)
    expected = rest[:, None] + probes @ columns.mT
    if not np.abs(came - expected).max() <= AFFINE * np.abs(came).max():
        return None
    target = np.vecdot(columns.mT, (action - rest)[:, None])
    box = np.ones_like(target)
    return bounded_least_squares(columns.mT @ columns, target, -box, box)


def _apart(tried: FloatArray, cost: FloatArray) -> IntArray:
    """Indices (N, K) of the best of inputs tried (N, T, d) that lie apart from each other."""
    row, left = np.arange(len(tried)), cost.copy()
    size = np.maximum(np.abs(tried).max(axis=-1), LEAST_SIZE)
    chosen: list[IntArray] = []
    for _ in range(ROUNDS[0][0]):
        best = np.argmin(left, axis=1)
        chosen.append(best)
        away = np.abs(tried - tried[row, best][:, None]).max(axis=-1)
        left[away < APART * np.maximum(size, size[row, best][:, None])] = np.inf
    return np.stack(chosen, axis=1)


class _Search:
    """Several searches for each pair, side by side; ``z`` (N, K, d) are the best inputs so far."""

    def __init__(
        self, decode: Decode, context: FloatArray, action: FloatArray, z: FloatArray, came: FloatArray
    ) -> None:
        self._decode, self._context, self._action = decode, context, action
        self.z, self._came = z, came
        self._cost = _cost(came, action[:, None])
        self._damping = np.full(self._cost.shape, FIRST_DAMPING)

    def keep(self, searches: int) -> None:
        """Give up all but the best of each pair."""
        row = np.arange(len(self.z))[:, None]
        best = np.argsort(self._cost, axis=1)[:, :searches]
        self.z, self._came = self.z[row, best], self._came[row, best]
        self._cost, self._damping = self._cost[row, best], self._damping[row, best]

    def refine(self, steps: int) -> None:
        """Improve by at most this many steps, each pair until its searches have ended."""
        rows = np.arange(len(self.z))
        for _ in range(steps):
            rows = rows[self._step(rows)]
            if not len(rows):
                return

    def _step(self, rows: IntArray) -> BoolArray:
        """Take one step for some pairs (R,); whether any search of each goes on."""
        z, came, context = self.z[rows], self._came[rows], self._context[rows, None]
        away = self._action[rows, None] - came
        count, dim = z.shape[1:]
        # Differences are taken inwards, so that z never leaves the range.
        inward = np.where(z > 0, -DIFFERENCE, DIFFERENCE)
        shifted = z[:, :, None] + np.eye(dim) * inward[:, :, None]
        led = self._decode(shifted.reshape(len(rows), count * dim, dim), context)
        slope = (led.reshape(len(rows), count, dim, -1) - came[:, :, None]) / inward[..., None]
        gram = slope @ slope.mT
        damping = self._damping[rows] * np.trace(gram, axis1=-2, axis2=-1) / dim
        step = bounded_least_squares(
            (gram + damping[..., None, None] * np.eye(dim)).reshape(-1, dim, dim),
            np.vecdot(slope, away[:, :, None]).reshape(-1, dim),
            (-1.0 - z).reshape(-1, dim),
            (1.0 - z).reshape(-1, dim),
        ).reshape(z.shape)
        tried = np.clip(z + step, -1.0, 1.0)
        led = self._decode(tried, context)
        cost = _cost(led, self._action[rows, None])
        better = cost < self._cost[rows]
        self.z[rows] = np.where(better[..., None], tried, z)
        self._came[rows] = np.where(better[..., None], led, came)
        self._cost[rows] = np.where(better, cost, self._cost[rows])
        self._damping[rows] *= np.where(better, 0.1, 10.0)
        return (np.abs(step).max(axis=-1) > STOPPED).any(axis=-1)
