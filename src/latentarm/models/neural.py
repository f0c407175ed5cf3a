"""Base of the models trained by gradient: from NumPy to torch and back."""

import json
from abc import ABC, abstractmethod
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import ClassVar, Self, final

import numpy as np
import torch
from torch import Tensor

from latentarm.core.errors import UserError
from latentarm.core.types import Demonstrations, FloatArray
from latentarm.models.batches import Batch, TrainingData
from latentarm.models.goal_entropy import ScaledTerm, Span
from latentarm.models.kind import Dimensions
from latentarm.models.model import LatentActionModel, Weights
from latentarm.models.networks import Networks, networks_from_arrays
from latentarm.models.prepared import side_by_side
from latentarm.models.scaling import SPAN_QUANTILE
from latentarm.models.training import Report, TrainingConfig, TrainingResult, choose_device, train

Start = Callable[[TrainingData, Dimensions], dict[str, FloatArray]]
"""From the training pairs to initial weights by name."""


@dataclass(kw_only=True, eq=False, repr=False)
class NeuralModel(LatentActionModel, ABC):
    """A latent action model whose encoder and decoder are small networks.

    Training is in float32; encoding and decoding afterwards in float64. A subclass defines its encoder,
    decoder and loss on batches with a leading seed axis and normalised values.
    """

    start: ClassVar[Start | None] = None  # initial values of some weights; the others are drawn at random
    jitters: ClassVar[bool] = False
    """Whether the loss adds noise to contexts: it then takes as many numbers per pair as a context has."""

    @abstractmethod
    def _loss(self, networks: Networks, batch: Batch) -> Tensor:
        """The loss (S,)."""

    @abstractmethod
    def _latent(self, networks: Networks, context: Tensor, action: Tensor) -> Tensor:
        """psi: (S, B, c) and (S, B, m) to (S, B, d); the mean where psi is a distribution."""

    @final
    def fit_each(
        self, demonstrations: Sequence[Demonstrations], *, validation: Sequence[int] | None = None
    ) -> list[Self]:
        """Learn one seed from each of S data sets, all in one training.

        The result is that of fitting each alone, except that data sets that hold more pairs than the smallest
        lose their last ones. Returns S fitted models of one seed each.

        Raises UserError where there are not as many data sets as seeds, and as in `fit`.
        """
        if len(demonstrations) != self.seeds:
            raise UserError(
                f"{len(demonstrations)} data sets for {self.seeds} seeds: give one for each seed."
            )
        models = [replace(self, seeds=1, seed=seed) for seed in self.seed_numbers]
        prepared = [
            model._prepared(shown, validation, None, None)
            for model, shown in zip(models, demonstrations, strict=True)
        ]
        data = side_by_side([one.data for one in prepared])
        learned = self._learn(data, self._dimensions(prepared[0]), None, None, None)
        for index, (model, own) in enumerate(zip(models, prepared, strict=True)):
            model.trained_ = model._led_back(model._trained(own, learned.of_seed(index)), own, None)
        return models

    def _first(self, data: TrainingData, dimensions: Dimensions) -> dict[str, FloatArray] | None:
        """The values of `start`, for each seed on its own pairs where it has its own."""
        if self.start is None or not data.own:
            return self.start(data, dimensions) if self.start else None
        one = replace(dimensions, seeds=1)
        each = [self.start(data.of_seed(index), one) for index in range(dimensions.seeds)]
        shapes = self.kind.weight_shapes(one)
        return {
            name: np.concatenate([np.broadcast_to(start[name], shapes[name]) for start in each])
            for name in each[0]
        }

    @final
    def _learn(
        self,
        data: TrainingData,
        dimensions: Dimensions,
        term: ScaledTerm | None,
        checkpoint: Path | None,
        report: Report | None,
    ) -> TrainingResult:
        apart = ("device", "checkpoint_interval_s")
        identity = {name: value for name, value in self.get_params(deep=False).items() if name not in apart}
        if term is not None:
            identity["term"] = dict(term.term.settings)
        return train(
            self._objective(term),
            self.kind.weight_shapes(dimensions),
            self._noise_dim(dimensions),
            data,
            self.seed_numbers,
            TrainingConfig(
                learning_rate=self.learning_rate,
                epochs=self.epochs,
                batch_size=self.batch_size,
                patience=self.patience,
                checkpoint_interval_s=self.checkpoint_interval_s,
            ),
            device=choose_device(self.device),
            start=self._first(data, dimensions),
            checkpoint=checkpoint,
            identity=json.dumps({"kind": self.kind.name, **identity}, sort_keys=True),
            report=report,
        )

    def _noise_dim(self, dimensions: Dimensions) -> int:
        """Standard normal numbers that the loss takes per pair."""
        if self.jitters:
            return dimensions.context
        return dimensions.latent if self.kind.encoder == "gaussian" else 0

    def _objective(self, term: ScaledTerm | None) -> Callable[[Networks, Batch], Tensor]:
        """The model's own loss, plus the term's if there is one."""
        if term is None:
            return self._loss

        def objective(networks: Networks, batch: Batch) -> Tensor:
            with torch.no_grad():
                span = self._span(self._latent(networks, batch.context, batch.action))
            beside = term.loss(lambda z, c: self._action(networks, z, c), batch.elsewhere, span)
            return self._loss(networks, batch) + beside

        return objective

    def _span(self, latent: Tensor) -> Span:
        """The scaling of inputs that `fit` will choose, estimated from a batch (S, B, d)."""
        centre = latent.mean(dim=1, keepdim=True)
        if self.kind.rests_at_zero:
            centre = torch.zeros_like(centre)
        if self.kind.encoder == "nearest":
            return Span(centre, torch.ones_like(centre))
        return Span(centre, (latent - centre).abs().quantile(SPAN_QUANTILE, dim=1, keepdim=True))

    @final
    def _encode(self, weights: Weights, context: FloatArray, action: FloatArray) -> FloatArray:
        networks = networks_from_arrays(weights)
        with torch.no_grad():
            return self._latent(
                networks, _for_every_seed(networks, context), _for_every_seed(networks, action)
            ).numpy()

    @final
    def _decode(self, weights: Weights, latent: FloatArray, context: FloatArray) -> FloatArray:
        networks = networks_from_arrays(weights)
        with torch.no_grad():
            latents = torch.from_numpy(np.ascontiguousarray(latent))
            return self._action(networks, latents, _for_every_seed(networks, context)).numpy()


def _for_every_seed(networks: Networks, values: FloatArray) -> Tensor:
    """Rows (N, k) as (S, N, k)."""
    seeds = len(networks["decoder"][0][0])
    return torch.from_numpy(np.ascontiguousarray(values)).expand(seeds, -1, -1)
