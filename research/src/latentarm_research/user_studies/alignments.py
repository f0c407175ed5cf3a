"""What simulated people mean by the stick when they are asked, and what is learned from their answers."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Final, final

import numpy as np

from latentarm.alignment.answers import Answers, Motions
from latentarm.alignment.contract import Alignment
from latentarm.alignment.demonstrated import CANDIDATES, demonstrated_motions, shown
from latentarm.alignment.poses import ROTATION_WEIGHT_M
from latentarm.alignment.queries import order_of_questions
from latentarm.alignment.twists import motion_twists
from latentarm.core.types import Demonstrations, FloatArray
from latentarm.models.model import LatentActionModel
from latentarm.robots.kinematics.chain import Chain
from latentarm.runs.asking import FASTEST
from latentarm_research.alignment.preferences import Imprecise
from latentarm_research.alignment.priors import NO_PRIORS, Priors
from latentarm_research.alignment.training import FitConfig, fit_alignments
from latentarm_research.people.own_directions import InOwnDirections
from latentarm_research.people.traits import Traits
from latentarm_research.user_studies.definition import Aligns

PRIORS: Final[Mapping[Aligns, Priors]] = {"no_priors": NO_PRIORS, "all_priors": Priors()}
"""What counts beside the answers, by how an alignment is learned."""

UNLABELLED: Final = 1000  # contexts without an answer, in which the priors apply


@final
@dataclass(frozen=True, eq=False)
class MainMotions:
    """People who expect each axis of the stick to be one of the two motions that a task mostly takes."""

    chain: Chain  # the arm; only its first tool counts
    # (2, 6), unit vectors at right angles: linear velocity, and angular velocity times `ROTATION_WEIGHT_M`
    directions: FloatArray
    speed_m_s: float  # along one of them at a full push, m/s

    @property
    def usual(self) -> FloatArray:
        """(6, 2), the twist that is expected of a full push of each axis, m/s and rad/s."""
        twists = self.speed_m_s * self.directions.T
        return np.concatenate([twists[:3], twists[3:] / ROTATION_WEIGHT_M])

    def inputs(self, motions: Motions) -> FloatArray:
        """The inputs (N, 2) by which they would ask for N motions."""
        along = motion_twists(self.chain, motions) @ self.directions.T
        return np.clip(along / self.speed_m_s, -1.0, 1.0)


def main_motions(motions: Motions, chain: Chain) -> MainMotions:
    """The two directions in which an arm with one tool mostly moves, as principal directions about rest.

    A full push along one of them is as fast as nearly all of the motions.
    """
    twists = motion_twists(chain, motions)
    directions = np.linalg.svd(twists, full_matrices=False)[2][:2]
    largest = np.abs(directions).argmax(axis=1)
    directions = directions * np.sign(directions[np.arange(2), largest])[:, None]
    speed = float(np.quantile(np.abs(twists @ directions.T).max(axis=1), FASTEST))
    return MainMotions(chain, directions, speed)


@final
@dataclass(frozen=True, eq=False)
class Aligned:
    """What people usually mean, and what was learned of each."""

    usual: FloatArray  # (6, 2), see `MainMotions.usual`
    alignments: Mapping[Aligns, tuple[Alignment, ...]]  # of each person in order, by how they were learned


def learn_alignments(
    model: LatentActionModel,
    demonstrations: Demonstrations,
    chain: Chain,
    people: Sequence[Traits],  # who is asked, in order
    aligns: Sequence[Aligns],  # how alignments are learned; the answers are the same for all ways
    *,
    queries: int,
    steps: int,
    rng: np.random.Generator,
) -> Aligned:
    """Ask everybody about the same motions, and learn what each means, with priors and without."""
    motions = shown(demonstrations, model.context, chain, rng)
    unlabelled = demonstrated_motions(demonstrations, UNLABELLED, rng, context=model.context).context
    meaning = main_motions(motions, chain)
    candidates = motions[np.arange(min(CANDIDATES, len(motions)))]
    asked = candidates[np.array(order_of_questions(chain, candidates, min(queries, len(candidates))))]
    answers = [_answers(meaning, one, asked, rng) for one in people]
    learned: dict[Aligns, tuple[Alignment, ...]] = {
        way: fit_alignments(model, chain, answers, unlabelled, FitConfig(PRIORS[way], steps=steps))
        for way in aligns
    }
    return Aligned(meaning.usual, learned)


def _answers(meaning: MainMotions, person: Traits, asked: Motions, rng: np.random.Generator) -> Answers:
    own = InOwnDirections(meaning, person.directions)
    return Answers(asked, Imprecise(own, person.answer_variation, rng).inputs(asked))
