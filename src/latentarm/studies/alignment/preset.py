"""How large the study is, which ways of alignment it compares, and its streams of randomness."""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from enum import IntEnum
from typing import Final

from latentarm.alignment.priors import NO_PRIORS, Priors
from latentarm.alignment.queries import ENSEMBLE
from latentarm.alignment.training import QUICK


@dataclass(frozen=True)
class Curves:
    """Sizes of the learning curves.

    Attributes:
        models: whose decoders.
        noises: coefficients of variation of the answers.
        answers: numbers of answers at which the error is taken, rising.
        candidates: motions that may be asked about.
        ensemble: alignments whose disagreement is looked at.
        ensemble_steps: of Adam, for each ensemble.
        disagreement_up_to: answers up to which questions are also chosen by disagreement.
    """

    models: tuple[str, ...] = ("cae",)
    noises: tuple[float, ...] = (0.0,)
    answers: tuple[int, ...] = (1, 2, 3, 4, 5, 6, 8, 10, 15, 20, 30)
    candidates: int = 100
    ensemble: int = ENSEMBLE
    ensemble_steps: int = QUICK.steps
    disagreement_up_to: int = 10


@dataclass(frozen=True)
class Drives:
    """Drives to the goals of the demo's table by a simulated person with their own expectation.

    Attributes:
        models: kinds that are driven with.
        seeds: models of each kind, used in turn.
        episodes: demonstrations, of which a fifth trains no model: alignments are judged on it.
        epochs: passes over the training pairs, at most.
        answers: that an alignment is learned from, asked for as `latentarm align` does.
        to_each_goal: drives to each goal, in each condition.
        limit_s: a drive that lasts longer has failed, s.
    """

    models: tuple[str, ...] = ("cvae", "isometric")
    seeds: int = 3
    episodes: int = 60
    epochs: int = 16
    answers: int = 10
    to_each_goal: int = 20
    limit_s: float = 30.0


@dataclass(frozen=True)
class Preset:
    """Sizes of the study; where the paper gives a number, this is it.

    Attributes:
        name: what it is called on the command line.
        episodes: demonstrations that train the decoder and that questions are about; a fifth of them is for
            validation and decides which epoch is best.
        test_episodes: further ones, that alignments are judged on.
        epochs: passes over the training pairs, at most.
        batch_size: pairs per step.
        hidden: units of each hidden layer of the decoder.
        state_noise_rad: SD of the noise on training states, rad.
        noises: coefficients of variation of the answers.
        answers: that each alignment is learned from; 10 in the paper.
        ideal_answers: of Ideal Align; 1000 in the paper.
        unlabelled: contexts in which the priors are to hold; 1000 in the paper.
        test_motions: held-out motions that the error is averaged over.
        runs: alignments of each kind, each with different answers; 10 in the paper.
        steps: of Adam, for each alignment.
        ideal_steps: the same for Ideal Align.
        curves: how error falls with the number of answers.
        drives: drives to the goals of the demo.
    """

    name: str
    episodes: int = 40
    test_episodes: int = 10
    epochs: int = 60
    batch_size: int = 256
    hidden: tuple[int, ...] = (64, 64)
    state_noise_rad: float = 0.01
    noises: tuple[float, ...] = (0.0, 0.1, 0.5)
    answers: int = 10
    ideal_answers: int = 1000
    unlabelled: int = 1000
    test_motions: int = 500
    runs: int = 10
    steps: int = 400
    ideal_steps: int = 1500
    curves: Curves = field(default_factory=Curves)
    drives: Drives = field(default_factory=Drives)


PRESETS: Final[dict[str, Preset]] = {
    "paper": Preset("paper"),
    "smoke": Preset(
        "smoke",
        episodes=6,
        test_episodes=3,
        epochs=6,
        noises=(0.0, 0.5),
        ideal_answers=200,
        unlabelled=300,
        test_motions=100,
        runs=3,
        steps=25,
        ideal_steps=60,
        curves=Curves(
            noises=(0.0,), answers=(1, 3, 5), candidates=30, ensemble_steps=20, disagreement_up_to=5
        ),
        drives=Drives(
            models=("cvae",), seeds=1, episodes=12, epochs=2, answers=4, to_each_goal=1, limit_s=3.0
        ),
    ),
}


class Stream(IntEnum):
    """The uses of randomness."""

    TRAINING = 0
    TEST = 1
    NETWORKS = 2
    STATE_NOISE = 3
    SHOWN = 4
    TEST_MOTIONS = 5
    UNLABELLED = 6
    QUESTIONS = 7
    ANSWERS = 8
    CANDIDATES = 9
    CANDIDATE_ANSWERS = 10
    ENSEMBLES = 11


NO_ALIGN: Final = "No Align"
MANUAL: Final = "Manual Align"
WITHOUT_PRIORS: Final = "No Priors"
ALL_PRIORS: Final = "All Priors"
IDEAL: Final = "Ideal Align"

SINGLE_PRIORS: Final[Mapping[str, Priors]] = {
    "Proportional": replace(NO_PRIORS, proportional=Priors().proportional),
    "Reversible": replace(NO_PRIORS, reversible=Priors().reversible),
    "Consistent": replace(NO_PRIORS, consistent=Priors().consistent),
}
"""One prior at a time, with its weight from All Priors."""

LEARNED: Final[Mapping[str, Priors]] = {WITHOUT_PRIORS: NO_PRIORS, **SINGLE_PRIORS, ALL_PRIORS: Priors()}
"""Networks that are learned from a few answers, and the priors of each, as in `latentarm align`."""

FEW_ANSWERS: Final = (MANUAL, *LEARNED)
"""The conditions that get the same few answers."""

CONDITIONS: Final = (NO_ALIGN, *FEW_ANSWERS, IDEAL)
"""All conditions, in the order of tables and figures."""


def under(condition: str, noise: float) -> str:
    """How rows name a condition under a noise."""
    return f"{condition}, noise {noise:g}"
