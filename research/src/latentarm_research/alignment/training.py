"""Learning alignments: S runs in one batched loop, each independent of the others."""

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Final, final

import numpy as np
import torch

from latentarm.alignment.answers import Answers
from latentarm.alignment.runtime import LearnedAlignment, layer_shapes
from latentarm.core.errors import UserError
from latentarm.core.types import FloatArray
from latentarm.models.batches import seed_generator
from latentarm.models.model import LatentActionModel
from latentarm.models.networks import FlatNetworks
from latentarm.models.optimiser import FlatAdam, falling_rate
from latentarm.models.training import threads_for
from latentarm.robots.kinematics.chain import Chain
from latentarm_research.alignment.loss import ANSWERS_AT_ONCE, AlignmentLoss, Draw
from latentarm_research.alignment.priors import NO_PRIORS, Priors

CHECK_EVERY: Final = 250  # steps between two looks at the answers that are held out


@final
@dataclass(frozen=True)
class FitConfig:
    """Settings for learning an alignment."""

    priors: Priors = field(default_factory=Priors)  # what counts beside the answers
    hidden: tuple[int, ...] = (64, 64)  # units of each hidden layer of f
    steps: int = 400  # of Adam
    learning_rate: float = 5e-3  # at the start; it falls along half a cosine
    batch_size: int = 64  # contexts without an answer that each step sees
    # share of the answers, the last ones, that train nothing: the weights that miss them least are kept. 0
    # keeps the last weights
    held_out: float = 0.0


def fit_alignments(
    model: LatentActionModel,
    chain: Chain,
    answers: Sequence[Answers],  # those of each of S runs, equally many of motions that take equally long
    unlabelled: FloatArray,  # (M, c), contexts in which the priors apply
    config: FitConfig | None = None,  # how; the defaults where None
    *,
    seeds: Sequence[int] | None = None,  # S, of the weights and draws of each run; 0..S-1 where None
) -> tuple[LearnedAlignment, ...]:
    """Learn an alignment for each of S runs, all together, for the first of the model's seeds."""
    config = config or FitConfig()
    seeds = range(len(answers)) if seeds is None else seeds
    decoder = model.torch_decoder(0)
    trained, held_out = _divided(answers, config.held_out)
    loss = AlignmentLoss(decoder, chain, trained, unlabelled, config.priors)
    kept = _Kept(AlignmentLoss(decoder, chain, held_out, unlabelled, NO_PRIORS)) if held_out else None
    shapes = layer_shapes(decoder.latent_dim, decoder.context_dim, config.hidden)
    networks = FlatNetworks(
        {name: (len(seeds), *shape) for name, shape in shapes.items()}, torch.device("cpu")
    )
    networks.initialise([seed_generator(seed, 0) for seed in seeds], {})
    adam = FlatAdam(networks.values)
    draws = loss.draws(seeds, config.steps, config.batch_size)
    rows = 3 * config.batch_size + min(len(trained[0]), ANSWERS_AT_ONCE)
    with threads_for(len(seeds) * rows * max(config.hidden, default=1)):
        for step in range(config.steps):
            draw = Draw(*(part[step] for part in draws))
            networks.fill_gradient(loss(networks.networks, draw).sum())
            rate = falling_rate(config.learning_rate, step, config.steps)
            adam.step(networks.values, networks.gradient, rate)
            if kept is not None and ((step + 1) % CHECK_EVERY == 0 or step + 1 == config.steps):
                kept.look(networks)
    if kept is not None:
        kept.restore(networks)
    weights = networks.arrays(networks.values)
    if not all(np.isfinite(array).all() for array in weights.values()):
        raise UserError(f"The alignment diverged: lower its learning rate ({config.learning_rate:g}).")
    normaliser = decoder.contexts.tensors()
    return tuple(
        LearnedAlignment({**{name: array[run] for name, array in weights.items()}, **normaliser})
        for run in range(len(seeds))
    )


def _divided(answers: Sequence[Answers], held_out: float) -> tuple[list[Answers], list[Answers]]:
    """The answers that train, and those that do not, where there are any."""
    last = [round(held_out * len(one)) for one in answers]
    if not any(last):
        return list(answers), []
    parts = [
        (one[np.arange(len(one) - many)], one[np.arange(len(one) - many, len(one))])
        for one, many in zip(answers, last, strict=True)
    ]
    return [first for first, _ in parts], [second for _, second in parts]


class _Kept:
    """The weights of each run that have missed the held-out answers least."""

    def __init__(self, loss: AlignmentLoss) -> None:
        self._loss = loss
        self._best: torch.Tensor | None = None
        self._least = torch.tensor(torch.inf)

    def look(self, networks: FlatNetworks) -> None:
        """Compare what there is now."""
        with torch.no_grad():
            missed = self._loss.missed(networks.networks)
        if self._best is None:
            self._best, self._least = networks.values.clone(), missed
            return
        better = missed < self._least
        self._least = torch.where(better, missed, self._least)
        self._best[better] = networks.values[better]

    def restore(self, networks: FlatNetworks) -> None:
        """Put the best weights back."""
        if self._best is not None:
            networks.values.copy_(self._best)
