"""What an alignment is trained to minimise: the answers and the priors (equation 23), for S runs at once."""

from collections.abc import Sequence
from typing import Final, NamedTuple, final

import numpy as np
import torch
from torch import Tensor

from latentarm.alignment.answers import Answers
from latentarm.alignment.runtime import NETWORK
from latentarm.core.errors import UserError
from latentarm.core.types import FloatArray
from latentarm.models.batches import seed_generator
from latentarm.models.networks import Networks, mlp
from latentarm.models.torch_decoder import TorchDecoder
from latentarm.robots.kinematics.chain import Chain
from latentarm_research.alignment.priors import (
    NO_PRIORS,
    Priors,
    consistent,
    proportional,
    reversible,
    supervised,
)
from latentarm_research.alignment.transition import Place, Push, Transition, joined, parted

ANSWERS_AT_ONCE: Final = 128  # maximum number of answers in one step; from more, each step draws this many

DRAWS: Final = 1
"""The stream of a run's random numbers that its draws come from; its weights come from stream 0."""


class Draw(NamedTuple):
    """Random draws of one step, or of all steps with a leading axis."""

    answers: Tensor  # (S, N'), rows of the answers
    here: Tensor  # (S, B), rows of the unlabelled contexts
    there: Tensor  # (S, B), others
    u: Tensor  # (S, B, d), inputs, uniform in [-1, 1]
    alpha: Tensor  # (S, B, 1), uniform in [-1, 1]


@final
class AlignmentLoss:
    """``L_align = L_sup + lambda_1 L_prop + lambda_2 L_reverse + lambda_3 L_con`` of S alignments.

    Everything is relative to the mean squared length of the motions that a run was asked about, so that the
    weights have no units and 1 is the loss of an arm that does not move.
    """

    def __init__(
        self,
        decoder: TorchDecoder,  # phi, frozen
        chain: Chain,
        answers: Sequence[Answers],  # those of each of S runs, equally many of motions that take equally long
        unlabelled: FloatArray,  # (M, c), contexts in which the priors apply
        priors: Priors,
    ) -> None:
        def tensor(values: Sequence[FloatArray]) -> Tensor:
            return torch.as_tensor(np.stack(values), dtype=decoder.dtype)

        self._transition = Transition(decoder, chain, answers[0].motions.duration_s)
        self._contexts, self._joints = decoder.context_dim, decoder.action_dim
        self._priors = priors
        self._start = self._transition.place(tensor([one.motions.context for one in answers]))
        ends = [np.concatenate([one.motions.end, one.motions.rest], axis=1) for one in answers]
        self._wanted = self._transition.pose(tensor(ends))
        self._u = tensor([one.u for one in answers])
        self._unlabelled = self._transition.place(tensor([unlabelled]))
        self._scale = (self._wanted - self._start.pose).square().sum(-1).mean(-1)
        if not (self._scale > 0).all():
            raise UserError("None of the motions that were answered moves a tool: ask about others.")

    def draws(self, seeds: Sequence[int], steps: int, batch_size: int) -> Draw:
        """All random numbers of a training, (steps, S, ...): of each run from its own seed."""
        (_, many, axes), places = self._u.shape, self._unlabelled.context.shape[1]
        each: list[Draw] = []
        for seed in seeds:
            generator = seed_generator(seed, DRAWS)
            rows = torch.arange(many).expand(steps, many)
            if many > ANSWERS_AT_ONCE:
                rows = torch.randint(many, (steps, ANSWERS_AT_ONCE), generator=generator)
            here, there = torch.randint(places, (2, steps, batch_size), generator=generator)
            values = torch.rand(steps, batch_size, axes + 1, generator=generator) * 2 - 1
            each.append(Draw(rows, here, there, values[..., :axes], values[..., axes:]))
        return Draw(*(torch.stack(parts, dim=1) for parts in zip(*each, strict=True)))

    def __call__(self, networks: Networks, draw: Draw) -> Tensor:
        """The loss of each run on one step's draws, (S,)."""
        u, alpha = draw.u.to(self._u), draw.alpha.to(self._u)
        labelled, given = _at(self._start, draw.answers), _rows(self._u, draw.answers)
        wanted = _rows(self._wanted, draw.answers)
        if self._priors == NO_PRIORS:
            return supervised(self._push(networks, labelled, given), wanted) / self._scale
        here, there = _at(self._unlabelled, draw.here), _at(self._unlabelled, draw.there)
        # One batched push for all known places: many small ones cost more than one large one.
        places, inputs = [labelled, here, here, there], [given, u, alpha * u, u]
        together = self._push(networks, joined(places), torch.cat(inputs, dim=1))
        answered, push, part, elsewhere = parted(together, [given.shape[1], *[u.shape[1]] * 3])
        back = self._push(networks, self._transition.after(push), -u)
        priors = self._priors
        loss = (
            supervised(answered, wanted)
            + priors.proportional * proportional(push, part, alpha)
            + priors.reversible * reversible(push, back)
            + priors.consistent * consistent(push, elsewhere, priors.gamma, self._joints)
        )
        return loss / self._scale

    def missed(self, networks: Networks) -> Tensor:
        """The supervised part (equation 19) of each run on all of its answers, (S,)."""
        return supervised(self._push(networks, self._start, self._u), self._wanted) / self._scale

    def _push(self, networks: Networks, place: Place, u: Tensor) -> Push:
        """T(s, u) with f as the networks have it."""
        seen = place.observed[..., : self._contexts]
        return self._transition.push(place, mlp(networks[NETWORK], torch.cat([u, seen], dim=-1)))


def _at(place: Place, rows: Tensor) -> Place:
    """The places (S, K) at rows (S, K), of places (S, N) or of (1, N) that all runs share."""
    return Place(*(_rows(part, rows) for part in place))


def _rows(values: Tensor, rows: Tensor) -> Tensor:
    """Rows (S, K) of values (S, N, k), or of (1, N, k) that all runs share: (S, K, k)."""
    if len(values) == 1:
        return values[0][rows]
    runs = torch.arange(len(rows), device=rows.device)[:, None]
    return values[runs, rows]
