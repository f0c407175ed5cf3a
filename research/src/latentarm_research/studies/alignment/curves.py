"""The error by the number of answers about motions that `latentarm align` chooses."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Final

import numpy as np

from latentarm.alignment.queries import order_of_questions
from latentarm.core.types import FloatArray
from latentarm_research.alignment.training import FitConfig
from latentarm_research.studies.alignment.preset import ALL_PRIORS, CHOSEN
from latentarm_research.studies.alignment.scene import AlignmentCell, scene_of

PRIORS_AT_RANDOM: Final = f"{ALL_PRIORS}, at random"


@dataclass(frozen=True, eq=False)
class CurveResult:
    """Results of one cell."""

    cell: AlignmentCell
    # choice of questions -> number of answers -> (R,), relative error of each run on the held-out motions
    errors: Mapping[str, Mapping[int, FloatArray]]


def measure_curve(cell: AlignmentCell) -> CurveResult:
    """Ask one question after another, and measure what is learned from each number of answers.

    Every run has different candidates; the answer to each does not depend on when it is asked. The first of
    them, which are at random, teach All Priors beside that.
    """
    scene, preset = scene_of(cell.learned), cell.preset
    said = scene.candidates(cell.noise)
    counts = [count for count in preset.curves.answers if count <= len(said[0])]
    orders = [np.array(order_of_questions(scene.chain, one.motions, max(counts))) for one in said]
    few = min(preset.answers, len(said[0]))
    first = [one[np.arange(few)] for one in said]
    with_priors = scene.learn(first, FitConfig(steps=preset.steps), range(len(said)))
    chosen = {
        count: [scene.in_tool_space(one[order[:count]]) for one, order in zip(said, orders, strict=True)]
        for count in counts
    }
    return CurveResult(
        cell,
        {
            PRIORS_AT_RANDOM: {few: scene.errors(with_priors)},
            CHOSEN: {count: scene.errors(alignments) for count, alignments in chosen.items()},
        },
    )
