"""Asking a person, question by question, what they mean by their input."""

from collections.abc import Callable
from contextlib import AbstractContextManager, nullcontext
from dataclasses import dataclass
from typing import final

import numpy as np

from latentarm.alignment.answers import Answers, Motions
from latentarm.alignment.queries import (
    ENSEMBLE,
    TOO_FEW,
    StoppingRule,
    bootstrap,
    disagreement,
    disagreement_share,
    next_motion,
    novelty,
)
from latentarm.alignment.training import QUICK, FitConfig, FittedAlignments, Report, fit_alignments, unheard
from latentarm.errors import UserError
from latentarm.kinematics.chain import Chain
from latentarm.models.model import LatentActionModel
from latentarm.runs.person import Person, Question, Say
from latentarm.types import FloatArray

Watch = Callable[[], AbstractContextManager[Report]]


def unwatched() -> AbstractContextManager[Report]:
    """A `Watch` that does nothing."""
    return nullcontext(unheard)


@final
@dataclass(frozen=True, eq=False)
class Scene:
    """What stays the same while a person is asked.

    Attributes:
        model: the trained model.
        seed_index: which of its seeds decodes.
        chain: the arm.
        motions: that may be asked about.
        unlabelled: (M, c).
        rng: of the ensembles.
        watch: opened for each fit; says whom to tell how far it is.
    """

    model: LatentActionModel
    seed_index: int
    chain: Chain
    motions: Motions
    unlabelled: FloatArray
    rng: np.random.Generator
    watch: Watch

    def learn(self, answers: list[Answers], config: FitConfig) -> FittedAlignments:
        """An alignment for each entry, from seeds 0, 1, ..."""
        with self.watch() as report:
            return fit_alignments(
                self.model,
                self.chain,
                answers,
                self.unlabelled,
                config,
                seed_index=self.seed_index,
                report=report,
            )


def ask(scene: Scene, person: Person, count: int, say: Say, stopping: StoppingRule) -> Answers:
    """Ask about the longest motion, then about the least like all before, until an ensemble agrees.

    Args:
        scene: what is asked about.
        person: who answers.
        count: questions to be answered, at most.
        say: shows text to the person.
        stopping: when fewer are enough.

    Raises:
        UserError: nobody answers, or there is nothing left to ask.
    """
    motions, chain = scene.motions, scene.chain
    places = [chain.forward(state).position for state in (motions.start, motions.end)]
    reach_m = float(np.linalg.norm(places[1] - places[0], axis=-1).max())
    asked: list[int] = []
    answered: dict[int, FloatArray] = {}
    history: list[float] = []
    while len(answered) < count and len(asked) < len(motions):
        row = next_motion(novelty(chain, motions, asked), asked)
        asked.append(row)
        motion = motions[np.array([row])]
        reply = person.answer(
            Question(len(answered) + 1, count, motion, chain, reach_m, scene.model.latent_dim)
        )
        if isinstance(reply, str):
            for again in asked[-2:]:
                answered.pop(again, None)
            del asked[-2:], history[max(len(answered) - TOO_FEW + 1, 0) :]
            continue
        if reply is None:
            continue
        answered[row] = reply
        if TOO_FEW <= len(answered) < count:
            so_far = _answers(motions, answered)
            ensemble = scene.learn(bootstrap(so_far, ENSEMBLE, scene.rng), QUICK).alignments
            apart = disagreement(ensemble, scene.model.decoder(scene.seed_index), chain, motions)
            history.append(disagreement_share(apart, chain, motions))
            if stopping.enough(history):
                say(f"{len(answered)} answers of a {person.kind} are enough: more would change little.")
                break
    if not answered:
        raise UserError("No question was answered, so there is nothing to learn: answer at least one.")
    return _answers(motions, answered)


def _answers(motions: Motions, answered: dict[int, FloatArray]) -> Answers:
    return Answers(motions[np.array(list(answered))], np.stack(list(answered.values())))
