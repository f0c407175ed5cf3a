"""The demo's models, and alignments of each with one simulated person, for the drives.

The person expects each axis of the stick to move the tool along one direction. The two directions are those
along which the demonstrated tool moves most (sideways, and forward and down), on a stick that is
turned by `TURN_RAD` and mirrored.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from math import pi
from typing import Final

import numpy as np

from latentarm.alignment.answers import Answers, Motions
from latentarm.alignment.contract import Alignment, identity
from latentarm.alignment.demonstrated import demonstrated_motions, shown
from latentarm.alignment.error import relative_alignment_error
from latentarm.alignment.queries import StoppingRule
from latentarm.core.types import Demonstrations, FloatArray
from latentarm.demonstrations.split import select_episodes, split_episodes
from latentarm.models.model import LatentActionModel
from latentarm.robots.kinematics.chain import Chain
from latentarm.runs.asking import FASTEST, SimulatedRespondent
from latentarm.runs.questions import AlignmentProblem, ask
from latentarm.tasks.table_top import TableTop
from latentarm_research.alignment.training import FitConfig, fit_alignments
from latentarm_research.people.expectation import Expectation, displacements, main_directions
from latentarm_research.studies.alignment import preset as ways
from latentarm_research.studies.alignment.cell import ideal_config
from latentarm_research.studies.fitting import STATE_NOISE_RAD, fit_model
from latentarm_research.studies.streams import generator, integer, sequence

TASK: Final = "table_top"

TURN_RAD: Final = pi / 3
"""How far the stick is turned before it is mirrored: far enough that no axis does what the person expects."""

HELD_OUT: Final = 0.2  # share of the demonstrations that are held out, as in the demo
EVERY: Final = 10**9  # more than the number of motions


@dataclass(frozen=True)
class AlignedDriveCell:
    """What is to be measured."""

    preset: ways.Preset  # sizes of the study
    seed: int  # of the study


@dataclass(frozen=True, eq=False)
class Learned:
    """What is driven with."""

    model: LatentActionModel  # S models of one kind
    alignments: tuple[Mapping[str, Alignment], ...]  # S times, condition -> alignment
    person: Expectation  # who was asked
    # condition -> (S,), relative alignment errors on motions that trained nothing
    errors: Mapping[str, FloatArray]


def learn(cell: AlignedDriveCell) -> Learned:
    """Demonstrate, fit all models in one fit, ask the person about each, and learn."""
    preset, task = cell.preset, TableTop()
    chain = task.robot.chain
    demonstrations = task.demonstrate(preset.drives.episodes, _generator(cell, ways.Stream.TRAINING))
    rows = split_episodes(demonstrations, HELD_OUT, _generator(cell, ways.Stream.TEST))
    training, held_out = (select_episodes(demonstrations, part) for part in rows)
    motions = demonstrated_motions(training, EVERY, _generator(cell, ways.Stream.SHOWN))
    person = turned_person(motions, chain)
    many = motions[np.arange(min(preset.ideal_answers, len(motions)))]
    model = _fit(cell, training, chain)
    ideal = Answers(many, person.inputs(many))
    alignments = tuple(
        _alignments(cell, model, seed, training, person, ideal) for seed in range(preset.drives.seeds)
    )
    tested = demonstrated_motions(held_out, preset.test_motions, _generator(cell, ways.Stream.TEST_MOTIONS))
    errors = _errors(model, alignments, chain, Answers(tested, person.inputs(tested)))
    return Learned(model, alignments, person, errors)


def turned_person(motions: Motions, chain: Chain) -> Expectation:
    """The simulated person: the two main directions of motions on a stick that is turned and mirrored.

    A full push along one direction is as fast as nearly all of the motions, as for the simulated person of
    `latentarm align`.
    """
    directions = main_directions(motions, chain, 2)
    along = np.abs(displacements(motions, chain) @ directions.T).max(axis=1)
    speed = float(np.quantile(along, FASTEST)) / motions.duration_s
    return Expectation(chain, directions, speed).turned_and_mirrored(TURN_RAD)


def _fit(cell: AlignedDriveCell, training: Demonstrations, chain: Chain) -> LatentActionModel:
    """The models, as the demo trains them."""
    return fit_model(
        ways.DRIVEN_MODEL,
        training,
        latent_dim=2,
        state_noise_rad=STATE_NOISE_RAD,
        seeds=cell.preset.drives.seeds,
        epochs=cell.preset.drives.epochs,
        seed=integer(sequence(cell.seed, TASK, ways.Stream.NETWORKS)),
        data_seed=integer(sequence(cell.seed, TASK, ways.Stream.STATE_NOISE)),
        fit={"chain": chain},
    )


def _alignments(
    cell: AlignedDriveCell,
    model: LatentActionModel,
    seed_index: int,
    training: Demonstrations,
    person: Expectation,
    ideal: Answers,
) -> dict[str, Alignment]:
    """Every alignment of one model: with priors and without, from the same answers."""
    drawing = _generator(cell, ways.Stream.CANDIDATES, seed_index)
    motions = shown(training, "state", person.chain, drawing)
    unlabelled = demonstrated_motions(training, cell.preset.unlabelled, drawing).context
    scene = AlignmentProblem(model.decoder(seed_index), person.chain, motions)
    count = cell.preset.drives.answers
    # Asking never stops early, so that every model has the same number of answers.
    stopping = StoppingRule(share=0.0, patience=count)
    answers = ask(scene, SimulatedRespondent(person, _unheard), count, _unheard, stopping)

    def learn(answers: Answers, config: FitConfig) -> Alignment:
        return fit_alignments(model, person.chain, [answers], unlabelled, config, seed_index=seed_index).best

    return {
        ways.NO_ALIGN: identity,
        **{
            name: learn(answers, FitConfig(ways.LEARNED[name], steps=cell.preset.steps))
            for name in (ways.WITHOUT_PRIORS, ways.ALL_PRIORS)
        },
        ways.TOOL_SPACE: scene.learn(answers).with_arm(model.decoder(seed_index), person.chain),
        ways.IDEAL: learn(ideal, ideal_config(cell.preset)),
    }


def _errors(
    model: LatentActionModel, alignments: tuple[Mapping[str, Alignment], ...], chain: Chain, test: Answers
) -> dict[str, FloatArray]:
    """Relative alignment errors (S,) by condition."""
    decoders = [model.decoder(seed) for seed in range(len(alignments))]
    return {
        name: np.array(
            [
                relative_alignment_error(of_seed[name], decoder, chain, test)
                for of_seed, decoder in zip(alignments, decoders, strict=True)
            ]
        )
        for name in alignments[0]
    }


def _generator(cell: AlignedDriveCell, *use: int) -> np.random.Generator:
    """One of the study's streams."""
    return generator(cell.seed, TASK, *use)


def _unheard(text: str) -> None:
    """Discards what the simulated person says."""
