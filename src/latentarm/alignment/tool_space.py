"""The alignment z = f(u, c) that makes the tools follow a person's meaning, by inverting the decoder."""

from dataclasses import dataclass
from typing import Final, final

import numpy as np

from latentarm.alignment.demonstrated_directions import DemonstratedDirections
from latentarm.alignment.meaning import Meaning
from latentarm.alignment.poses import pose_vectors_at
from latentarm.alignment.twists import tool_jacobian
from latentarm.core.errors import UserError
from latentarm.core.types import FloatArray
from latentarm.models.decoder import Decoder
from latentarm.robots.kinematics.chain import Chain

OUTSIDE: Final = 1.0  # weight of motion that was not demonstrated in a place, as a share of a full push
RIDGES: Final = (1.0, 0.3, 0.1, 0.03, 0.01, 0.01, 0.01)
"""Weight of ‖z‖^2 in each step. It falls, so that of several z that do the same, one near rest is found."""

SECANTS: Final = ((0.05,) * len(RIDGES), (0.4, 0.4, 0.3, 0.2, 0.1, 0.1, 0.05))
"""(paths, steps), half the distance in z over which the decoder's derivative is taken. The first path follows
the decoder from rest. Where it is folded there, that leads away from the meaning; the second path sees the
decoder more broadly at first."""

ACROSS: Final = (0.1, 0.15)
"""By how much the second path has to miss less than the first before its z counts, and counts alone, in
squared full pushes. In between z is a mixture, so that it changes continuously with the place."""

REACH: Final = 0.5  # the farthest that one step goes in z


@final
@dataclass(frozen=True, eq=False)
class ToolSpace:
    """A person's meaning, without the decoder and the arm that it is used with."""

    meaning: Meaning
    surroundings: DemonstratedDirections  # of the demonstrations that the person was asked about
    duration_s: float  # of the motions that they were asked about, s

    def with_arm(self, decoder: Decoder, chain: Chain) -> "ToolSpaceAlignment":
        """The person's alignment; UserError for another arm or another number of inputs than when asked."""
        inputs, twist = self.meaning.matrix.shape
        if twist != 6 * len(chain.tools) or inputs != decoder.latent_dim or chain.dof != decoder.action_dim:
            raise UserError(
                f"The profile is for {inputs} inputs and {twist // 6} tools, and the model has"
                f" {decoder.latent_dim} inputs and the arm {len(chain.tools)} tools: align the person again."
            )
        return ToolSpaceAlignment(self, decoder, chain)


@final
class ToolSpaceAlignment:
    """``z = argmin ‖Q(c) J phi(z, c) - u‖^2 + ‖N(c) J phi(z, c)‖^2 + r ‖z‖^2``.

    The first term is the person's meaning (`Meaning`), the second keeps to the demonstrated directions in the
    place (`DemonstratedDirections`, N in full pushes), and J is the Jacobian of the tools half way through a
    motion as long as those that were asked about. The minimum is sought on two paths of a fixed number of
    damped Gauss-Newton steps from z = 0, so the time is bounded, nothing is remembered between calls, and z
    is bounded.
    """

    def __init__(self, known: ToolSpace, decoder: Decoder, chain: Chain) -> None:
        self._meaning, self._surroundings = known.meaning, known.surroundings
        self._duration_s = known.duration_s
        self._decoder, self._chain = decoder, chain
        axes = decoder.latent_dim
        sides = np.concatenate([np.zeros((1, axes)), np.eye(axes), -np.eye(axes)])
        self._secants = np.array(SECANTS).T[:, :, None, None]
        self._around = self._secants * sides
        self._penalty = OUTSIDE / known.surroundings.fast_m_s

    def __call__(self, u: FloatArray, context: FloatArray) -> FloatArray:
        """Latent actions (..., d) of inputs (..., d) in contexts (..., c), whose leading axes broadcast."""
        state = context[..., : self._chain.dof]
        transforms = self._chain.link_transforms(state)
        place = pose_vectors_at(self._chain, transforms)
        q, outside = self._meaning(place), self._penalty * self._surroundings(place)
        # From here on there is an axis for the paths, before those of vectors and matrices.
        u, context = u[..., None, :], context[..., None, :]
        q, outside = q[..., None, :, :], outside[..., None, :, :]
        jacobian = tool_jacobian(self._chain, transforms)[..., None, :, :]
        metric, wanted = self._pulled_back(q, outside, jacobian, u)
        z = np.zeros((*np.broadcast_shapes(u.shape[:-2], state.shape[:-1]), len(SECANTS), u.shape[-1]))
        miss = np.zeros(z.shape[:-1])
        for step, ridge in enumerate(RIDGES):
            action, slope = self._linear(z, context, step)
            if step == len(RIDGES) - 2:
                middle = self._chain.link_transforms(
                    context[..., : self._chain.dof] + 0.5 * self._duration_s * action
                )
                metric, wanted = self._pulled_back(q, outside, tool_jacobian(self._chain, middle), u)
            done = (metric @ action[..., None])[..., 0]
            if step == len(RIDGES) - 1:
                miss = np.vecdot(action, done - 2 * wanted)
            z = z + _limited(_gauss_newton(metric, wanted - done, slope, ridge, z))
        second = np.clip((miss[..., 0] - miss[..., 1] - ACROSS[0]) / (ACROSS[1] - ACROSS[0]), 0.0, 1.0)[
            ..., None
        ]
        return z[..., 0, :] + second * (z[..., 1, :] - z[..., 0, :])

    def _linear(self, z: FloatArray, context: FloatArray, step: int) -> tuple[FloatArray, FloatArray]:
        """The decoded action (..., n), and its derivative (..., n, d) by central differences."""
        axes = z.shape[-1]
        decoded = self._decoder.decode(z[..., None, :] + self._around[step], context[..., None, :])
        ahead, behind = decoded[..., 1 : axes + 1, :], decoded[..., axes + 1 :, :]
        return decoded[..., 0, :], ((ahead - behind) / (2 * self._secants[step])).mT

    @staticmethod
    def _pulled_back(
        q: FloatArray, outside: FloatArray, jacobian: FloatArray, u: FloatArray
    ) -> tuple[FloatArray, FloatArray]:
        """The metric (..., n, n) of joint velocities, and its product (..., n) with the wanted one."""
        meant, stray = q @ jacobian, outside @ jacobian
        return meant.mT @ meant + stray.mT @ stray, (u[..., None, :] @ meant)[..., 0, :]


def _gauss_newton(
    metric: FloatArray, missing: FloatArray, slope: FloatArray, ridge: float, z: FloatArray
) -> FloatArray:
    """One step (..., d)."""
    gradient = (missing[..., None, :] @ slope)[..., 0, :] - ridge * z
    curvature = slope.mT @ (metric @ slope)
    if z.shape[-1] != 2:
        damped = curvature + ridge * np.eye(z.shape[-1])
        return np.asarray(np.linalg.solve(damped, gradient[..., None])[..., 0], dtype=np.float64)
    # By hand for a stick: NumPy's solver costs more than all the rest of a step.
    first, second = curvature[..., 0, 0] + ridge, curvature[..., 1, 1] + ridge
    mixed = curvature[..., 0, 1]
    one, other = gradient[..., 0], gradient[..., 1]
    step = np.empty_like(gradient)
    step[..., 0], step[..., 1] = second * one - mixed * other, first * other - mixed * one
    return step / (first * second - mixed * mixed)[..., None]


def _limited(step: FloatArray) -> FloatArray:
    """A step shortened smoothly to `REACH` at most."""
    return step / np.sqrt(1.0 + np.vecdot(step, step)[..., None] / REACH**2)
