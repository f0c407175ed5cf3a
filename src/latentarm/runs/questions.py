"""Asking a person for their meaning of an input, question by question."""

from dataclasses import dataclass
from functools import cached_property
from typing import final

import numpy as np

from latentarm.alignment.answers import Answers, Motions
from latentarm.alignment.demonstrated import CANDIDATES
from latentarm.alignment.demonstrated_directions import DemonstratedDirections
from latentarm.alignment.posterior import Posterior, fit_meaning
from latentarm.alignment.queries import FEWEST, QuestionDesign, StoppingRule, next_motion
from latentarm.alignment.tool_space import ToolSpace
from latentarm.core.errors import UserError
from latentarm.core.types import FloatArray
from latentarm.models.decoder import Decoder
from latentarm.robots.kinematics.chain import Chain
from latentarm.runs.person import Question, Respondent, Say


@final
@dataclass(frozen=True, eq=False)
class AlignmentProblem:
    """The decoder, the arm and the demonstrated motions that a person is asked about."""

    decoder: Decoder
    chain: Chain
    motions: Motions

    @cached_property
    def candidates(self) -> Motions:
        """Motions that may be asked about."""
        return self.motions[np.arange(min(CANDIDATES, len(self.motions)))]

    @cached_property
    def surroundings(self) -> DemonstratedDirections:
        """The demonstrated directions in each place."""
        return DemonstratedDirections.of_motions(self.motions, self.chain, self.decoder.latent_dim)

    def posterior(self, answers: Answers) -> Posterior:
        """The person's meaning, learned from answers."""
        return fit_meaning(answers, self.chain, self.surroundings, self.candidates)

    def learn(self, answers: Answers) -> ToolSpace:
        """The part of it that a profile keeps."""
        return ToolSpace(self.posterior(answers).meaning, self.surroundings, answers.motions.duration_s)


def ask(scene: AlignmentProblem, person: Respondent, count: int, say: Say, stopping: StoppingRule) -> Answers:
    """Ask about the motion that teaches most, again and again, until enough is known.

    At most ``count`` questions are answered; ``stopping`` may end the asking earlier.

    Raises UserError where nobody answers.
    """
    motions, chain = scene.candidates, scene.chain
    places = [chain.forward(state).position for state in (motions.start, motions.end)]
    reach_m = float(np.linalg.norm(places[1] - places[0], axis=-1).max())
    design = QuestionDesign(chain, motions)
    asked: list[int] = []
    answered: dict[int, FloatArray] = {}
    history: list[float] = []
    while len(answered) < count and len(asked) < len(motions):
        row = next_motion(design.worth(asked), asked)
        asked.append(row)
        motion = motions[np.array([row])]
        axes = scene.decoder.latent_dim
        reply = person.answer(Question(len(answered) + 1, count, motion, chain, reach_m, axes))
        if isinstance(reply, str):
            for again in asked[-2:]:
                answered.pop(again, None)
            del asked[-2:], history[max(len(answered) - FEWEST + 1, 0) :]
            continue
        if reply is None:
            continue
        answered[row] = reply
        if FEWEST <= len(answered) < count:
            history.append(scene.posterior(_answers(motions, answered)).share)
            if stopping.enough(history):
                say(f"{len(answered)} answers of a {person.kind} are enough: more would change little.")
                break
    if not answered:
        raise UserError("No question was answered, so there is nothing to learn: answer at least one.")
    return _answers(motions, answered)


def _answers(motions: Motions, answered: dict[int, FloatArray]) -> Answers:
    return Answers(motions[np.array(list(answered))], np.stack(list(answered.values())))
