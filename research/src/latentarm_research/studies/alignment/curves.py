"""How the error falls with the number of answers, by how questions are chosen, and where asking stops."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np

from latentarm.alignment.answers import Answers
from latentarm.alignment.queries import FEWEST, StoppingRule, order_of_questions
from latentarm.core.types import FloatArray
from latentarm_research.alignment.training import FitConfig
from latentarm_research.studies.alignment.preset import ALL_PRIORS, CHOSEN, TOOL_SPACE
from latentarm_research.studies.alignment.scene import AlignmentCell, Scene, scene_of

PRIORS_AT_RANDOM: Final = f"{ALL_PRIORS}, at random"
AT_RANDOM: Final = f"{TOOL_SPACE}, at random"

CHOICES: Final = (PRIORS_AT_RANDOM, AT_RANDOM, CHOSEN)
"""What is learned, and how questions are chosen; the last is what `latentarm align` does."""


@dataclass(frozen=True, eq=False)
class CurveResult:
    """Results of one cell."""

    cell: AlignmentCell
    # choice -> number of answers -> (R,), relative error of each run on the held-out motions
    errors: Mapping[str, Mapping[int, FloatArray]]
    stopped_after: FloatArray  # (R,), answers after which `latentarm align` would have stopped
    stopped_at: FloatArray  # (R,), the error there


def measure_curve(cell: AlignmentCell) -> CurveResult:
    """Ask one question after another, and measure what is learned from each number of answers.

    Every run has different candidates; the answer to each does not depend on when it is asked.
    """
    scene, sizes = scene_of(cell.learned), cell.preset.curves
    said = scene.candidates(cell.noise)
    most = min(len(said[0]), max(sizes.answers))
    orders = [order_of_questions(scene.chain, answers.motions, most) for answers in said]

    def errors(orders: Sequence[Sequence[int]], count: int) -> FloatArray:
        return scene.errors(
            [
                scene.in_tool_space(answers[np.array(order[:count])])
                for answers, order in zip(said, orders, strict=True)
            ]
        )

    at_random = [list(range(most)) for _ in said]
    counts = [count for count in sizes.answers if count <= most]
    after = [_stop(scene, answers, order) for answers, order in zip(said, orders, strict=True)]
    stopped = [
        scene.in_tool_space(answers[np.array(order[:count])])
        for answers, order, count in zip(said, orders, after, strict=True)
    ]
    return CurveResult(
        cell=cell,
        errors={
            PRIORS_AT_RANDOM: {
                count: _with_priors(cell, scene, said, count) for count in sizes.networks if count <= most
            },
            AT_RANDOM: {count: errors(at_random, count) for count in counts},
            CHOSEN: {count: errors(orders, count) for count in counts},
        },
        stopped_after=np.array(after, dtype=np.float64),
        stopped_at=scene.errors(stopped),
    )


def _stop(scene: Scene, said: Answers, order: Sequence[int]) -> int:
    """After how many answers `latentarm align` stops."""
    history: list[float] = []
    for count in range(FEWEST, len(order)):
        history.append(scene.meant(said[np.array(order[:count])]).share)
        if StoppingRule().enough(history):
            return count
    return len(order)


def _with_priors(cell: AlignmentCell, scene: Scene, said: Sequence[Answers], count: int) -> FloatArray:
    """Relative errors (R,) of All Priors with the first answers, which are at random."""
    answers = [one[np.arange(count)] for one in said]
    return scene.errors(scene.learn(answers, FitConfig(steps=cell.preset.steps), range(len(said))))
