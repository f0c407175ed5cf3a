"""People whose axes turn over the table: the same push means another direction in another place."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Final, final

import numpy as np

from latentarm.alignment.answers import Answers, Motions
from latentarm.alignment.meaning import rotations
from latentarm.alignment.preference import Preference
from latentarm.alignment.queries import order_of_questions
from latentarm.core.types import FloatArray
from latentarm.robots.kinematics.chain import Chain
from latentarm_research.alignment.preferences import Imprecise
from latentarm_research.alignment.training import FitConfig
from latentarm_research.studies.alignment.cell import ideal_config
from latentarm_research.studies.alignment.curves import AT_RANDOM, PRIORS_AT_RANDOM
from latentarm_research.studies.alignment.preset import CHOSEN, IDEAL, Stream
from latentarm_research.studies.alignment.scene import AlignmentCell, Scene, scene_of
from latentarm_research.studies.streams import generator
from latentarm_research.tasks.pouring.tasks import FAR_LEFT_M, NEAR_RIGHT_M

TASK: Final = "plane"  # the task over the table
FEW_CHOSEN: Final = 4  # chosen answers that should do as well as all random ones do with All Priors
FEW: Final = f"{CHOSEN}, {FEW_CHOSEN} answers"
TURNING: Final = (PRIORS_AT_RANDOM, AT_RANDOM, CHOSEN, FEW, IDEAL)
"""What is compared; with as many answers as in the paper where the name does not say otherwise."""


@final
@dataclass(frozen=True, eq=False)
class TurningAxes:
    """A simulated person whose stick turns evenly along one direction of the table."""

    chain: Chain  # the arm; its first tool is looked at
    axes: Preference  # what they mean where it is not turned
    mirrored: bool  # whether the second axis is the other way round
    middle_rad: float  # how far the stick is turned in the middle of the table, rad
    turn_rad: float  # how much farther it is turned at the end of the table, rad
    along: FloatArray  # (2,), the unit direction in the plane along which it turns

    def inputs(self, motions: Motions) -> FloatArray:
        """The inputs (N, 2) by which they would ask for N motions."""
        low, high = np.array(NEAR_RIGHT_M), np.array(FAR_LEFT_M)
        place = self.chain.forward(motions.start).position[:, :2]
        share = (place - (low + high) / 2) @ self.along / (np.abs(self.along) @ (high - low) / 2)
        meant = self.axes.inputs(motions) * np.array([1.0, -1.0 if self.mirrored else 1.0])
        turned = rotations(self.middle_rad + self.turn_rad * share) @ meant[..., None]
        return np.clip(turned[..., 0], -1.0, 1.0)


def person(scene: Scene, number: int) -> TurningAxes:
    """The simulated person of a number: any turn in the middle, mirrored or not, along any direction."""
    cell = scene.learned.cell
    rng = generator(cell.seed, cell.task, Stream.PEOPLE, number)
    middle, way = rng.uniform(0.0, 2 * np.pi, 2)
    return TurningAxes(
        chain=scene.chain,
        axes=scene.preference,
        mirrored=bool(number % 2),
        middle_rad=float(middle),
        turn_rad=cell.preset.turning.turn_rad,
        along=np.array([np.cos(way), np.sin(way)]),
    )


@dataclass(frozen=True, eq=False)
class TurningResult:
    """What was measured."""

    cell: AlignmentCell
    # condition of `TURNING` -> (people,), relative errors on the held-out motions; of Ideal Align for the
    # first people alone
    errors: Mapping[str, FloatArray]


def measure_turning(cell: AlignmentCell) -> TurningResult:
    """Ask all people, learn, and measure.

    Raises:
        UserError: the preset's sizes leave nothing to ask or to learn.
    """
    scene, preset = scene_of(cell.learned), cell.preset
    everyone = [person(scene, number) for number in range(preset.turning.people)]
    tests = [Answers(scene.test.motions, one.inputs(scene.test.motions)) for one in everyone]
    said = [_ask(cell, scene, number, preset.curves.candidates) for number in range(len(everyone))]
    many = preset.turning.ideal_people
    much = [_ask(cell, scene, number, preset.ideal_answers) for number in range(many)]
    random = [one[np.arange(min(preset.answers, len(one)))] for one in said]
    asked = min(preset.answers, len(said[0]))
    orders = [np.array(order_of_questions(scene.chain, one.motions, asked)) for one in said]
    best = [one[order] for one, order in zip(said, orders, strict=True)]
    learned = {
        PRIORS_AT_RANDOM: scene.learn(random, FitConfig(steps=preset.steps), range(len(random))).alignments,
        AT_RANDOM: [scene.in_tool_space(one) for one in random],
        CHOSEN: [scene.in_tool_space(one) for one in best],
        FEW: [scene.in_tool_space(one[np.arange(min(FEW_CHOSEN, len(one)))]) for one in best],
        IDEAL: scene.learn(much, ideal_config(preset), range(many)).alignments,
    }
    errors = {
        name: np.array([scene.error(one, test) for one, test in zip(alignments, tests, strict=False)])
        for name, alignments in learned.items()
    }
    return TurningResult(cell, errors)


def _ask(cell: AlignmentCell, scene: Scene, number: int, count: int) -> Answers:
    """A person's answers about motions drawn at random."""
    where = cell.learned.cell
    rows = generator(where.seed, where.task, Stream.PEOPLE_QUESTIONS, number).permutation(len(scene.shown))
    motions = scene.shown[rows[:count]]
    noise = generator(where.seed, where.task, Stream.PEOPLE_QUESTIONS, number, 1)
    return Answers(motions, Imprecise(person(scene, number), cell.noise, noise).inputs(motions))
