"""Learning a person's meaning from answers: a Gaussian process on Q in ``u = Q(c) dx``.

The prior: Q_0 is anything, but in each place where the demonstrations move in d directions, the axes of
the stick are probably at right angles and equally fast, and a full push is about the fastest motion. A stick
of two axes may turn with the place, ``Q = R(theta) Q_0``, theta a Gaussian process. The noise of an answer is
multiplicative: its SD is a share of the meant input (the coefficient of variation). An answer at the edge of
the stick may have been meant to be larger.

The posterior is found by Gauss-Newton steps and Laplace's approximation (MacKay 2003, chapter 27), for all
`Setting`s of the hyper-parameters at once; their marginal likelihoods weigh them.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import product
from typing import Final, final

import numpy as np
from scipy.special import log_ndtr

from latentarm.alignment.answers import Answers, Motions
from latentarm.alignment.demonstrated_directions import DemonstratedDirections
from latentarm.alignment.meaning import Meaning, rotations
from latentarm.alignment.poses import pose_vectors
from latentarm.alignment.twists import motion_twists
from latentarm.core.types import BoolArray, FloatArray
from latentarm.robots.kinematics.chain import Chain

RESOLUTION: Final = 0.02  # SD of an answer of zero: a stick is held no more finely
LOOSE: Final = 10.0  # SD of an entry of Q_0, in full pushes per fastest motion
GAIN: Final = 0.5  # SD of the logarithm of a full push's speed, relative to the fastest demonstrated motions
STEPS: Final = 25  # Gauss-Newton steps
MIRRORED: Final = 4  # directions, at most, that a second start is mirrored in
LARGEST_STEP_RAD: Final = 0.5  # largest turn of the stick in one step
VARIATIONS: Final = (0.0, 0.1, 0.3, 0.5)
"""Coefficients of variation of answers that are considered, equally probable."""

UNEVEN: Final = 0.1
"""SD of the axes' deviation from right angles and from equal speeds; precise answers outweigh it."""


@final
@dataclass(frozen=True)
class Setting:
    """Hyper-parameters."""

    turn_rad: float  # SD of the stick's turn from place to place, rad; 0 for a stick that does not turn
    length_m: float  # distance over which the turn changes, m
    variation: float
    weight: float


def settings(axes: int) -> tuple[Setting, ...]:
    """The settings for a stick of some axes, each with its weight; only one of two axes turns."""
    turns = [(0.0, 1.0, 1.0)]
    if axes == 2:
        lengths = (0.2, 0.4, 0.8, 1.6)
        turns += [(turn, length, 1.0 / (2 * len(lengths))) for turn, length in product((0.4, 1.2), lengths)]
    return tuple(
        Setting(turn, length, variation, weight)
        for (turn, length, weight), variation in product(turns, VARIATIONS)
    )


@final
@dataclass(frozen=True, eq=False)
class Posterior:
    """A person's meaning, learned from the answers."""

    meaning: Meaning  # the most probable one, under the most probable setting
    setting: Setting
    share: float
    """Unknown: RMS of the input's SD for motions that might be asked about, over RMS of the input."""


def fit_meaning(
    answers: Answers, chain: Chain, surroundings: DemonstratedDirections, motions: Motions
) -> Posterior:
    """Learn a person's meaning; its uncertainty is judged on the motions that might be asked about."""
    every = settings(answers.u.shape[1])
    fits = _Fits(answers, chain, surroundings, every, *_starts(answers, chain, surroundings, every))
    fits.run()
    evidence, factor = fits.evidence()
    weight = np.exp(evidence - evidence.max())
    best = int(weight.argmax())
    mean, variance = fits.predict(
        pose_vectors(chain, motions.start), motion_twists(chain, motions) / surroundings.fast_m_s, factor
    )
    weight /= weight.sum()
    average = np.einsum("h,hnd->nd", weight, mean)
    spread = np.einsum("h,hnd->nd", weight, variance + np.square(mean - average))
    share = float(np.sqrt(spread.mean() / max(np.square(average).mean(), RESOLUTION**2)))
    return Posterior(fits.meaning(best), fits.settings[best], share)


def _starts(
    answers: Answers, chain: Chain, surroundings: DemonstratedDirections, every: Sequence[Setting]
) -> list[FloatArray]:
    """The first fit by least squares, shrunk a little, and one with a direction of it mirrored.

    Noise may mirror the meaning of one direction, and no small steps lead back from there. So each of the
    main directions of the answered motions is mirrored, and the most probable result is kept.
    """
    twist = motion_twists(chain, answers.motions) / surroundings.fast_m_s
    normal = twist.T @ twist + 0.01 * np.eye(twist.shape[1])
    first = np.asarray(np.linalg.solve(normal, twist.T @ answers.u).T, dtype=np.float64)
    directions = np.linalg.svd(twist, full_matrices=False)[2][:MIRRORED]
    mirrored = [first - 2 * np.outer(first @ one, one) for one in directions]
    still = [one for one in every if one.turn_rad == 0]
    fits = _Fits(answers, chain, surroundings, still, *mirrored)
    fits.run()
    evidence, _ = fits.evidence()
    return [first, mirrored[int(evidence.argmax()) // len(still)]]


class _Fits:
    """The same answers under settings from starts, all H pairs; twists are in units of the fastest motion."""

    def __init__(
        self,
        answers: Answers,
        chain: Chain,
        surroundings: DemonstratedDirections,
        settings: Sequence[Setting],
        *starts: FloatArray,
    ) -> None:
        self.settings = settings = tuple(settings) * len(starts)
        self._fast = surroundings.fast_m_s
        self._place = pose_vectors(chain, answers.motions.start)
        self._twist = motion_twists(chain, answers.motions) / self._fast
        self._u = answers.u
        self._axes = answers.u.shape[1]
        self._planes = surroundings.planes(self._axes)
        self._turn, self._length, self._variation, weight = np.array(
            [[one.turn_rad, one.length_m, one.variation, one.weight] for one in settings]
        ).T
        self._log_weight = np.log(weight)
        many = len(self._u)
        kernel = self._kernel(self._place) + 1e-8 * np.eye(many)
        self._factor = np.linalg.cholesky(kernel)
        self._root = self._turn[:, None, None] * self._factor
        self._q = np.repeat(np.stack(starts), len(settings) // len(starts), axis=0)
        self._w = np.zeros((len(settings), many))

    def run(self) -> None:
        """Step to the most probable parameters."""
        size = self._q[0].size
        for step in range(STEPS):
            hessian, gradient = self._normal()
            move = np.linalg.solve(hessian, gradient[..., None])[..., 0]
            turned = np.abs((self._root @ move[:, size:, None])[..., 0]).max(axis=1)
            move *= np.minimum(1.0, LARGEST_STEP_RAD / np.maximum(turned, 1e-12))[:, None]
            move *= 1.0 if step < STEPS // 2 else 0.7
            self._q += move[:, :size].reshape(self._q.shape)
            self._w += move[:, size:]

    def evidence(self) -> tuple[FloatArray, FloatArray]:
        """Log marginal likelihoods (H,), up to a constant, and the posterior covariances (H, P, P)."""
        hessian, _ = self._normal()
        mean, sd, edge = self._predicted()
        beyond = log_ndtr(-(1.0 - np.sign(self._u) * mean) / sd)
        off = (self._u - mean) / sd
        log_likelihood = np.where(edge, beyond, -0.5 * off**2 - np.log(sd)).sum(axis=(1, 2))
        _, residual, weight = self._priors()
        log_prior = -0.5 * (weight * residual**2).sum(axis=1)
        log_prior -= 0.5 * np.square(self._w).sum(axis=1)
        log_prior -= 0.5 * np.square(self._q / LOOSE).sum(axis=(1, 2))
        volume = -0.5 * np.linalg.slogdet(hessian)[1]
        covariance = np.asarray(np.linalg.inv(hessian), dtype=np.float64)
        return log_likelihood + log_prior + volume + self._log_weight, covariance

    def predict(
        self, place: FloatArray, twist: FloatArray, covariance: FloatArray
    ) -> tuple[FloatArray, FloatArray]:
        """Mean and variance (H, M, d) of the inputs for motions, twists (M, 6 k) at places (M, 12 k)."""
        cross = self._kernel(place)
        weights = np.linalg.solve(self._factor.mT, np.linalg.solve(self._factor, cross.mT)).mT
        mean, slope = self._inputs(twist, weights @ self._root)
        unknown = self._turn[:, None] ** 2 * np.maximum(1.0 - (weights * cross).sum(axis=-1), 0.0)
        variance = np.einsum("hmdp,hpq,hmdq->hmd", slope, covariance, slope)
        across = np.square(mean).sum(axis=-1, keepdims=True) - np.square(mean)
        return mean, variance + unknown[..., None] * across

    def meaning(self, setting: int) -> Meaning:
        """The most probable meaning under one setting."""
        turn = self._turn[setting] * np.linalg.solve(self._factor[setting].T, self._w[setting])
        return Meaning(self._q[setting] / self._fast, self._place, turn, float(self._length[setting]))

    def _kernel(self, place: FloatArray) -> FloatArray:
        apart = np.square(place[:, None] - self._place).sum(axis=-1)
        return np.exp(-0.5 * apart / self._length[:, None, None] ** 2)

    def _inputs(self, twist: FloatArray, root: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Inputs (H, M, d) for twists, and their derivative (H, M, d, P); root (H, M, N) from w to theta."""
        settings, motions, axes = len(self._q), len(twist), self._axes
        straight = twist @ self._q.mT
        slope = np.zeros((settings, motions, axes, axes, twist.shape[1]))
        if axes != 2:
            slope[:, :, range(axes), range(axes)] = twist[:, None]
            flat = slope.reshape(settings, motions, axes, -1)
            return straight, np.concatenate([flat, np.zeros((*flat.shape[:3], self._w.shape[1]))], axis=-1)
        turn = rotations((root @ self._w[..., None])[..., 0])
        mean = (turn @ straight[..., None])[..., 0]
        flat = (turn[..., None] * twist[:, None, None]).reshape(settings, motions, axes, -1)
        sideways = np.stack([-mean[..., 1], mean[..., 0]], axis=-1)
        return mean, np.concatenate([flat, sideways[..., None] * root[:, :, None]], axis=-1)

    def _predicted(self) -> tuple[FloatArray, FloatArray, BoolArray]:
        """Mean and SD (H, N, d) of the answers, and which are at the edge of the stick."""
        mean, _ = self._inputs(self._twist, self._root)
        sd = np.sqrt(np.square(self._variation[:, None, None] * mean) + RESOLUTION**2)
        return mean, sd, np.broadcast_to(np.abs(self._u) >= 1.0, mean.shape)

    def _normal(self) -> tuple[FloatArray, FloatArray]:
        """Hessian (H, P, P) and gradient (H, P) of the log posterior's quadratic approximation."""
        _, slope = self._inputs(self._twist, self._root)
        mean, sd, edge = self._predicted()
        side = np.sign(self._u)
        # An answer at the edge says only that at least as much was meant (Tobin 1958).
        short = (1.0 - side * mean) / sd
        hazard = np.exp(-0.5 * short**2 - 0.5 * np.log(2 * np.pi) - log_ndtr(-short))
        curved = np.maximum(hazard * (hazard - short), 1e-3)
        weight = np.where(edge, curved, 1.0) / sd**2
        pull = np.where(edge, side * hazard / sd, (self._u - mean) / sd**2)
        count = slope.shape[-1]
        rows = slope.reshape(len(slope), -1, count)
        hessian = rows.mT @ (weight.reshape(len(slope), -1, 1) * rows)
        gradient = (rows.mT @ pull.reshape(len(slope), -1, 1))[..., 0]
        flat = self._q.reshape(len(slope), -1)
        size = flat.shape[1]
        own = np.concatenate([np.full(size, LOOSE**-2), np.ones(count - size)])
        gradient -= own * np.concatenate([flat, self._w], axis=1)
        hessian = hessian + np.diag(own)
        prior_slope, residual, prior_weight = self._priors()
        weighted = prior_slope * prior_weight[..., None]
        hessian[:, :size, :size] += weighted.mT @ prior_slope
        gradient[:, :size] -= (weighted.mT @ residual[..., None])[..., 0]
        return hessian, gradient

    def _priors(self) -> tuple[FloatArray, FloatArray, FloatArray]:
        """The priors' derivatives (H, C, D), residuals (H, C) and weights (H, C)."""
        planes = self._planes
        regions, axes = len(planes), self._axes
        gains = np.einsum("hij,kjl->hkil", self._q, planes)
        squares = np.square(gains).sum(axis=-1)
        size = np.maximum(squares.mean(axis=-1), 1e-6)
        each = 2 * np.einsum("hkil,kjl->hkij", gains, planes)  # of squares
        derivatives, residuals, weights = [], [], []

        def add(residual: FloatArray, derivative: FloatArray, sd: float) -> None:
            residuals.append(residual)
            derivatives.append(derivative.reshape(*residual.shape, -1))
            weights.append(np.full(residual.shape, sd**-2 / regions))

        of_size = each / axes
        add(0.5 * np.log(size), 0.5 * of_size / size[..., None, None], GAIN)
        if axes == 2:
            scale = size[..., None, None]
            product = (gains[..., 0, :] * gains[..., 1, :]).sum(axis=-1)
            crossed = 0.5 * each[..., ::-1, :]
            add(product / size, (crossed - (product / size)[..., None, None] * of_size) / scale, UNEVEN)
            uneven = 0.5 * (squares[..., 0] - squares[..., 1])
            differs = 0.5 * each * np.array([1.0, -1.0])[:, None]
            add(uneven / size, (differs - (uneven / size)[..., None, None] * of_size) / scale, UNEVEN)
        return (
            np.concatenate(derivatives, axis=1),
            np.concatenate(residuals, axis=1),
            np.concatenate(weights, axis=1),
        )
