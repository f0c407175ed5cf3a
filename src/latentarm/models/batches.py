"""Batches for the training loop, shuffled for each seed separately."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, fields
from typing import Final, NamedTuple, final

import numpy as np
import torch
from torch import Tensor

from latentarm.types import FloatArray

ELSEWHERE: Final = 32
"""Contexts without demonstrated actions that a step sees, at most, for terms that ask for them."""

ELSEWHERE_JUDGED: Final = 256
"""The same for validation, which always uses the first ones."""

FEWEST_STEPS: Final = 16
"""Steps of an epoch, at least: a small dataset is cut into smaller batches."""


class Batch(NamedTuple):
    """One training step's data.

    Attributes:
        context: (S, B, c), normalised.
        action: (S, B, m), normalised.
        noise: (S, B, k), standard normal for training and zero for judging; k = 0 where the encoder
            is deterministic.
        elsewhere: (S, E, c), contexts without demonstrated actions, for terms that need none.
        later: (S, B, c), where the actions lead, for models that look there; otherwise (S, B, 0).
    """

    context: Tensor
    action: Tensor
    noise: Tensor
    elsewhere: Tensor
    later: Tensor


@dataclass(frozen=True)
class TrainingData:
    """Normalised pairs, the same for every seed; or with a leading axis (S, ...), each seed's own.

    Attributes:
        context: (N, c), training pairs.
        action: (N, m).
        validation_context: (H, c), pairs of the validation episodes.
        validation_action: (H, m).
        elsewhere: (M, c), contexts without demonstrated actions; none where no term asks for them.
        later: (N, c), contexts to which the training pairs' actions lead, for models that look there;
            otherwise (N, 0).
        validation_later: (H, c) or (H, 0), the same of the validation pairs.
    """

    context: FloatArray
    action: FloatArray
    validation_context: FloatArray
    validation_action: FloatArray
    elsewhere: FloatArray
    later: FloatArray
    validation_later: FloatArray

    @property
    def own(self) -> bool:
        """Whether each seed has its own pairs."""
        return self.context.ndim == 3

    def of_seed(self, index: int) -> "TrainingData":
        """One seed's pairs, where each has its own."""
        return TrainingData(*(getattr(self, entry.name)[index] for entry in fields(self)))


def _rows(values: Tensor) -> Tensor:
    """Rows (N, k) as they are, and those of S seeds (S, N, k) one seed after the other."""
    return values.flatten(0, -2)


def seed_generator(seed: int, stream: int) -> torch.Generator:
    """A seed's own source of randomness for one purpose: stream 0 for its weights, e for epoch e.

    A new generator per epoch makes every draw a function of (seed, epoch) alone: not of the other seeds, and
    not of whether the training was cut off in between.
    """
    state = np.random.SeedSequence([seed, stream]).generate_state(1, np.uint64)[0]
    return torch.Generator().manual_seed(int(state) >> 1)


@final
class Batches:
    """Shuffled training batches and the validation pairs, on the device.

    Attributes:
        size: B, pairs per step and seed.
        validation: all validation pairs as one batch.
    """

    def __init__(
        self, data: TrainingData, seeds: Sequence[int], batch_size: int, noise_dim: int, device: torch.device
    ) -> None:
        def tensor(values: FloatArray) -> Tensor:
            return torch.from_numpy(values).float().to(device)

        self._seeds, self._noise_dim, self._device = tuple(seeds), noise_dim, device
        self._context, self._action = _rows(tensor(data.context)), _rows(tensor(data.action))
        self._elsewhere, self._later = _rows(tensor(data.elsewhere)), _rows(tensor(data.later))
        self._own, self._pairs, self._places = data.own, data.context.shape[-2], data.elsewhere.shape[-2]
        self._rows = min(ELSEWHERE, self._places)
        self.size = max(1, min(batch_size, self._pairs // FEWEST_STEPS))
        many, validation = len(seeds), data.validation_context.shape[-2]
        self.validation = Batch(
            context=tensor(data.validation_context).expand(many, -1, -1).contiguous(),
            action=tensor(data.validation_action).expand(many, -1, -1).contiguous(),
            noise=torch.zeros(many, validation, noise_dim, device=device),
            elsewhere=tensor(data.elsewhere)[..., :ELSEWHERE_JUDGED, :].expand(many, -1, -1).contiguous(),
            later=tensor(data.validation_later).expand(many, -1, -1).contiguous(),
        )

    def epoch(self, epoch: int) -> Iterator[Batch]:
        """Whole batches of one pass; the pairs that do not fill a last one wait for the next shuffle."""
        many, size = len(self._seeds), self.size
        steps = self._pairs // size
        order = torch.empty(steps, many, size, dtype=torch.int64)
        noise = torch.empty(steps, many, size, self._noise_dim)
        places = torch.empty(steps, many, self._rows, dtype=torch.int64)
        for index, seed in enumerate(self._seeds):
            generator = seed_generator(seed, epoch)
            order[:, index] = torch.randperm(self._pairs, generator=generator)[: steps * size].view(
                steps, size
            )
            noise[:, index] = torch.randn(steps, size, self._noise_dim, generator=generator)
            if self._rows:
                places[:, index] = torch.randint(self._places, (steps, self._rows), generator=generator)
        if self._own:
            # Each seed's rows follow those of the seed before it.
            seed = torch.arange(many)[:, None]
            order, places = order + seed * self._pairs, places + seed * self._places
        order, noise = order.to(self._device).view(steps, many * size), noise.to(self._device)
        width = self._elsewhere.shape[-1]
        places = places.to(self._device).view(steps, many * self._rows)
        for chosen, drawn, place in zip(order, noise, places, strict=True):
            yield Batch(
                context=self._context.index_select(0, chosen).view(many, size, -1),
                action=self._action.index_select(0, chosen).view(many, size, -1),
                noise=drawn,
                elsewhere=self._elsewhere.index_select(0, place).view(many, self._rows, width),
                later=self._later.index_select(0, chosen).view(many, size, self._later.shape[-1]),
            )
