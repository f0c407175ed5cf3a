"""What training may minimise beside a model's own loss: terms about what the decoder can do."""

from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping
from typing import NamedTuple

import numpy as np
from torch import Tensor

from latentarm.types import FloatArray

Decode = Callable[[Tensor, Tensor], Tensor]
"""Latents (S, B, d) and contexts (S, B, c') as the networks see them to normalised actions (S, B, m)."""


class Units(NamedTuple):
    """What the numbers that networks see are worth.

    Attributes:
        context_centre: (c,), what the first c entries of a context are counted from, rad (beliefs: 1).
        context_scale: (c,), what one of them is worth, rad (beliefs: 1).
        action_scale: (m,) or (1,), what an action is worth, rad/s.
        speed: root mean square of the demonstrated ‖a‖, rad/s.
        joints: n; the first n entries of a context are the state.
    """

    context_centre: FloatArray
    context_scale: FloatArray
    action_scale: FloatArray
    speed: float
    joints: int


class LossTerm(ABC):
    """Something to be minimised beside ``‖a - phi(z, c)‖^2``, over the whole range of the input."""

    @property
    @abstractmethod
    def settings(self) -> Mapping[str, object]:
        """What the term depends on, by name, for files."""

    @abstractmethod
    def contexts(self, demonstrated: FloatArray, joints: int, rng: np.random.Generator) -> FloatArray: ...

    @abstractmethod
    def __call__(self, decode: Decode, context: Tensor, centre: Tensor, scale: Tensor, units: Units) -> Tensor:
        """The term of S seeds, (S,).

        Args:
            decode: the decoder in training.
            context: (S, B, c'), contexts of a batch as the networks see them.
            centre: (S, 1, d), the latent action that the person's zero input will stand for.
            scale: (S, 1, d), what inputs of one will add to it.
            units: what the numbers are worth.
        """


class MeasuredTerm(NamedTuple):
    """A term and what the numbers of one training are worth to it."""

    term: LossTerm
    units: Units
