"""Judging the directions learned from answers beside those that the person has."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Final, final

import numpy as np

from latentarm.alignment.answers import Answers, Motions
from latentarm.alignment.contract import Alignment, Refusal
from latentarm.alignment.error import lengths, outcome
from latentarm.alignment.poses import pose_vectors
from latentarm.alignment.queries import FEWEST
from latentarm.core.types import FloatArray
from latentarm.models.decoder import Decoder
from latentarm.robots.kinematics.chain import Chain

LINE: Final = 0.2  # answers lie on one line if they spread across it by this share of their spread along it
BETTER: Final = 0.7
"""Better directions miss at most this share of what others miss. Consistent answers reach half of it or less;
answers by buttons, which have four directions and one size, reach some 0.6."""

WEAK: Final = 0.25  # a push does hardly anything below this share of a shown motion


@final
@dataclass(frozen=True)
class Judgement:
    """Relative alignment errors of a person's answers, and why their new directions are refused."""

    # of each answer, with the directions learned from all others; None if all together cannot teach any
    learned: float | None
    present: float  # with the directions that the person has
    refusal: Refusal | None  # None if the new directions are better


def judge(
    answers: Answers,
    learn: Callable[[Answers], Alignment],
    present: Alignment,
    decoder: Decoder,
    chain: Chain,
    places: Motions,
) -> Judgement:
    """Judge what is learned from answers on each answer in turn, which is left out (Stone 1974).

    The learned directions have to be better (`BETTER`) than the present ones, than standing still, and than
    the mean of the other shown motions whatever the answer. Where they are not, but the present ones are
    better than the last two, the answers agree with the present ones.

    ``places`` are motions, at whose starts a full push in each direction has to move the tools.
    """
    count, motions = len(answers), answers.motions
    size = np.square(lengths(chain, motions)).sum()

    def error(reached: FloatArray) -> float:
        return float(np.square(reached - pose_vectors(chain, motions.end)).sum() / size)

    now = error(outcome(present, decoder, chain, motions, answers.u))
    if count < FEWEST:
        return Judgement(None, now, "answers_few")
    if _on_a_line(answers.u):
        return Judgement(None, now, "answers_alike")
    start, step = pose_vectors(chain, motions.start), _steps(chain, motions)
    ignoring = min(error(start + (step.sum(axis=0) - step) / (count - 1)), 1.0)
    held_out: list[FloatArray] = []
    for row in range(count):
        one = answers[np.array([row])]
        others = learn(answers[np.delete(np.arange(count), row)])
        held_out.append(outcome(others, decoder, chain, one.motions, one.u)[0])
    learned = error(np.stack(held_out))
    refusal: Refusal | None = None
    if learned > BETTER * now and now <= BETTER * ignoring:
        refusal = "answers_agree"
    elif learned > BETTER * min(now, ignoring):
        refusal = "answers_unclear"
    elif _weakest(learn(answers), decoder, chain, places) < WEAK:
        refusal = "answers_weak"
    return Judgement(learned, now, refusal)


def _steps(chain: Chain, motions: Motions) -> FloatArray:
    return pose_vectors(chain, motions.end) - pose_vectors(chain, motions.start)


def _on_a_line(u: FloatArray) -> bool:
    """Answers (N, d) of several axes leave one of them open, such as N times the same."""
    spread = np.linalg.svd(u, compute_uv=False)
    return bool(u.shape[1] > 1 and spread[-1] <= LINE * spread[0])


def _weakest(alignment: Alignment, decoder: Decoder, chain: Chain, places: Motions) -> float:
    """How far the weakest full push along an axis moves the tools, in the median, in median shown motions."""
    axes = np.eye(decoder.latent_dim)
    start = pose_vectors(chain, places.start)
    way = [
        np.linalg.norm(
            outcome(alignment, decoder, chain, places, np.broadcast_to(push, (len(places), len(axes))))
            - start,
            axis=-1,
        )
        for push in (*axes, *-axes)
    ]
    return float(np.median(way, axis=1).min() / np.median(lengths(chain, places)))
