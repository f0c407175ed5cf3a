"""How the error falls with the number of answers, by how questions are chosen, and where asking stops."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np
from threadpoolctl import threadpool_limits

from latentarm.alignment.answers import Answers
from latentarm.alignment.queries import (
    TOO_FEW,
    StoppingRule,
    bootstrap,
    disagreement,
    disagreement_share,
    next_motion,
    novelty,
)
from latentarm.alignment.runtime import LearnedAlignment
from latentarm.alignment.training import FitConfig
from latentarm.studies.alignment.preset import Preset, Stream
from latentarm.studies.alignment.scene import LearnedDecoder, Scene, scene_of
from latentarm.studies.streams import generator
from latentarm.types import FloatArray

AT_RANDOM: Final = "at random"
BY_NOVELTY: Final = "by novelty"
BY_DISAGREEMENT: Final = "by disagreement"

CHOICES: Final = (AT_RANDOM, BY_NOVELTY, BY_DISAGREEMENT)
"""How questions are chosen; by novelty is what `latentarm align` does."""


@dataclass(frozen=True, eq=False)
class CurveCell:
    """What is to be measured.

    Attributes:
        learned: task and decoder.
        noise: coefficient of variation of the answers.
    """

    learned: LearnedDecoder
    noise: float

    @property
    def preset(self) -> Preset:
        """Sizes of the study."""
        return self.learned.cell.preset


@dataclass(frozen=True, eq=False)
class CurveResult:
    """What was measured, with all priors.

    Attributes:
        cell: what was asked for.
        errors: choice -> number of answers -> (R,), relative error of each run on the held-out motions.
        stopped_after: (R,), answers after which asking by novelty would have stopped.
        stopped_at: (R,), the error there.
    """

    cell: CurveCell
    errors: Mapping[str, Mapping[int, FloatArray]]
    stopped_after: FloatArray
    stopped_at: FloatArray


def measure_curve(cell: CurveCell) -> CurveResult:
    """Ask one question after another, and measure what is learned from each number of answers.

    The errors are the same to the last bit in every process. Every run has different candidates; the answer
    to each does not depend on when it is asked.

    Raises:
        UserError: the preset's sizes leave nothing to ask or to learn.
    """
    with threadpool_limits(limits=1):
        return _measure(cell)


def _measure(cell: CurveCell) -> CurveResult:
    scene, preset = scene_of(cell.learned), cell.preset
    said = [
        scene.ask(preset.curves.candidates, cell.noise, Stream.CANDIDATES, Stream.CANDIDATE_ANSWERS, run)
        for run in range(preset.runs)
    ]
    most = min(len(said[0]), max(preset.curves.answers))
    orders = {
        AT_RANDOM: [list(range(most)) for _ in said],
        BY_NOVELTY: [_by_novelty(scene, answers, most) for answers in said],
    }
    followed = min(most, preset.curves.disagreement_up_to)
    orders[BY_DISAGREEMENT] = _by_disagreement(cell, scene, said, followed)
    errors = {
        choice: {
            count: _errors(cell, scene, said, asked, [count] * len(said))
            for count in preset.curves.answers
            if count <= len(asked[0])
        }
        for choice, asked in orders.items()
    }
    after = _stops(cell, scene, said, orders[BY_NOVELTY])
    return CurveResult(
        cell=cell,
        errors=errors,
        stopped_after=np.array(after, dtype=np.float64),
        stopped_at=_errors(cell, scene, said, orders[BY_NOVELTY], after),
    )


def _by_novelty(scene: Scene, said: Answers, most: int) -> list[int]:
    """Rows of the questions of one run, in the order of asking."""
    asked: list[int] = []
    while len(asked) < most:
        asked.append(next_motion(novelty(scene.chain, said.motions, asked), asked))
    return asked


def _by_disagreement(cell: CurveCell, scene: Scene, said: Sequence[Answers], most: int) -> list[list[int]]:
    """Rows of the questions of each run: the first at random, then where an ensemble disagrees most."""
    asked = [list(range(min(TOO_FEW, most))) for _ in said]
    while len(asked[0]) < most:
        for run, ensemble in _ensembles(cell, scene, said, dict(enumerate(asked))).items():
            apart = disagreement(ensemble, scene.decoder, scene.chain, said[run].motions)
            asked[run].append(next_motion(apart, asked[run]))
    return asked


def _stops(
    cell: CurveCell, scene: Scene, said: Sequence[Answers], asked: Sequence[Sequence[int]]
) -> list[int]:
    """After how many answers each run would have stopped, as `latentarm align` does."""
    most = len(asked[0])
    after = [most] * len(said)
    asking = {run: list[float]() for run in range(len(said))}
    for count in range(TOO_FEW, most):
        rows = {run: asked[run][:count] for run in asking}
        for run, ensemble in _ensembles(cell, scene, said, rows).items():
            motions = said[run].motions
            apart = disagreement(ensemble, scene.decoder, scene.chain, motions)
            asking[run].append(disagreement_share(apart, scene.chain, motions))
            if StoppingRule().enough(asking[run]):
                after[run] = count
                del asking[run]
        if not asking:
            break
    return after


def _ensembles(
    cell: CurveCell, scene: Scene, said: Sequence[Answers], rows: Mapping[int, Sequence[int]]
) -> dict[int, tuple[LearnedAlignment, ...]]:
    """An ensemble for each of some runs, from the answers so far, all learned in one fit."""
    learned, size = cell.learned.cell, cell.preset.curves.ensemble
    drawn = [
        sample
        for run, asked in rows.items()
        for sample in bootstrap(
            said[run][np.array(asked)],
            size,
            generator(learned.seed, learned.task, Stream.ENSEMBLES, run, len(asked)),
        )
    ]
    config = FitConfig(steps=cell.preset.curves.ensemble_steps)
    alignments = scene.learn(drawn, config, [*range(size)] * len(rows)).alignments
    return {run: alignments[size * place : size * (place + 1)] for place, run in enumerate(rows)}


def _errors(
    cell: CurveCell,
    scene: Scene,
    said: Sequence[Answers],
    asked: Sequence[Sequence[int]],
    counts: Sequence[int],
) -> FloatArray:
    """Relative errors (R,) of what each run learns from its first answers, ``counts`` of them."""
    config = FitConfig(steps=cell.preset.steps)
    errors = np.empty(len(said))
    for count in sorted(set(counts)):
        runs = [run for run, own in enumerate(counts) if own == count]
        answers = [said[run][np.array(asked[run][:count])] for run in runs]
        errors[runs] = scene.errors(scene.learn(answers, config, runs).alignments)
    return errors
