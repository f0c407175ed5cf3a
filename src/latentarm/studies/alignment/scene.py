"""Everything about one task and one decoder that all alignments share."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Final, final

import numpy as np

from latentarm.alignment.answers import Answers, Motions
from latentarm.alignment.contract import Alignment
from latentarm.alignment.demonstrated import demonstrated_motions, noticeable
from latentarm.alignment.error import lengths, outcome, relative_alignment_error
from latentarm.alignment.poses import pose_vectors
from latentarm.alignment.training import FitConfig, FittedAlignments, fit_alignments
from latentarm.kinematics.chain import Chain
from latentarm.models.decoder import Decoder
from latentarm.models.model import LatentActionModel
from latentarm.operators.preference import Imprecise, Preference
from latentarm.studies.alignment.decoder import LearnedDecoder, demonstrate
from latentarm.studies.alignment.people import preference_of
from latentarm.studies.alignment.streams import Stream
from latentarm.studies.streams import generator
from latentarm.tasks.pouring.tasks import POURING_TASKS
from latentarm.types import FloatArray

ALL: Final = 10**9
"""More motions than there are."""


@final
@dataclass(frozen=True, eq=False)
class Scene:
    """What alignments are learned in and judged by.

    Attributes:
        learned: the decoder.
        chain: the arm.
        preference: what the simulated person means.
        shown: motions of the training demonstrations that a person can tell from standing still.
        unlabelled: (M, c), contexts of the training demonstrations.
        test: held-out motions, and what is meant by them without noise.
    """

    learned: LearnedDecoder
    chain: Chain
    preference: Preference
    shown: Motions
    unlabelled: FloatArray
    test: Answers

    @property
    def model(self) -> LatentActionModel:
        """The fitted model."""
        return self.learned.model

    @cached_property
    def decoder(self) -> Decoder:
        """The function phi of the paper."""
        return self.model.decoder()

    def ask(self, count: int, noise: float, stream: Stream, answers: Stream, run: int) -> Answers:
        """What one run's person says of motions drawn at random.

        Args:
            count: answers; all motions where there are fewer.
            noise: coefficient of variation of the answers.
            stream: of the draw of motions: the first of more motions are those of fewer.
            answers: of the noise.
            run: which run.
        """
        cell = self.learned.cell
        rows = generator(cell.seed, cell.task, stream, run).permutation(len(self.shown))[:count]
        motions = self.shown[rows]
        person = Imprecise(self.preference, noise, generator(cell.seed, cell.task, answers, run))
        return Answers(motions, person.inputs(motions))

    def learn(self, answers: Sequence[Answers], config: FitConfig, seeds: Sequence[int]) -> FittedAlignments:
        """An alignment for each of S runs, from the seeds' first weights."""
        return fit_alignments(self.model, self.chain, answers, self.unlabelled, config, seeds=seeds)

    def errors(self, alignments: Sequence[Alignment]) -> FloatArray:
        """Relative errors (S,) on the held-out motions."""
        return np.array(
            [relative_alignment_error(one, self.decoder, self.chain, self.test) for one in alignments]
        )

    def encoded(self) -> float:
        """The relative error with the latent action that the encoder would choose, which knows the motion.

        The encoder looks for the nearest action in the joints and not for the nearest place of the tool, so
        that an alignment may come out below it.
        """
        motions = self.test.motions
        z = self.model.encode(motions.context, motions.action)[0]
        reached = outcome(lambda u, _: u, self.decoder, self.chain, motions, z)
        missed = reached - pose_vectors(self.chain, motions.end)
        return float(np.square(missed).sum() / np.square(lengths(self.chain, motions)).sum())


def scene_of(learned: LearnedDecoder) -> Scene:
    """The scene of a decoder, the same whenever it is asked for.

    Raises:
        UserError: the preset's sizes leave no motion to ask about.
    """
    cell = learned.cell
    chain = POURING_TASKS[cell.task]().robot.chain
    training = demonstrate(cell, Stream.TRAINING)
    preference = preference_of(cell.task, chain)

    def draw(stream: Stream) -> np.random.Generator:
        return generator(cell.seed, cell.task, stream)

    every = demonstrated_motions(training, ALL, draw(Stream.SHOWN))
    test = demonstrated_motions(
        demonstrate(cell, Stream.TEST), cell.preset.test_motions, draw(Stream.TEST_MOTIONS)
    )
    return Scene(
        learned=learned,
        chain=chain,
        preference=preference,
        shown=every[np.flatnonzero(noticeable(every, chain))],
        unlabelled=demonstrated_motions(training, cell.preset.unlabelled, draw(Stream.UNLABELLED)).context,
        test=Answers(test, preference.inputs(test)),
    )
