"""How large the study is, which ways of alignment it compares, and its streams of randomness."""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from enum import IntEnum
from typing import Final

from latentarm_research.alignment.priors import NO_PRIORS, Priors

PAPER_MODEL: Final = "cae"  # the model of the paper's study


@dataclass(frozen=True)
class Curves:
    """Sizes of the learning curves."""

    noises: tuple[float, ...] = (0.0, 0.5)  # coefficients of variation of the answers
    answers: tuple[int, ...] = (1, 2, 3, 4, 6, 10)  # numbers of answers at which the error is taken, rising
    candidates: int = 100  # motions that may be asked about


@dataclass(frozen=True)
class Preset:
    """Sizes of the study; where the paper gives a number, this is it."""

    name: str  # what it is called on the command line
    # demonstrations that train the decoder and that questions are about; a fifth of them is for validation
    # and decides which epoch is best
    episodes: int = 40
    test_episodes: int = 10  # further ones, that alignments are judged on
    epochs: int = 60  # passes over the training pairs, at most
    batch_size: int = 256  # pairs per step
    hidden: tuple[int, ...] = (64, 64)  # units of each hidden layer of the decoder
    state_noise_rad: float = 0.01  # SD of the noise on training states, rad
    noises: tuple[float, ...] = (0.0, 0.1, 0.5)  # coefficients of variation of the answers
    answers: int = 10  # that each alignment is learned from; 10 in the paper
    ideal_answers: int = 1000  # of Ideal Align; 1000 in the paper
    unlabelled: int = 1000  # contexts in which the priors are to hold; 1000 in the paper
    test_motions: int = 500  # held-out motions that the error is averaged over
    runs: int = 10  # alignments of each kind, each with different answers; 10 in the paper
    steps: int = 400  # of Adam, for each alignment
    ideal_runs: int = 3  # alignments of Ideal Align, which hardly differ
    ideal_steps: int = 10_000  # of Adam, for each of them
    ideal_held_out: float = 0.1  # share of its answers that decide which weights are kept
    surroundings: int = 1000  # demonstrated motions that say which directions a place has
    curves: Curves = field(default_factory=Curves)  # how error falls with the number of answers


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
        ideal_runs=2,
        surroundings=300,
        curves=Curves(noises=(0.0,), answers=(1, 2, 4), candidates=30),
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
    SURROUNDINGS = 14


NO_ALIGN: Final = "No Align"
MANUAL: Final = "Manual Align"
WITHOUT_PRIORS: Final = "No Priors"
ALL_PRIORS: Final = "All Priors"
IDEAL: Final = "Ideal Align"
TOOL_SPACE: Final = "Tool Space"  # what `latentarm align` learns, from motions drawn at random
CHOSEN: Final = f"{TOOL_SPACE}, chosen"  # the same from motions that it chooses: what `latentarm align` does

SINGLE_PRIORS: Final[Mapping[str, Priors]] = {
    "Proportional": replace(NO_PRIORS, proportional=Priors().proportional),
    "Reversible": replace(NO_PRIORS, reversible=Priors().reversible),
    "Consistent": replace(NO_PRIORS, consistent=Priors().consistent),
}
"""One prior at a time, with its weight from All Priors."""

LEARNED: Final[Mapping[str, Priors]] = {WITHOUT_PRIORS: NO_PRIORS, **SINGLE_PRIORS, ALL_PRIORS: Priors()}
"""Networks that are learned from a few answers, and the priors of each."""

FEW_ANSWERS: Final = (MANUAL, *LEARNED, TOOL_SPACE)  # the conditions that get the same few answers

CONDITIONS: Final = (NO_ALIGN, *FEW_ANSWERS, CHOSEN, IDEAL)
"""All conditions, in the order of tables and figures."""


def under(condition: str, noise: float) -> str:
    """How rows name a condition under a noise."""
    return f"{condition}, noise {noise:g}"
