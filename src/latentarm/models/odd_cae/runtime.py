"""The odd cAE without its training: the decoder ``(f(z, c) - f(-z, c)) / 2`` in NumPy."""

from typing import Final, final

import numpy as np

from latentarm.core.types import FloatArray
from latentarm.models.autoencoders.runtime import conditioned_sizes
from latentarm.models.enclosure import Enclosure, network_enclosure
from latentarm.models.kind import ModelKind, Runtime, TrainedModel
from latentarm.models.numpy_networks import halve_hidden, layers_of, propagate, scale_context, scale_output


@final
class _Runtime(Runtime):
    """(f(z, c) - f(-z, c)) / 2 of the odd cAE."""

    def __init__(self, trained: TrainedModel, seed: int) -> None:
        # The halving of the difference goes into the last layer, whose bias cancels.
        layers = scale_output(layers_of(trained, seed), 0.5 * trained.actions.scale)
        d = trained.dimensions.latent
        weight, bias = layers[0]
        from_context, bias = scale_context((weight[d:], bias), trained)
        from_latent = weight[:d] * trained.latents.scale[seed, 0][:, None]
        (weight, self._bias), *self._rest = halve_hidden(
            [(np.concatenate([from_latent, from_context]), bias), *layers[1:]]
        )
        self._from_latent, self._from_context = weight[:d].copy(), weight[d:].copy()

    def __call__(self, z: FloatArray, context: FloatArray) -> FloatArray:
        push, here = z @ self._from_latent, context @ self._from_context + self._bias
        forth, back = propagate(np.stack([here + push, here - push]), self._rest)
        return forth - back

    def enclose(self, context: FloatArray, fineness: int = 1) -> Enclosure:
        """See `Runtime`; both halves in the same cells of z, so that what they have in common cancels."""
        here = context @ self._from_context + self._bias
        forth, back = (
            network_enclosure(from_latent, here, self._rest, fineness)
            for from_latent in (self._from_latent, -self._from_latent)
        )
        return forth.minus(back)


ODD_CAE: Final = ModelKind(
    name="odd_cae",
    label="odd cAE",
    estimator="latentarm.models.odd_cae.training:OddCAE",
    runtime=_Runtime,
    decoder=conditioned_sizes,
    encoder="deterministic",
    rests_at_zero=True,
    reverses=True,
    advice="The odd_cae rests and goes back, and turns hardly faster than the stick; where its error is too"
    " large, try --model homogeneous.",
)
