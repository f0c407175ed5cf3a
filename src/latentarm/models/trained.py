"""What a fit leaves behind: the record that is saved, loaded and run. NumPy alone."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import final

from latentarm.errors import UserError
from latentarm.models.layout import LAYOUTS, Dimensions, Layout
from latentarm.models.normaliser import Normaliser
from latentarm.models.tool_contexts import ToolContexts
from latentarm.types import BoolArray, FloatArray, IntArray


@final
@dataclass(frozen=True)
class TrainingSummary:
    """How a training went.

    Attributes:
        seeds: the S seeds.
        validation_episodes: indices of the episodes that decided when training stopped.
        validation_loss: (S,), loss on their pairs, in normalised units.
        best_epoch: (S,), the epoch whose weights were kept, counted from 1.
        history: (E, S), validation loss after each epoch, NaN where it was not a number; E = 0 where
            there were none.
        collapsed: (S, d), latent dimensions that move nothing.
    """

    seeds: tuple[int, ...]
    validation_episodes: tuple[int, ...]
    validation_loss: FloatArray
    best_epoch: IntArray
    history: FloatArray
    collapsed: BoolArray


@final
@dataclass(frozen=True)
class TrainedModel:
    """A trained model of any kind, as plain arrays.

    Attributes:
        kind: a key of `LAYOUTS`.
        parameters: what the model was constructed with, as JSON has it.
        dimensions: its sizes.
        tensors: float64 arrays by name, as `layout.tensor_shapes` lists them.
        summary: how the training went.
    """

    kind: str
    parameters: Mapping[str, object]
    dimensions: Dimensions
    tensors: Mapping[str, FloatArray]
    summary: TrainingSummary

    @property
    def layout(self) -> Layout:
        """Form of the encoder and the decoder."""
        return LAYOUTS[self.kind]

    @property
    def contexts(self) -> Normaliser | ToolContexts:
        """The map from contexts (..., c) to what the networks see."""
        if self.layout.damping_m2 is not None:
            return self.tool_contexts
        return Normaliser(self.tensors["context.centre"], self.tensors["context.scale"])

    @property
    def tool_contexts(self) -> ToolContexts:
        """`contexts` of a model that looks at the tools.

        Raises:
            UserError: it does not.
        """
        if self.layout.damping_m2 is None:
            raise UserError(f"A {self.kind} model does not look at the arm's tools.")
        return ToolContexts.of_tensors(self.tensors, self.layout.damping_m2)

    @property
    def actions(self) -> Normaliser:
        """Normaliser of actions (..., m)."""
        scale = self.tensors["action.scale"]
        return Normaliser(0.0 * scale, scale)

    @property
    def latents(self) -> Normaliser:
        """From latent actions as trained (S, N, d) to inputs u."""
        return Normaliser(self.tensors["latent.centre"][:, None], self.tensors["latent.scale"][:, None])

    def check_seed_index(self, seed: int) -> None:
        """Refuse a seed's index that this model does not have.

        Raises:
            UserError: ``seed`` is not within 0..S-1.
        """
        if not 0 <= seed < self.dimensions.seeds:
            raise UserError(
                f"This model has no seed index {seed}: it was trained with {self.dimensions.seeds} "
                f"(0 to {self.dimensions.seeds - 1})."
            )
