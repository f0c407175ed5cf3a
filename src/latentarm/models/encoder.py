"""A trained encoder of one seed in NumPy, so that a person can be aligned without torch."""

from typing import final

import numpy as np

from latentarm.core.errors import UserError
from latentarm.core.types import FloatArray
from latentarm.models.kind import SearchingRuntime, TrainedModel
from latentarm.models.numpy_networks import halve_hidden, layers_of, network_output


@final
class Encoder:
    """One seed's encoder ``u = psi(c, a)``, as `LatentActionModel.encode` gives it: NumPy alone."""

    def __init__(self, trained: TrainedModel, seed: int = 0) -> None:
        """Take one seed's encoder, by its index, out of a trained model; UserError without such a seed."""
        trained.check_seed_index(seed)
        self._trained, self._seed = trained, seed
        self._runtime = trained.kind.runtime(trained, seed)

    def encode(self, context: FloatArray, action: FloatArray) -> FloatArray:
        """Inputs (N, d) of actions (N, m), rad/s, in contexts (N, c); the mean where psi is a distribution.

        Raises UserError where the kind of model has no encoder in NumPy.
        """
        trained, d = self._trained, self._trained.dimensions.latent
        framed = context if trained.frame is None else trained.frame.apply(context)
        if trained.kind.learns_encoder:
            layers = halve_hidden(layers_of(trained, self._seed, "encoder"))
            seen = np.concatenate([trained.contexts.apply(framed), trained.actions.apply(action)], axis=-1)
            return trained.latents.apply(network_output(seen, layers)[:, :d])[self._seed]
        if isinstance(self._runtime, SearchingRuntime):
            return self._runtime.nearest(action, framed)
        if trained.kind.encoder != "projection":
            raise UserError(
                f"A {trained.kind.name} model is not encoded in NumPy: its runtime cannot search."
            )
        rest = self._runtime(np.zeros(d), framed)
        columns = self._runtime(np.eye(d)[:, None], framed) - rest
        return np.matvec(np.linalg.pinv(np.moveaxis(columns, 0, -1)), action - rest)
