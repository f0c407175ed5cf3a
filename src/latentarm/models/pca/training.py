"""Principal component analysis of the actions: the linear, context-free baseline of the paper."""

from dataclasses import dataclass
from pathlib import Path
from typing import ClassVar, final

import numpy as np
from sklearn import decomposition
from torch import Tensor

from latentarm.core.errors import UserError
from latentarm.core.types import FloatArray
from latentarm.models.batches import TrainingData
from latentarm.models.goal_entropy import ScaledTerm
from latentarm.models.kind import Dimensions, ModelKind
from latentarm.models.model import LatentActionModel, Weights
from latentarm.models.networks import Networks, mlp
from latentarm.models.pca import runtime
from latentarm.models.training import Report, TrainingResult


@final
@dataclass(kw_only=True, eq=False, repr=False)
class PCA(LatentActionModel):
    """PCA: minimises equation 6 among linear maps that see no context.

    As in scikit-learn, the actions' mean is subtracted first, so that z = 0 decodes to that mean. Nothing in
    it is random: all seeds are equal.
    """

    kind: ClassVar[ModelKind] = runtime.PCA

    def _learn(
        self,
        data: TrainingData,
        dimensions: Dimensions,
        term: ScaledTerm | None,
        checkpoint: Path | None,
        report: Report | None,
    ) -> TrainingResult:
        if term is not None:
            raise UserError("PCA is solved in closed form, so no term can be added: choose another model.")
        if len(data.action) < dimensions.latent:
            raise UserError(
                f"{len(data.action)} context-action pairs do not span {dimensions.latent} latent dimensions:"
                " demonstrate more, or widen the window."
            )
        components = decomposition.PCA(n_components=dimensions.latent, svd_solver="full").fit(data.action)
        validation = data.validation_action
        rebuilt = components.inverse_transform(components.transform(validation))
        loss = np.square(validation - rebuilt).sum(axis=1).mean()
        principal, seeds = np.asarray(components.components_), dimensions.seeds
        return TrainingResult(
            weights={
                "decoder.0.weight": np.repeat(principal[None], seeds, axis=0),
                "decoder.0.bias": np.repeat(data.action.mean(axis=0)[None, None], seeds, axis=0),
            },
            validation_loss=np.full(seeds, loss),
            best_epoch=np.zeros(seeds, dtype=np.int64),
            history=np.empty((0, seeds)),
        )

    def _encode(self, weights: Weights, context: FloatArray, action: FloatArray) -> FloatArray:
        return (action - weights["decoder.0.bias"]) @ weights["decoder.0.weight"].transpose(0, 2, 1)

    def _decode(self, weights: Weights, latent: FloatArray, context: FloatArray) -> FloatArray:
        return latent @ weights["decoder.0.weight"] + weights["decoder.0.bias"]

    def _action(self, networks: Networks, latent: Tensor, context: Tensor) -> Tensor:
        return mlp(networks["decoder"], latent)
