"""One cell of the study: every way of finding an alignment, for one task, one decoder and one noise."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np

from latentarm.alignment.answers import Answers
from latentarm.alignment.contract import identity
from latentarm.alignment.queries import order_of_questions
from latentarm.core.types import FloatArray
from latentarm_research.alignment.affine import fit_affine
from latentarm_research.alignment.priors import NO_PRIORS
from latentarm_research.alignment.training import FitConfig
from latentarm_research.studies.alignment import preset as ways
from latentarm_research.studies.alignment.scene import AlignmentCell, Scene, scene_of

PRIORS_AT_RANDOM: Final = f"{ways.ALL_PRIORS}, at random"

Curves = Mapping[str, Mapping[int, FloatArray]]
"""Choice of questions -> number of answers -> (R,), relative error of each run on the held-out motions."""


@dataclass(frozen=True, eq=False)
class AlignmentErrors:
    """The errors of every condition."""

    cell: AlignmentCell
    # condition -> (R,), relative error of each run on the held-out motions; (1,) where nothing is learned
    errors: Mapping[str, FloatArray]
    curves: Curves  # by the number of answers; empty under noises without curves
    encoded: float  # the error of the encoder's choice, see `Scene.encoded`


def measure_cell(cell: AlignmentCell) -> AlignmentErrors:
    """Ask, learn all runs of a condition in one fit, and measure the errors.

    All models and noises get the same motions, so that nothing else differs.
    """
    scene, preset = scene_of(cell), cell.preset
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
    candidates = scene.candidates(cell.noise)
    errors[ways.CHOSEN] = _chosen(scene, candidates, [preset.answers])[preset.answers]
    # To its end, which answers decide that train nothing.
    to_its_end = FitConfig(NO_PRIORS, steps=preset.ideal_steps, held_out=preset.ideal_held_out)
    many = ask(preset.ideal_answers)[: preset.ideal_runs]
    errors[ways.IDEAL] = scene.errors(scene.learn(many, to_its_end, runs[: preset.ideal_runs]))
    curves = _curves(scene, candidates) if cell.noise in preset.curves.noises else {}
    return AlignmentErrors(cell, errors, curves, scene.encoded())


def _chosen(scene: Scene, candidates: Sequence[Answers], counts: Sequence[int]) -> dict[int, FloatArray]:
    """Errors (R,) in tool space by the number of answers, about motions that `latentarm align` chooses.

    Every run has different candidates; the answer to each does not depend on when it is asked.
    """
    most = min(max(counts), len(candidates[0]))
    orders = [np.array(order_of_questions(scene.chain, one.motions, most)) for one in candidates]
    return {
        count: scene.errors(
            [scene.in_tool_space(one[order[:count]]) for one, order in zip(candidates, orders, strict=True)]
        )
        for count in counts
    }


def _curves(scene: Scene, candidates: Sequence[Answers]) -> Curves:
    """Errors by the choice of questions and the number of answers.

    The first of the candidates, which are at random, teach All Priors beside that.
    """
    preset, most = scene.cell.preset, len(candidates[0])
    few = min(preset.answers, most)
    first = [one[np.arange(few)] for one in candidates]
    with_priors = scene.learn(first, FitConfig(steps=preset.steps), range(len(candidates)))
    return {
        PRIORS_AT_RANDOM: {few: scene.errors(with_priors)},
        ways.CHOSEN: _chosen(scene, candidates, [one for one in preset.curves.answers if one <= most]),
    }
