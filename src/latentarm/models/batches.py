"""Batches for the training loop, shuffled for each seed separately."""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, fields
from typing import Final, NamedTuple, final

import numpy as np
import torch
from torch import Tensor

from latentarm.core.types import FloatArray

ELSEWHERE: Final = 32  # most contexts without demonstrated actions in a step, for terms that ask for them
ELSEWHERE_JUDGED: Final = 256  # the same for validation, which always uses the first ones
JUDGED_AT_ONCE: Final = 400
"""Validation pairs per seed that are judged together, so that they fit into the processor's cache."""

FEWEST_STEPS: Final = 16  # steps of an epoch, at least: a small dataset is cut into smaller batches


class Batch(NamedTuple):
    """One training step's data."""

    context: Tensor  # (S, B, c), normalised
    action: Tensor  # (S, B, m), normalised
    noise: Tensor  # (S, B, k), standard normal for training, zero for judging; k = 0 without need
    elsewhere: Tensor  # (S, E, c), contexts without demonstrated actions, for terms that need none
    later: Tensor  # (S, B, c), where the actions lead, for models that look there; otherwise (S, B, 0)


@dataclass(frozen=True)
class TrainingData:
    """Normalised pairs, the same for every seed; or with a leading axis (S, ...), each seed's own."""

    context: FloatArray  # (N, c)
    action: FloatArray  # (N, m)
    validation_context: FloatArray  # (H, c)
    validation_action: FloatArray  # (H, m)
    elsewhere: FloatArray  # (M, c), contexts without demonstrated actions; none unless a term asks
    later: FloatArray  # (N, c), where the actions lead, for models that look there; otherwise (N, 0)
    validation_later: FloatArray  # (H, c) or (H, 0)

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
    """Shuffled training batches, which `epoch` fills ``batch`` with, and validation pairs, on the device."""

    def __init__(
        self, data: TrainingData, seeds: Sequence[int], batch_size: int, noise_dim: int, device: torch.device
    ) -> None:
        def tensor(values: FloatArray) -> Tensor:
            return torch.from_numpy(values).float().to(device)

        self._seeds, self._device = tuple(seeds), device
        self._own, self._pairs, self._places = data.own, data.context.shape[-2], data.elsewhere.shape[-2]
        self._rows = min(ELSEWHERE, self._places)
        self.size = max(1, min(batch_size, self._pairs // FEWEST_STEPS))
        self.steps = self._pairs // self.size
        by_pair = tensor(data.context), tensor(data.action), tensor(data.later)
        self._by_pair, self._elsewhere = [_rows(table) for table in by_pair], _rows(tensor(data.elsewhere))

        def room(rows: int, width: int) -> Tensor:
            return torch.zeros(len(seeds), rows, width, device=device)

        context, action, later = (room(self.size, table.shape[-1]) for table in self._by_pair)
        elsewhere = room(self._rows, self._elsewhere.shape[-1])
        self.batch = Batch(context, action, room(self.size, noise_dim), elsewhere, later)
        self.validation = list(self._parts(data, noise_dim, tensor))

    def _parts(
        self, data: TrainingData, noise_dim: int, tensor: Callable[[FloatArray], Tensor]
    ) -> Iterator[Batch]:
        """All validation pairs, for every seed; in one part where a term looks at them all together."""
        pairs = data.validation_context.shape[-2]
        at_once = pairs if self._places else JUDGED_AT_ONCE

        def every_seed(values: FloatArray) -> Tensor:
            return tensor(values).expand(len(self._seeds), -1, -1).contiguous()

        for first in range(0, pairs, at_once):
            rows = slice(first, first + at_once)
            context = every_seed(data.validation_context[..., rows, :])
            yield Batch(
                context=context,
                action=every_seed(data.validation_action[..., rows, :]),
                noise=context.new_zeros(*context.shape[:2], noise_dim),
                elsewhere=every_seed(data.elsewhere[..., :ELSEWHERE_JUDGED, :]),
                later=every_seed(data.validation_later[..., rows, :]),
            )

    def epoch(self, epoch: int) -> Iterator[Batch]:
        """Fill `batch` anew and again; pairs that do not fill a last one wait for the next shuffle."""
        many, size, steps, noise_dim = len(self._seeds), self.size, self.steps, self.batch.noise.shape[-1]
        order = torch.empty(steps, many, size, dtype=torch.int64)
        noise = torch.empty(steps, many, size, noise_dim)
        places = torch.empty(steps, many, self._rows, dtype=torch.int64)
        for at, seed in enumerate(self._seeds):
            generator = seed_generator(seed, epoch)
            order[:, at] = torch.randperm(self._pairs, generator=generator)[: steps * size].view(steps, size)
            noise[:, at] = torch.randn(steps, size, noise_dim, generator=generator)
            if self._rows:
                places[:, at] = torch.randint(self._places, (steps, self._rows), generator=generator)
        if self._own:
            # Each seed's rows follow those of the seed before it.
            seed = torch.arange(many)[:, None]
            order, places = order + seed * self._pairs, places + seed * self._places
        order = order.to(self._device).view(steps, many * size)
        noise, places = noise.to(self._device), places.to(self._device).view(steps, many * self._rows)
        current = (self.batch.context, self.batch.action, self.batch.later)
        filled = [
            (table, into.flatten(0, 1))
            for table, into in zip(self._by_pair, current, strict=True)
            if into.numel()
        ]
        elsewhere = self.batch.elsewhere.flatten(0, 1)
        for chosen, drawn, place in zip(order, noise, places, strict=True):
            for table, into in filled:
                torch.index_select(table, 0, chosen, out=into)
            if noise_dim:
                self.batch.noise.copy_(drawn)
            if self._rows:
                torch.index_select(self._elsewhere, 0, place, out=elsewhere)
            yield self.batch
