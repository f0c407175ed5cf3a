"""One cell of the study: every way of finding an alignment, for one task, one decoder and one noise."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from latentarm.alignment.answers import Answers
from latentarm.alignment.contract import identity
from latentarm.alignment.queries import order_of_questions
from latentarm.core.types import FloatArray
from latentarm_research.alignment.affine import fit_affine
from latentarm_research.alignment.priors import NO_PRIORS
from latentarm_research.alignment.training import FitConfig
from latentarm_research.studies.alignment import preset as ways
from latentarm_research.studies.alignment.scene import AlignmentCell, scene_of


@dataclass(frozen=True, eq=False)
class AlignmentErrors:
    """The errors of every condition."""

    cell: AlignmentCell
    # condition -> (R,), relative error of each run on the held-out motions; (1,) where nothing is learned
    errors: Mapping[str, FloatArray]
    encoded: float  # the error of the encoder's choice, see `Scene.encoded`


def measure_cell(cell: AlignmentCell) -> AlignmentErrors:
    """Ask, learn all runs of a condition in one fit, and measure the errors.

    All models and noises get the same motions, so that nothing else differs.
    """
    scene, preset = scene_of(cell.learned), cell.preset
    runs = range(preset.runs)

    def ask(count: int) -> list[Answers]:
        return [scene.ask(count, cell.noise, ways.Stream.QUESTIONS, ways.Stream.ANSWERS, run) for run in runs]

    few = ask(preset.answers)
    errors = {
        ways.NO_ALIGN: scene.errors([identity]),
        ways.MANUAL: scene.errors([fit_affine(scene.model, answers) for answers in few]),
    }
    for name, priors in ways.LEARNED.items():
        errors[name] = scene.errors(scene.learn(few, FitConfig(priors, steps=preset.steps), runs))
    errors[ways.TOOL_SPACE] = scene.errors([scene.in_tool_space(answers) for answers in few])
    asked = [
        said[np.array(order_of_questions(scene.chain, said.motions, min(preset.answers, len(said))))]
        for said in scene.candidates(cell.noise)
    ]
    errors[ways.CHOSEN] = scene.errors([scene.in_tool_space(answers) for answers in asked])
    # To its end, which answers decide that train nothing.
    to_its_end = FitConfig(NO_PRIORS, steps=preset.ideal_steps, held_out=preset.ideal_held_out)
    many = ask(preset.ideal_answers)[: preset.ideal_runs]
    errors[ways.IDEAL] = scene.errors(scene.learn(many, to_its_end, runs[: preset.ideal_runs]))
    return AlignmentErrors(cell, errors, scene.encoded())
