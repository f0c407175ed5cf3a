"""The part of `latentarm bench` that compares training with a plain loop in torch.

Times are of the processor, of all threads together: what a training costs, whatever else the machine does.
"""

import statistics
import time
from itertools import pairwise
from typing import Final, NamedTuple, final

import numpy as np
import torch
from torch import Tensor, nn
from torch.utils.data import DataLoader, Dataset

from latentarm.core.types import Demonstrations, FloatArray, Row
from latentarm.demonstrations.pairs import make_pairs
from latentarm.models.autoencoders.training import CAE
from latentarm.models.scaling import action_normaliser, context_normaliser

HIDDEN: Final = (30, 30)
BATCH: Final = 400
LEARNING_RATE: Final = 0.01
"""Network, batch and rate of the public script for this method (github.com/dylan-losey/latent-actions)."""


class _Data(NamedTuple):
    """Normalised pairs: (N, c + m) to train on, and (H, c + m) of the validation episodes."""

    training: FloatArray
    validation: FloatArray


@final
class _PairList(Dataset[Tensor]):
    """Pairs as lists of numbers, each made a tensor when it is asked for, as public scripts do."""

    def __init__(self, pairs: FloatArray) -> None:
        self._pairs: list[list[float]] = pairs.tolist()

    def __len__(self) -> int:
        return len(self._pairs)

    def __getitem__(self, index: int) -> Tensor:
        return torch.tensor(self._pairs[index], dtype=torch.float32)


@final
class _PlainCAE(nn.Module):
    """The cAE as public scripts write it."""

    def __init__(self, context: int, action: int, latent: int) -> None:
        super().__init__()
        self._context = context
        self.encoder = _sequential(context + action, *HIDDEN, latent)
        self.decoder = _sequential(latent + context, *HIDDEN, action)

    def forward(self, pairs: Tensor) -> Tensor:
        """``‖a - phi(psi(c, a), c)‖^2``, mean over pairs (B, c + m)."""
        context, action = pairs[:, : self._context], pairs[:, self._context :]
        decoded = self.decoder(torch.cat([self.encoder(pairs), context], dim=1))
        return (decoded - action).square().sum(1).mean()


def _sequential(*widths: int) -> nn.Sequential:
    layers: list[nn.Module] = []
    for inputs, outputs in pairwise(widths):
        layers += [nn.Linear(inputs, outputs), nn.SiLU()]
    return nn.Sequential(*layers[:-1])


def time_training(demonstrations: Demonstrations, seeds: int, epochs: int, repeats: int) -> list[Row]:
    """Ten seeds in one fit compared with a run of the plain loop each: same pairs, network, batch and epochs.

    The two take turns, and the median of each counts. A run of the plain loop is timed without any
    validation; the fit with its own after every epoch, and with all that comes before and after its loop.
    Times are per seed; each way is also timed to a loss that every run of the plain loop reaches.
    """
    data = _normalised_pairs(demonstrations)
    plain_s: list[float] = []
    fit_s: list[float] = []
    plain_curves: list[list[tuple[float, float]]] = []
    fit_curve: list[tuple[float, float]] = []
    for repeat in range(repeats):
        curve = _plain_run(data, demonstrations.dof, repeat, epochs)
        plain_curves.append(curve)
        plain_s.append(curve[-1][0])
        began = time.process_time()
        fit_curve = _fit(demonstrations, seeds, epochs)
        fit_s.append(time.process_time() - began)
    plain, fit = statistics.median(plain_s), statistics.median(fit_s)
    setting = f"cAE, {HIDDEN[0]}-{HIDDEN[1]}, batch {BATCH}, {len(data.training)} pairs, {epochs} epochs"
    # What every run of the plain loop reaches: how long until each way gets there.
    goal = max(min(loss for _, loss in curve) for curve in plain_curves)
    plain_to_goal = statistics.median(_reached(curve, goal) or curve[-1][0] for curve in plain_curves)
    rows = {
        "plain_run_s": ("s", plain),
        f"fit_of_{seeds}_seeds_s": ("s", fit),
        "plain_run_over_fit_per_seed": ("1", seeds * plain / fit),
        "loss_of_the_plain_runs": ("1", goal),
        "plain_run_to_that_loss_s": ("s", plain_to_goal),
        f"fit_of_{seeds}_seeds_to_that_loss_s": ("s", _reached(fit_curve, goal)),
    }
    return [
        Row("bench", name, unit, value, None, repeats, condition=setting)
        for name, (unit, value) in rows.items()
    ]


def _normalised_pairs(demonstrations: Demonstrations) -> _Data:
    """The pairs as a fit of `CAE` makes them."""
    rng = np.random.default_rng([CAE.data_seed, 1])
    pairs = make_pairs(demonstrations, CAE.window, CAE.state_noise_rad, "state", rng)
    outside = np.isin(pairs.episode, _validation(demonstrations))
    contexts, actions = context_normaliser(pairs.context[~outside]), action_normaliser(pairs.action[~outside])
    both = np.concatenate([contexts.apply(pairs.context), actions.apply(pairs.action)], axis=1)
    return _Data(both[~outside], both[outside])


def _validation(demonstrations: Demonstrations) -> list[int]:
    """The last fifth of the episodes, at least one."""
    count = len(demonstrations.episodes)
    return list(range(min(count - 1, round(0.8 * count)), count))


def _plain_run(data: _Data, joints: int, seed: int, epochs: int) -> list[tuple[float, float]]:
    """One seed in the plain loop. Returns seconds of training and validation loss after each epoch."""
    with torch.random.fork_rng():
        torch.manual_seed(seed)
        model = _PlainCAE(data.training.shape[1] - joints, joints, CAE.latent_dim)
        pairs = DataLoader(_PairList(data.training), batch_size=BATCH, shuffle=True)
        optimiser = torch.optim.Adam(model.parameters(), lr=LEARNING_RATE)
        judged = torch.tensor(data.validation, dtype=torch.float32)
        curve: list[tuple[float, float]] = []
        took = 0.0
        for _ in range(epochs):
            began = time.process_time()
            for batch in pairs:
                optimiser.zero_grad()
                loss = model(batch)
                loss.backward()
                optimiser.step()
            took += time.process_time() - began
            with torch.no_grad():
                curve.append((took, float(model(judged))))
    return curve


def _fit(demonstrations: Demonstrations, seeds: int, epochs: int) -> list[tuple[float, float]]:
    """S seeds in one fit. Returns seconds and the median of the seeds' best losses after each epoch."""
    clock: list[float] = []
    began = time.process_time()

    def report(_epoch: int, _epochs: int, _loss: float) -> None:
        clock.append(time.process_time() - began)

    model = CAE(
        seeds=seeds,
        hidden=HIDDEN,
        batch_size=BATCH,
        learning_rate=LEARNING_RATE,
        epochs=epochs,
        patience=epochs,
    )
    model.fit(demonstrations, validation=_validation(demonstrations), report=report)
    best = np.median(np.minimum.accumulate(model.history_, axis=0), axis=1)
    return list(zip(clock[1:], best.tolist(), strict=True))


def _reached(curve: list[tuple[float, float]], goal: float) -> float | None:
    """When the loss was first no more than the goal, s; None if never."""
    return next((seconds for seconds, loss in curve if loss <= goal), None)
