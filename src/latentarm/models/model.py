"""The contract of every latent action model."""

from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import ClassVar, Final, Literal, Self, final
from warnings import warn

import numpy as np
import torch
from sklearn.base import BaseEstimator
from sklearn.exceptions import NotFittedError
from torch import Tensor

from latentarm.core.context import JOINTS, feature_names
from latentarm.core.errors import UserError
from latentarm.core.types import BoolArray, Demonstrations, FloatArray, StrPath
from latentarm.demonstrations.contexts import context_layout
from latentarm.demonstrations.pairs import make_pairs
from latentarm.demonstrations.split import split_episodes
from latentarm.models.batches import TrainingData
from latentarm.models.decoder import Decoder
from latentarm.models.goal_entropy import GoalEntropy, ScaledTerm
from latentarm.models.kind import Dimensions, ModelKind, TrainedModel, TrainingSummary
from latentarm.models.networks import Networks
from latentarm.models.parameters import (
    Count,
    Features,
    NotNegative,
    Positive,
    Seed,
    Seeds,
    Share,
    Units,
    check_parameters,
    check_rows,
    check_validation,
)
from latentarm.models.prepared import Preparation, Prepared, prepare
from latentarm.models.saved_chain import chain_tensors
from latentarm.models.saving import write_model
from latentarm.models.scaling import (
    EFFECT_SAMPLES,
    CollapseWarning,
    describe_collapse,
    effect_of_dimensions,
    find_collapsed,
    latent_scale,
    unit_scale,
)
from latentarm.models.torch_decoder import TorchDecoder
from latentarm.models.training import Report, TrainingResult, choose_device
from latentarm.models.way_back.runtime import WayBack
from latentarm.models.way_back.training import with_way_back
from latentarm.robots.catalogue import load_recorded_robot
from latentarm.robots.kinematics.chain import Chain

ROWS_AT_ONCE: Final = 4096
"""Pairs encoded or decoded at a time, so that memory does not grow with the dataset."""

Weights = Mapping[str, FloatArray]


@final
class UnfittedError(UserError, NotFittedError):
    """A model is used before `fit`. Both a `UserError` and scikit-learn's own error."""


@dataclass(kw_only=True, eq=False, repr=False)
class LatentActionModel(BaseEstimator, ABC):
    """A decoder ``phi: (z, c) -> a`` and an encoder ``psi: (c, a) -> z``, learned for S seeds at once.

    A scikit-learn estimator: the constructor stores parameters as they are, `fit` checks them and learns,
    attributes that end in ``_`` exist after it, and `sklearn.base.clone` and ``set_params`` work. z is in
    input units: u in [-1, 1] on each axis spans the demonstrations. Arrays are float64.

    All models take the same parameters, so that they can be compared with one set of them; PCA ignores those
    of the networks and their training.
    """

    kind: ClassVar[ModelKind]  # the kind of model this is
    looks_ahead: ClassVar[bool] = False
    """Whether the loss looks at the context that an action leads to within `AHEAD_S`."""

    latent_dim: Count = 2  # d, size of z
    # The features that the decoder may see, in order, the joints first (`latentarm.core.context`)
    context: Features = (JOINTS,)
    # Where actions come from: ``displacement`` between states, or ``recorded``
    actions: Literal["displacement", "recorded"] = "displacement"
    window: Count = 5  # samples that a displacement may reach ahead and back
    state_noise_rad: NotNegative = 0.0  # standard deviation of the noise on training states, rad
    # Share of the episodes that decide when training stops, if `fit` gets no list
    validation_fraction: Share = 0.2
    data_seed: Seed = 0  # draws the validation episodes and the state noise, the same for every seed
    seeds: Seeds = 1  # S, models trained side by side
    seed: Seed = 0  # the first of S consecutive seeds
    hidden: Units = (32, 32)  # units of each hidden layer, of encoder and decoder
    learning_rate: Positive = 1e-2  # of Adam, at the start
    epochs: Count = 30  # passes over the training pairs, at most
    batch_size: Count = 32  # pairs per step, at most
    patience: Count = 10  # epochs without improvement on the validation episodes after which a seed stops
    # ``cpu``, ``cuda``, or ``auto`` for CUDA where there is one
    device: Literal["cpu", "cuda", "auto"] = "cpu"
    checkpoint_interval_s: NotNegative = 5.0  # shortest time between two checkpoints of a training, s
    # L, the distance from the demonstrations at which a full push is led back at their speed, m; 0 for no way
    # back (`latentarm.models.way_back`)
    way_back_m: NotNegative = 0.0
    trained_: TrainedModel = field(init=False)  # the result of `fit`

    @abstractmethod
    def _learn(
        self,
        data: TrainingData,
        dimensions: Dimensions,
        term: ScaledTerm | None,
        checkpoint: Path | None,
        report: Report | None,
    ) -> TrainingResult:
        """Fit the weights of S seeds to normalised pairs."""

    @abstractmethod
    def _encode(self, weights: Weights, context: FloatArray, action: FloatArray) -> FloatArray:
        """psi: normalised (N, c) and (N, m) to latents as trained (S, N, d); of a distribution, the mean."""

    @abstractmethod
    def _decode(self, weights: Weights, latent: FloatArray, context: FloatArray) -> FloatArray:
        """phi: latents as trained (S, N, d), normalised contexts (N, c) to normalised actions (S, N, m)."""

    @abstractmethod
    def _action(self, networks: Networks, latent: Tensor, context: Tensor) -> Tensor:
        """As `_decode`, in torch: (S, B, d) and (S, B, c) to (S, B, m)."""

    def fit(
        self,
        demonstrations: Demonstrations,
        *,
        validation: Sequence[int] | None = None,
        chain: Chain | None = None,
        term: GoalEntropy | None = None,
        checkpoint: StrPath | None = None,
        report: Report | None = None,
    ) -> Self:
        """Learn from demonstrations, all seeds at once.

        Args:
            demonstrations: at least two episodes.
            validation: indices of the episodes that decide when training stops; neither the weights nor the
                normalisers are fitted to them. Drawn by ``data_seed`` where None.
            chain: the arm's kinematics, for models that look at the tools; where None, those of the
                robot that the demonstrations name.
            term: is minimised together with the model's own loss; for inputs that were not demonstrated.
            checkpoint: file to write the training's state to and, if it exists, to go on from. It
                stays when the training is done; delete it once the model is saved.
            report: called after each epoch, by models that are trained in epochs.

        Returns:
            This model.

        Raises:
            UserError: a parameter is invalid, the demonstrations have too few episodes or lack
                what the parameters ask for, the arm is needed and not known, training diverged, or
                CUDA is asked for and absent.

        Warns:
            CollapseWarning: a latent dimension moves nothing; ``collapsed_`` says which.
            NoWayBackWarning: a way back would not help, so the model has none.
        """
        prepared = self._prepared(demonstrations, validation, chain, term)
        saved = None if checkpoint is None else Path(checkpoint)
        learned = self._learn(prepared.data, self._dimensions(prepared), prepared.term, saved, report)
        self.trained_ = self._led_back(self._trained(prepared, learned), prepared, report)
        if self.collapsed_.any():
            seeds = self.trained_.summary.seeds
            warn(CollapseWarning(describe_collapse(self.kind.name, seeds, self.collapsed_)), stacklevel=2)
        return self

    def encode(self, context: FloatArray, action: FloatArray) -> FloatArray:
        """Latent actions (S, N, d), in input units, of actions (N, m), rad/s, in contexts (N, c).

        Raises UserError where the model is not fitted, or an array has the wrong shape or a NaN.
        """
        trained = self._fitted()
        check_rows("context", context, trained.dimensions.context)
        check_rows("action", action, trained.dimensions.action)
        contexts, actions = _observed(trained, context), trained.actions.apply(action)
        return trained.latents.apply(self._encode_rows(trained.tensors, contexts, actions))

    def decode(self, z: FloatArray, context: FloatArray) -> FloatArray:
        """Actions (S, N, m), rad/s, of latent actions in contexts (N, c).

        z is (S, N, d), or (N, d) for the same in every seed; in input units.

        Raises UserError where the model is not fitted, or an array has the wrong shape or a NaN.
        """
        trained = self._fitted()
        check_rows("context", context, trained.dimensions.context)
        check_rows("z", z, trained.dimensions.latent, seeds=trained.dimensions.seeds, rows=len(context))
        stacked = np.broadcast_to(z, (trained.dimensions.seeds, *z.shape[-2:]))
        latents, contexts = trained.latents.invert(stacked), _observed(trained, context)
        action = trained.actions.invert(self._decode_rows(trained.tensors, latents, contexts))
        if not trained.dimensions.way_back:
            return action
        each = enumerate(zip(action, stacked, strict=True))
        return np.stack([WayBack(trained, seed)(alone, z, context) for seed, (alone, z) in each])

    def decoder(self, seed: int = 0) -> Decoder:
        """One seed's decoder, by its index, for the control loop; UserError if unfitted or without it."""
        return Decoder(self._fitted(), seed)

    def torch_decoder(self, seed: int = 0, dtype: torch.dtype = torch.float32) -> TorchDecoder:
        """The decoder of one seed in torch, differentiable with respect to z and c.

        Raises UserError where the model is not fitted, has no such seed, sees poses in the tool's frame, or
        has a way back.
        """
        return TorchDecoder(self._fitted(), self._action, seed, dtype)

    def save(self, folder: StrPath, *, run: Mapping[str, object] | None = None) -> None:
        """Write ``model.safetensors`` and ``config.json``, with the further keys of ``run`` in the latter.

        Raises UserError where the model is not fitted, or the files cannot be written.
        """
        write_model(Path(folder), self._fitted(), run or {})

    @property
    def seed_numbers(self) -> tuple[int, ...]:
        """The S seeds."""
        return tuple(range(self.seed, self.seed + self.seeds))

    @property
    def learns_encoder(self) -> bool:
        """Whether `encode` is a network; the other models project, or search for the nearest action."""
        return self.kind.learns_encoder

    @property
    def collapsed_(self) -> BoolArray:
        """Latent dimensions that move nothing, (S, d)."""
        return self._fitted().summary.collapsed

    @property
    def validation_episodes_(self) -> tuple[int, ...]:
        """Indices of the episodes that decided when training stopped."""
        return self._fitted().summary.validation_episodes

    @property
    def validation_loss_(self) -> FloatArray:
        """Loss on their pairs (S,), in normalised units."""
        return self._fitted().summary.validation_loss

    @property
    def history_(self) -> FloatArray:
        """Validation loss after each epoch, (E, S)."""
        return self._fitted().summary.history

    def _arm(self, demonstrations: Demonstrations, chain: Chain | None) -> Chain:
        """The given chain, or that of the demonstrations' robot; UserError for other joints or none."""
        if chain is None:
            if not demonstrations.robot:
                raise UserError(
                    f"The {self.kind.name} model with the context {' '.join(feature_names(self.context))}"
                    f"{' and a way back' if self.way_back_m else ''} looks at the arm's tool, and the"
                    " demonstrations do not say which arm they are of: name it when they are imported"
                    " (--robot)."
                )
            chain = load_recorded_robot(demonstrations).chain
        if chain.dof != demonstrations.dof:
            raise UserError(f"The arm has {chain.dof} joints and the demonstrations {demonstrations.dof}.")
        return chain

    def _prepared(
        self,
        demonstrations: Demonstrations,
        validation: Sequence[int] | None,
        chain: Chain | None,
        term: GoalEntropy | None,
    ) -> Prepared:
        """Pairs of demonstrations, ready for training; arguments and errors as in `fit`."""
        check_parameters(type(self), self.get_params(deep=False))
        if validation is None:
            rng = np.random.default_rng([self.data_seed, 0])
            validation = [int(i) for i in split_episodes(demonstrations, self.validation_fraction, rng)[1]]
        check_validation(validation, len(demonstrations.episodes))
        layout = context_layout(demonstrations, self.context)
        needs_arm = self.kind.sees_tools or layout.sees_tool_frame or self.way_back_m > 0
        arm = self._arm(demonstrations, chain) if needs_arm else None
        rng = np.random.default_rng([self.data_seed, 1])
        how = (self.window, self.state_noise_rad, self.context, rng, self.actions)
        pairs = make_pairs(demonstrations, *how, chain=arm)
        asked = Preparation(self.kind.damping_m2, self.looks_ahead, self.data_seed)
        return prepare(asked, pairs, layout, validation, arm, term)

    def _dimensions(self, prepared: Prepared) -> Dimensions:
        """The sizes of this model on these data."""
        if self.latent_dim > prepared.joints:
            raise UserError(
                f"A latent action of {self.latent_dim} dimensions is no smaller than the arm's "
                f"{prepared.joints}: choose at most {prepared.joints}."
            )
        arm = prepared.arm
        return Dimensions(
            self.seeds,
            self.latent_dim,
            prepared.width,
            prepared.joints,
            self.hidden,
            tools=len(arm.tools) if arm else 0,
            coupled=arm.links if arm and arm.coupling else 0,
        )

    def _led_back(self, trained: TrainedModel, prepared: Prepared, report: Report | None) -> TrainedModel:
        """The trained model with the way back that was asked for."""
        if not self.way_back_m or prepared.arm is None:
            return trained
        device = choose_device(self.device)
        return with_way_back(
            trained, prepared.pairs, prepared.arm, self.way_back_m, self.data_seed, device, report
        )

    def _trained(self, prepared: Prepared, learned: TrainingResult) -> TrainedModel:
        """The trained model: its weights, its normalisers, and the map from z to the input."""
        weights, data = learned.weights, prepared.data
        latents = self._encode_rows(weights, data.context, data.action)
        centre = np.zeros_like(latents[:, 0]) if self.kind.rests_at_zero else latents.mean(axis=1)
        # A model that searches for z searches within the input's range.
        in_input_units = self.kind.encoder == "nearest"
        scale = unit_scale(latents) if in_input_units else latent_scale(latents, centre)
        many = len(data.context)
        rows = np.linspace(0, many - 1, min(EFFECT_SAMPLES, many)).astype(np.int64)
        effect = effect_of_dimensions(
            lambda u: self._decode(weights, scale.invert(u), data.context[rows]),
            scale.apply(latents[:, rows]),
            np.sqrt(np.square(data.action).sum(axis=1).mean()),
        )
        return TrainedModel(
            kind=self.kind,
            parameters=self.get_params(deep=False),
            dimensions=self._dimensions(prepared),
            layout=prepared.layout,
            tensors={
                **weights,
                **({} if prepared.arm is None else chain_tensors(prepared.arm)),
                **prepared.contexts.tensors(),
                "action.scale": prepared.actions.scale,
                "latent.centre": scale.centre[:, 0],
                "latent.scale": scale.scale[:, 0],
            },
            summary=TrainingSummary(
                seeds=self.seed_numbers,
                validation_episodes=prepared.validation,
                validation_loss=learned.validation_loss,
                best_epoch=learned.best_epoch,
                history=learned.history,
                collapsed=find_collapsed(effect, latents, gaussian=self.kind.encoder == "gaussian"),
            ),
        )

    def _encode_rows(self, weights: Weights, context: FloatArray, action: FloatArray) -> FloatArray:
        return _in_rows(lambda rows: self._encode(weights, context[rows], action[rows]), len(context))

    def _decode_rows(self, weights: Weights, latent: FloatArray, context: FloatArray) -> FloatArray:
        return _in_rows(lambda rows: self._decode(weights, latent[:, rows], context[rows]), len(context))

    def _fitted(self) -> TrainedModel:
        if not hasattr(self, "trained_"):
            raise UnfittedError(
                f"This {self.kind.name} model is not fitted yet: call fit first, or load a saved one."
            )
        return self.trained_


def _observed(trained: TrainedModel, context: FloatArray) -> FloatArray:
    """The networks' inputs for contexts (N, c)."""
    frame = trained.frame
    return trained.contexts.apply(context if frame is None else frame.apply(context))


def _in_rows(compute: Callable[[slice], FloatArray], rows: int) -> FloatArray:
    """Apply to a bounded number of rows at a time and join along the second axis."""
    parts = [compute(slice(start, start + ROWS_AT_ONCE)) for start in range(0, max(rows, 1), ROWS_AT_ONCE)]
    return np.concatenate(parts, axis=1)
