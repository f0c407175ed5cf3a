"""The share of simulated people's answers from which directions are learned, by the rule that keeps them.

The motions are those of demonstrations at the table, the decoder is their principal components, and the
present directions are z = u. Some people answer by the present directions or by others, with noise whose
coefficient of variation is `VARIATION`; some answer without a look at the motions.
"""

from collections import Counter
from functools import cache, partial
from typing import Final

import numpy as np

from latentarm.alignment.answers import Answers
from latentarm.alignment.contract import identity
from latentarm.alignment.demonstrated import shown
from latentarm.alignment.judgement import judge
from latentarm.alignment.queries import order_of_questions
from latentarm.core.context import JOINTS
from latentarm.core.types import FloatArray, IntArray
from latentarm.models.pca.training import PCA
from latentarm.runs.questions import AlignmentProblem
from latentarm.tasks.table_top import TableTop
from latentarm_research.measurements.catalogue import JudgedAnswers
from latentarm_research.measurements.measurement import Outcome, Work, line

COUNTS: Final = (6, 10)  # answers
VARIATION: Final = 0.1
BLIND: Final = ("the same", "at random", "buttons at random")
CONSISTENT: Final = ("rotated", "mirrored", "swapped", "rotated, by buttons", "one axis", "as they are")
SWAPPED: Final = np.array([[0.0, 1.0], [1.0, 0.0]])


def measure(options: JudgedAnswers, work: Work) -> Outcome:
    """The outcomes of the answers of every kind of person, in percent of all tries."""
    rows = []
    for count in COUNTS:
        for kind in (*BLIND, *CONSISTENT):
            tries = options.tries if kind in BLIND else options.people
            found = work.each(partial(judged, work.seed, kind, count), range(tries))
            share = {name: 100 * many / tries for name, many in Counter(found).items()}
            figures = {f"{name}_percent": share.get(name, 0.0) for name in ("kept", "agrees", "refused")}
            rows += line("answers", kind, tries, figures, task=f"{count} answers")
    return Outcome(rows)


def judged(seed: int, kind: str, count: int, number: int) -> str:
    """The outcome of one person's answers: ``kept``, ``agrees`` or ``refused``."""
    scene, model = _scene()
    decoder, chain, candidates = scene.decoder, scene.chain, scene.candidates
    motions = candidates[np.array(order_of_questions(chain, candidates, count))]
    rng = np.random.default_rng([seed, count, (*BLIND, *CONSISTENT).index(kind), number])
    meant = model.encode(motions.context, motions.action)[0]
    answers = Answers(motions, np.clip(answer(kind, meant, rng), -1.0, 1.0))
    found = judge(
        answers, lambda some: scene.learn(some).with_arm(decoder, chain), identity, decoder, chain, candidates
    )
    return "kept" if found.refusal is None else "agrees" if found.refusal == "answers_agree" else "refused"


def answer(kind: str, meant: FloatArray, rng: np.random.Generator) -> FloatArray:
    """Inputs (N, 2) of a kind of person, where ``meant`` (N, 2) would be those of the present directions."""
    angle = rng.uniform(np.pi / 3, 5 * np.pi / 3)
    cos, sin = np.cos(angle), np.sin(angle)
    rotated = meant @ np.array([[cos, sin], [-sin, cos]])
    noise = 1.0 + VARIATION * rng.standard_normal(meant.shape)
    match kind:
        case "the same":
            unsteady = 0.05 * rng.standard_normal(meant.shape)
            return 0.5 * _pushes(np.full(len(meant), rng.integers(4))) + unsteady
        case "at random":
            return rng.uniform(-1.0, 1.0, meant.shape)
        case "buttons at random":
            return _pushes(rng.integers(4, size=len(meant)))
        case "rotated":
            return rotated * noise
        case "mirrored":
            return meant * np.array([[1.0, -1.0], [-1.0, 1.0]])[rng.integers(2)] * noise
        case "swapped":
            return meant @ SWAPPED * noise
        case "rotated, by buttons":
            return _pushes(np.argmax(np.concatenate([rotated, -rotated], axis=1), axis=1))
        case "one axis":
            return rotated * noise * np.array([1.0, 0.0])
        case _:
            return meant * noise


def _pushes(which: IntArray) -> FloatArray:
    """Full pushes (N, 2) of buttons (N,): right, up, left and down."""
    return np.concatenate([np.eye(2), -np.eye(2)])[which]


@cache
def _scene() -> tuple[AlignmentProblem, PCA]:
    task = TableTop()
    demonstrations = task.demonstrate(12, np.random.default_rng(0))
    model = PCA(latent_dim=2).fit(demonstrations)
    motions = shown(demonstrations, (JOINTS,), task.robot.chain, np.random.default_rng(1))
    return AlignmentProblem(model.decoder(), task.robot.chain, motions), model
