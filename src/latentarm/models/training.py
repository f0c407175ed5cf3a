"""The training loop: S seeds of any model in one batched fit."""

import math
from collections.abc import Callable, Generator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import asdict, dataclass, fields
from pathlib import Path
from time import monotonic
from typing import Final

import numpy as np
import torch
from rich.progress import TextColumn, TimeRemainingColumn
from torch import Tensor

from latentarm.core.errors import UserError
from latentarm.core.parallel import counting_bar
from latentarm.core.types import FloatArray, IntArray
from latentarm.models.batches import Batch, Batches, TrainingData, seed_generator
from latentarm.models.checkpoint import TrainingState, fingerprint, read_checkpoint, write_checkpoint
from latentarm.models.kind import Shape
from latentarm.models.networks import FlatNetworks, Networks
from latentarm.models.optimiser import FlatAdam, falling_rate
from latentarm.models.replay import RecordedStep, UnreplayableError

Report = Callable[[int, int, float], None]
"""Called after each epoch with the epochs done, the most there will be, and the validation loss so far."""

THREADED_WORK: Final = 40_000  # hidden units per layer and step above which a second thread pays off
REPLAYED_STEPS: Final = 100  # steps from which recording one and replaying it pays off


@dataclass(frozen=True)
class TrainingConfig:
    """Length and speed of a training."""

    learning_rate: float  # Adam's, at the start; it falls along half a cosine
    epochs: int  # passes over the training pairs, at most
    batch_size: int  # pairs per step and seed, at most
    patience: int  # a seed stalls after so many epochs without improvement of its validation loss
    checkpoint_interval_s: float  # shortest time between two checkpoints, s


@dataclass(frozen=True)
class TrainingResult:
    """The best weights of every seed."""

    weights: dict[str, FloatArray]  # float64 arrays (S, in, out) by name
    validation_loss: FloatArray  # (S,), the loss that those weights have on the validation pairs
    best_epoch: IntArray  # (S,), counted from 1
    history: FloatArray  # (E, S), validation loss after each epoch

    def of_seed(self, index: int) -> "TrainingResult":
        """The result of one of the S seeds, by its index."""
        one = slice(index, index + 1)
        return TrainingResult(
            weights={name: values[one] for name, values in self.weights.items()},
            validation_loss=self.validation_loss[one],
            best_epoch=self.best_epoch[one],
            history=self.history[:, one],
        )


def train(
    objective: Callable[[Networks, Batch], Tensor],
    shapes: dict[str, Shape],
    noise_dim: int,
    data: TrainingData,
    seeds: Sequence[int],
    config: TrainingConfig,
    *,
    device: torch.device,
    start: Mapping[str, FloatArray] | None = None,
    checkpoint: Path | None = None,
    identity: str = "",
    report: Report | None = None,
) -> TrainingResult:
    """Train S seeds together, with the same result as training each alone.

    Per seed, the weights with the least validation loss are kept. A seed that has stalled is left as
    it is; the loop ends when all have, or after the last epoch.

    The objective gives a loss (S,) for the networks on a batch, of N training or H validation pairs, with
    ``noise_dim`` standard normal numbers per pair. ``shapes`` (S, in, out) are those of the weights by name,
    and ``start`` has values that some begin with instead of being drawn. ``checkpoint`` is a file to go on
    from, if it exists, and to write to; one of another ``identity`` is refused. ``report`` is also called
    before the first epoch, with an infinite loss.

    Raises UserError where a seed diverged, or the checkpoint is not this training's.
    """
    networks = FlatNetworks(shapes, device)
    adam = FlatAdam(networks.values)
    state = TrainingState.start(networks.values, adam)
    settings = asdict(config) | {"identity": identity, "seeds": list(seeds), "shapes": shapes}
    settings["offsets"] = networks.offsets
    del settings["checkpoint_interval_s"]
    print_of = fingerprint(settings, [getattr(data, field.name) for field in fields(data)])
    if checkpoint is not None and checkpoint.exists():
        read_checkpoint(checkpoint, print_of, state)
        adam.steps = state.steps
    else:
        networks.initialise([seed_generator(seed, 0) for seed in seeds], start or {})
    batches = Batches(data, seeds, config.batch_size, noise_dim, device)
    written = monotonic()
    report = report or (lambda epoch, epochs, loss: None)
    report(state.epoch, config.epochs, math.inf)
    with threads_for(len(seeds) * batches.size * max(shape[-1] for shape in shapes.values())):
        fill_gradient = _gradient(objective, networks, batches, device, state, config)
        while state.epoch < config.epochs and not state.stalled(config.patience).all():
            rate = falling_rate(config.learning_rate, state.epoch, config.epochs)
            for _ in batches.epoch(state.epoch + 1):
                fill_gradient()
                adam.step(networks.values, networks.gradient, rate)
            state.record(validation_loss(objective, networks, batches), adam.steps, config.patience)
            report(state.epoch, config.epochs, float(state.best_loss.mean()))
            if checkpoint is not None and monotonic() - written >= config.checkpoint_interval_s:
                write_checkpoint(checkpoint, print_of, state)
                written = monotonic()
    if checkpoint is not None:
        write_checkpoint(checkpoint, print_of, state)
    diverged = [seed for seed, loss in zip(seeds, state.best_loss, strict=True) if not math.isfinite(loss)]
    if diverged:
        raise UserError(
            f"Training diverged for seed {', '.join(map(str, diverged))}: the loss is not a number; "
            f"lower the learning rate ({config.learning_rate:g})."
        )
    return TrainingResult(
        weights=networks.arrays(state.best),
        validation_loss=state.best_loss.copy(),
        best_epoch=state.best_epoch.copy(),
        history=np.array(state.history),
    )


def _gradient(
    objective: Callable[[Networks, Batch], Tensor],
    networks: FlatNetworks,
    batches: Batches,
    device: torch.device,
    state: TrainingState,
    config: TrainingConfig,
) -> Callable[[], None]:
    """Fills in the current batch's gradient: a `RecordedStep`, if it pays off and proves to be right."""

    def compute() -> None:
        networks.fill_gradient(objective(networks.networks, batches.batch).sum())

    upcoming = batches.epoch(state.epoch + 1)
    if (config.epochs - state.epoch) * batches.steps < REPLAYED_STEPS or next(upcoming, None) is None:
        return compute
    try:
        replay = RecordedStep(compute, [*batches.batch, networks.values], device)
    except UnreplayableError:
        return compute
    # On other pairs, so that an objective that depends on more than its arguments is noticed.
    next(upcoming, None)
    compute()
    expected = networks.gradient.clone()
    networks.gradient.zero_()
    replay()
    return replay if torch.equal(networks.gradient, expected) else compute


@torch.no_grad()
def validation_loss(
    objective: Callable[[Networks, Batch], Tensor], networks: FlatNetworks, batches: Batches
) -> FloatArray:
    """Mean over all validation pairs, (S,)."""
    total, pairs = torch.zeros(len(networks.values), dtype=torch.float64), 0
    for part in batches.validation:
        count = part.context.shape[1]
        total += count * objective(networks.networks, part).double().cpu()
        pairs += count
    return (total / pairs).numpy()


@contextmanager
def threads_for(work: int) -> Generator[None]:
    """Use one thread for small steps, where a second costs more than it saves."""
    before = torch.get_num_threads()
    torch.set_num_threads(before if work >= THREADED_WORK else 1)
    try:
        yield
    finally:
        torch.set_num_threads(before)


def choose_device(name: str) -> torch.device:
    """The torch device for ``cpu``, ``cuda`` or ``auto``; UserError where CUDA is asked for and absent."""
    present = torch.cuda.is_available()
    if name == "cuda" and not present:
        raise UserError("The device is cuda, but torch finds no CUDA on this machine: use cpu, or auto.")
    return torch.device("cuda" if present and name in ("cuda", "auto") else "cpu")


@contextmanager
def epoch_bar(shown: bool) -> Generator[Report]:
    """A `Report` that shows a bar on standard error, if ``shown``."""
    last = TextColumn("epochs"), TextColumn("{task.fields[loss]}"), TimeRemainingColumn()
    with counting_bar(shown, *last) as bar:
        task = bar.add_task("training", loss="")

        def report(epoch: int, epochs: int, loss: float) -> None:
            said = f"validation loss {loss:.4f}" if math.isfinite(loss) else ""
            bar.update(task, total=epochs, completed=epoch, loss=said)

        yield report
