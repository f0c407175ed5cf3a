"""The isometric model without its training: sizes and the decoder ``g(r) R(c, r) z / r`` in NumPy."""

from typing import Final, final

import numpy as np

from latentarm.core.types import FloatArray
from latentarm.models.enclosure import ROUNDING, Enclosure
from latentarm.models.kind import Dimensions, ModelKind, Runtime, Shape, TrainedModel
from latentarm.models.numpy_networks import NORM_FLOOR, halve_hidden, layers_of, network_output
from latentarm.models.tool_contexts import PLACE, TWIST

DAMPING_M2: Final = 1e-2
BEND_SIZE: Final = 0.3  # factor of the network's bend, so that it starts small
CELLS: Final = 8  # cells that the length of an input is cut into for the enclosure


@final
class _Runtime(Runtime):
    """g(r) R(c, r) z / r of the isometric model."""

    def __init__(self, trained: TrainedModel, seed: int) -> None:
        self._contexts = trained.tool_contexts
        self._twist = halve_hidden(layers_of(trained, seed, "decoder"))
        self._posture = halve_hidden(layers_of(trained, seed, "posture"))
        ((weight, bias),) = layers_of(trained, seed, "gain")
        self._saturation = float(np.logaddexp(0.0, weight[0, 0] + bias[0]))
        self._speed = float(trained.actions.scale[0] / np.tanh(self._saturation))
        self._latents = trained.dimensions.latent
        self._scale = trained.actions.scale

    def __call__(self, z: FloatArray, context: FloatArray) -> FloatArray:
        straight, bend, bend_twist = self._geometry(context)
        radius = np.sqrt(np.vecdot(z, z))[..., None]
        direction = z / np.maximum(radius, NORM_FLOOR)
        turn = 2 * np.minimum(radius, 1.0) - 1
        aside = np.matvec(bend, direction)
        twist = np.matvec(bend_twist, direction)
        aside_size = np.vecdot(twist, twist) + self._contexts.damping * np.vecdot(aside, aside)
        led = np.matvec(straight, direction) + turn * aside
        speed = self._speed * np.tanh(self._saturation * radius)
        return speed * led / np.sqrt(1 + turn**2 * aside_size[..., None])

    def enclose(self, context: FloatArray, fineness: int = 1) -> Enclosure:
        """See `Runtime`; exact for d = 1 but for the cells, at most sqrt(d) too large for more axes.

        With a direction x of length 1 and ``t = 2 min(r, 1) - 1`` the action is ``g(r) / q`` times
        ``Σ_i x_i (M_i + t N_i)``. In a cell of half width w, t is ``t_c + δ w``, so the coefficients ``x_i``
        and ``x_i δ`` are in [-1, 1]; g(r) is at most that of the cell's end, and ``q² = 1 + t² ‖N x‖_G²`` at
        least 1 plus the cell's least t² times the smallest eigenvalue of ``N^T G N``.
        """
        straight, bend, bend_twist = self._geometry(context)
        count = fineness * CELLS
        middle = (2.0 * np.arange(count) + 1.0) / count - 1.0
        longest = 0.5 * (middle + 1.0 / count + 1.0)
        longest[-1] = np.sqrt(self._latents)
        metric = bend_twist.mT @ bend_twist + self._contexts.damping * (bend.mT @ bend)
        least = np.maximum(np.linalg.eigvalsh(metric)[..., :1], 0.0) * (1.0 - ROUNDING)
        slowed = np.sqrt(1.0 + np.square(np.maximum(np.abs(middle) - 1.0 / count, 0.0)) * least)
        speed = (self._speed * np.tanh(self._saturation * longest) / slowed)[..., None, None]
        along, aside = straight.mT[..., None, :, :], bend.mT[..., None, :, :]
        led = along + middle[:, None, None] * aside
        spread = speed * np.concatenate([led, np.broadcast_to(aside / count, led.shape)], axis=-2)
        nothing = np.zeros((*spread.shape[:-2], spread.shape[-1]))
        return Enclosure(nothing, spread, nothing)

    def _geometry(self, context: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        """M (..., m, d), N (..., m, d) and the tools' weighted twists (..., 6 k, d) along N."""
        sizes, damping, d = self._contexts.sizes, self._contexts.damping, self._latents
        observed, lead = self._contexts.apply(context), context.shape[:-1]
        seen = observed[..., : sizes.seen]
        jacobian = observed[..., sizes.jacobian].reshape(*lead, sizes.twists, sizes.joints)
        lift = observed[..., sizes.lift].reshape(*lead, sizes.joints, sizes.twists)
        twist = network_output(seen, self._twist).reshape(*lead, 2 * d, sizes.twists)
        posture = network_output(seen, self._posture).reshape(*lead, 2 * d, sizes.joints)
        columns = lift @ twist.mT + posture.mT
        straight, straight_twist = columns[..., :d], jacobian @ columns[..., :d]

        def inner(first: int, second: int) -> FloatArray:
            """``a^T G b`` of two of the first columns, (..., 1)."""
            joints = np.vecdot(straight[..., first], straight[..., second])
            twists = np.vecdot(straight_twist[..., first], straight_twist[..., second])
            return (twists + damping * joints)[..., None]

        for axis in range(d):
            for other in range(axis):
                along = inner(axis, other)
                straight[..., axis] -= along * straight[..., other]
                straight_twist[..., axis] -= along * straight_twist[..., other]
            size = np.sqrt(inner(axis, axis) + NORM_FLOOR)
            straight[..., axis] /= size
            straight_twist[..., axis] /= size
        bend = BEND_SIZE * columns[..., d:]
        bend_twist = jacobian @ bend
        along = straight_twist.mT @ bend_twist + damping * (straight.mT @ bend)
        return straight, bend - straight @ along, bend_twist - straight_twist @ along


def _sizes(dimensions: Dimensions) -> dict[str, Shape]:
    d, m, tools, hidden = dimensions.latent, dimensions.action, dimensions.tools, dimensions.hidden
    seen = dimensions.context + PLACE * tools
    return {
        "decoder": (seen, *hidden, 2 * d * TWIST * tools),
        "posture": (seen, *hidden, 2 * d * m),
        "gain": (1, 1),
    }


ISOMETRIC: Final = ModelKind(
    name="isometric",
    label="isometric",
    estimator="latentarm.models.isometric.training:Isometric",
    runtime=_Runtime,
    decoder=_sizes,
    encoder="nearest",
    rests_at_zero=True,
    reverses=True,
    damping_m2=DAMPING_M2,
    advice="The isometric rests and goes back; where its motions turn too fast for the stick, try the"
    " plainer --model scl.",
)
