"""Loss terms on any input a person could give, not only on demonstrated pairs."""

from abc import ABC, abstractmethod
from collections.abc import Callable
from dataclasses import dataclass
from typing import final

import numpy as np
import torch
from torch import Tensor

from latentarm.core.types import FloatArray
from latentarm.models.scaling import Normaliser


@final
@dataclass(frozen=True, eq=False)
class TermContexts:
    """E contexts during training, and the actions of the S decoders for any input there."""

    state: Tensor  # (S, E, n), rad
    action_of: Callable[[Tensor], Tensor]  # inputs (K, d) in [-1, 1] to actions (S, E, K, m), rad/s
    speed: float  # root mean square of the demonstrated ‖a‖, rad/s
    axes: int  # d


class LossTerm(ABC):
    """A loss to minimise together with ``‖a - phi(z, c)‖^2``. It needs contexts, but no actions there."""

    @abstractmethod
    def contexts(self, demonstrated: FloatArray, joints: int, rng: np.random.Generator) -> FloatArray:
        """Contexts (M, c) that training draws from for this term, from those of the training pairs (N, c).

        The first ``joints`` entries of a context are the state, rad.
        """

    @abstractmethod
    def __call__(self, situation: TermContexts) -> Tensor:
        """The loss (S,)."""


@final
@dataclass(frozen=True, eq=False)
class ScaledTerm:
    """A term, with the normalisers of one training."""

    term: LossTerm
    contexts: Normaliser  # of the first c entries of a network's input
    actions: Normaliser
    joints: int
    speed: float  # root mean square of the demonstrated ‖a‖, rad/s

    def loss(self, decode: Callable[[Tensor, Tensor], Tensor], context: Tensor, span: "Span") -> Tensor:
        """The term (S,) in contexts (S, E, c'), as the networks see them.

        ``decode`` maps latents (S, B, d) in contexts (S, B, c') to normalised actions (S, B, m).
        """

        def constant(values: FloatArray) -> Tensor:
            return torch.as_tensor(values, dtype=context.dtype, device=context.device)

        def action_of(inputs: Tensor) -> Tensor:
            latent = span.centre + span.scale * inputs.to(context)
            (seeds, contexts, width), count = context.shape, len(inputs)
            every = latent[:, None].expand(seeds, contexts, count, -1).reshape(seeds, contexts * count, -1)
            where = context[:, :, None].expand(-1, -1, count, -1).reshape(seeds, contexts * count, width)
            return decode(every, where).unflatten(1, (contexts, count)) * constant(self.actions.scale)

        joints = slice(self.joints)
        state = context[..., joints] * constant(self.contexts.scale[joints])
        state = state + constant(self.contexts.centre[joints])
        return self.term(TermContexts(state, action_of, self.speed, span.centre.shape[-1]))


@final
@dataclass(frozen=True, eq=False)
class Span:
    """The latent actions that inputs stand for: z = centre + scale u."""

    centre: Tensor  # (S, 1, d)
    scale: Tensor  # (S, 1, d)
