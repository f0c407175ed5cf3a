"""What alignments are learned in: a decoder, learned once for each task and model, and a simulated person."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Final, final

import numpy as np

from latentarm.alignment.answers import Answers, Motions
from latentarm.alignment.contract import Alignment
from latentarm.alignment.demonstrated import CANDIDATES, demonstrated_motions, noticeable
from latentarm.alignment.demonstrated_directions import DemonstratedDirections
from latentarm.alignment.error import lengths, outcome, relative_alignment_error
from latentarm.alignment.poses import pose_vectors
from latentarm.alignment.posterior import fit_meaning
from latentarm.alignment.preference import Preference, ToolAxes
from latentarm.alignment.runtime import LearnedAlignment
from latentarm.alignment.tool_space import ToolSpace, ToolSpaceAlignment
from latentarm.core.types import Demonstrations, FloatArray
from latentarm.models.decoder import Decoder
from latentarm.models.model import LatentActionModel
from latentarm.robots.kinematics.chain import Chain
from latentarm_research.alignment.preferences import ByPlace, HeightAndTilt, Imprecise
from latentarm_research.alignment.training import FitConfig, fit_alignments
from latentarm_research.studies.alignment.preset import PAPER_MODEL, Preset, Stream
from latentarm_research.studies.fitting import fit_model, validation_episodes
from latentarm_research.studies.streams import generator, integer, sequence
from latentarm_research.tasks.pouring.tasks import POURING_TASKS, at_bowl
from latentarm_research.tasks.pouring.tool_path import SPEED_M_S, TURN_RAD_S


def preference_of(
    task: str,  # a name of `POURING_TASKS`
    chain: Chain,
) -> Preference:
    """What is meant in a task: a full push is the fastest motion of the demonstrations."""
    plane = ToolAxes(chain, 2, SPEED_M_S)
    pour = HeightAndTilt(chain, SPEED_M_S, TURN_RAD_S)
    return {"plane": plane, "pour": pour, "reach_and_pour": ByPlace(chain, at_bowl, pour, plane)}[task]


WINDOW: Final = 10
"""Samples that an action may reach ahead and back: half a second, as long as a motion that is asked about."""


@dataclass(frozen=True)
class DecoderCell:
    """A decoder to be learned."""

    task: str  # a name of `POURING_TASKS`
    preset: Preset  # sizes of the study
    seed: int  # of the whole study


@final
@dataclass(frozen=True, eq=False)
class AlignmentCell:
    """What is to be measured with a decoder."""

    decoder: DecoderCell  # how the decoder was learned
    model: LatentActionModel  # that has it: fitted, of one seed
    noise: float  # coefficient of variation of the answers

    @property
    def task(self) -> str:
        """Name of the task."""
        return self.decoder.task

    @property
    def preset(self) -> Preset:
        """Sizes of the study."""
        return self.decoder.preset


def demonstrate(cell: DecoderCell, stream: Stream) -> Demonstrations:
    """The demonstrations for training or for testing; each call returns the same."""
    preset = cell.preset
    episodes = preset.episodes if stream == Stream.TRAINING else preset.test_episodes
    return POURING_TASKS[cell.task]().demonstrate(episodes, generator(cell.seed, cell.task, stream))


def learn_decoder(cell: DecoderCell) -> LatentActionModel:
    """Demonstrate and fit."""
    preset, demonstrations = cell.preset, demonstrate(cell, Stream.TRAINING)
    return fit_model(
        PAPER_MODEL,
        demonstrations,
        validation=validation_episodes(demonstrations),
        latent_dim=2,
        window=WINDOW,
        state_noise_rad=preset.state_noise_rad,
        data_seed=integer(sequence(cell.seed, cell.task, Stream.STATE_NOISE)),
        seed=integer(sequence(cell.seed, cell.task, Stream.NETWORKS)),
        hidden=preset.hidden,
        epochs=preset.epochs,
        batch_size=preset.batch_size,
        patience=preset.epochs,
        fit={"chain": POURING_TASKS[cell.task]().robot.chain},
    )


ALL: Final = 10**9  # more motions than there are


@final
@dataclass(frozen=True, eq=False)
class Scene:
    """What alignments are learned and judged with."""

    cell: AlignmentCell
    chain: Chain
    preference: Preference  # what the simulated person means
    shown: Motions  # motions of the training demonstrations that are visibly not rest
    unlabelled: FloatArray  # (M, c), contexts of the training demonstrations
    test: Answers  # held-out motions, and what is meant by them without noise
    surroundings: DemonstratedDirections  # of the training demonstrations

    @property
    def model(self) -> LatentActionModel:
        """The fitted model."""
        return self.cell.model

    @cached_property
    def decoder(self) -> Decoder:
        """The function phi of the paper."""
        return self.model.decoder()

    def ask(
        self,
        count: int,  # answers; all motions where there are fewer
        noise: float,  # coefficient of variation of the answers
        stream: Stream,  # of the draw of motions: the first of more motions are those of fewer
        answers: Stream,
        run: int,
    ) -> Answers:
        """One person's answers about motions drawn at random."""
        cell = self.cell.decoder
        rows = generator(cell.seed, cell.task, stream, run).permutation(len(self.shown))[:count]
        motions = self.shown[rows]
        person = Imprecise(self.preference, noise, generator(cell.seed, cell.task, answers, run))
        return Answers(motions, person.inputs(motions))

    def candidates(self, noise: float) -> list[Answers]:
        """For each run, motions that may be asked about, and what would be answered."""
        preset = self.cell.preset
        return [
            self.ask(preset.curves.candidates, noise, Stream.CANDIDATES, Stream.CANDIDATE_ANSWERS, run)
            for run in range(preset.runs)
        ]

    def learn(
        self, answers: Sequence[Answers], config: FitConfig, seeds: Sequence[int]
    ) -> tuple[LearnedAlignment, ...]:
        """An alignment for each of S runs, from the seeds' first weights."""
        return fit_alignments(self.model, self.chain, answers, self.unlabelled, config, seeds=seeds)

    def in_tool_space(self, answers: Answers) -> ToolSpaceAlignment:
        """The alignment of `latentarm align`, judged on the first of the motions that are shown."""
        few = self.shown[np.arange(min(CANDIDATES, len(self.shown)))]
        meant = fit_meaning(answers, self.chain, self.surroundings, few)
        known = ToolSpace(meant.meaning, self.surroundings, answers.motions.duration_s)
        return known.with_arm(self.decoder, self.chain)

    def errors(self, alignments: Sequence[Alignment]) -> FloatArray:
        """Relative errors (S,) on the held-out motions."""
        return np.array(
            [relative_alignment_error(one, self.decoder, self.chain, self.test) for one in alignments]
        )

    def encoded(self) -> float:
        """The relative error with the latent action that the encoder would choose, which knows the motion.

        The encoder looks for the nearest joint action and not for the nearest tool position, so an alignment
        may have a lower error.
        """
        motions = self.test.motions
        z = self.model.encode(motions.context, motions.action)[0]
        reached = outcome(lambda u, _: u, self.decoder, self.chain, motions, z)
        missed = reached - pose_vectors(self.chain, motions.end)
        return float(np.square(missed).sum() / np.square(lengths(self.chain, motions)).sum())


def scene_of(measured: AlignmentCell) -> Scene:
    """The scene of a cell; each call returns the same."""
    cell = measured.decoder
    chain = POURING_TASKS[cell.task]().robot.chain
    training = demonstrate(cell, Stream.TRAINING)
    preference = preference_of(cell.task, chain)

    def draw(stream: Stream) -> np.random.Generator:
        return generator(cell.seed, cell.task, stream)

    every = demonstrated_motions(training, ALL, draw(Stream.SHOWN))
    test = demonstrated_motions(
        demonstrate(cell, Stream.TEST), cell.preset.test_motions, draw(Stream.TEST_MOTIONS)
    )
    shown = every[np.flatnonzero(noticeable(every, chain))]
    some = shown[draw(Stream.SURROUNDINGS).permutation(len(shown))[: cell.preset.surroundings]]
    return Scene(
        cell=measured,
        chain=chain,
        preference=preference,
        shown=shown,
        unlabelled=demonstrated_motions(training, cell.preset.unlabelled, draw(Stream.UNLABELLED)).context,
        test=Answers(test, preference.inputs(test)),
        surroundings=DemonstratedDirections.of_motions(some, chain, 2),
    )
