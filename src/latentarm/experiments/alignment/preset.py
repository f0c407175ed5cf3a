"""How large the study is."""

from dataclasses import dataclass, field
from typing import Final


@dataclass(frozen=True)
class Curves:
    """How error falls with the number of answers.

    Attributes:
        models: whose decoders.
        noises: coefficients of variation of the answers.
        answers: numbers of answers at which the error is taken, rising.
        at_random: first questions, before there is enough to disagree about.
        ensemble: alignments that disagree.
        ensemble_steps: of Adam, for each ensemble.
        candidates: motions that may be asked about.
    """

    models: tuple[str, ...] = ("cae", "isometric")
    noises: tuple[float, ...] = (0.0, 0.1)
    answers: tuple[int, ...] = (1, 2, 3, 4, 5, 6, 8, 10, 15, 20, 30)
    at_random: int = 3
    ensemble: int = 5
    ensemble_steps: int = 150
    candidates: int = 100


@dataclass(frozen=True)
class Preset:
    """Sizes of the study; where the paper gives a number, this is it.

    Attributes:
        name: what it is called on the command line.
        episodes: demonstrations that train the decoder and that questions are about; a fifth of them is not
            fitted to and says which epoch was best.
        test_episodes: further ones, that alignments are judged on.
        epochs: passes over the training pairs, at most.
        batch_size: pairs per step.
        hidden: units of each hidden layer of the decoder.
        state_noise_rad: SD of the noise on training states, rad.
        noises: coefficients of variation of the answers.
        answers: that each alignment is learned from; 10 in the paper.
        ideal_answers: of Ideal Align; 1000 in the paper.
        unlabelled: contexts in which the priors shall hold; 1000 in the paper.
        test_motions: held-out motions that the error is averaged over.
        runs: alignments of each kind, each with answers of its own; 10 in the paper.
        steps: of Adam, for each alignment.
        ideal_steps: the same for Ideal Align.
        curves: how error falls with the number of answers.
        drives: drives for each goal and condition.
        drive_models: models that are driven with.
    """

    name: str
    episodes: int = 40
    test_episodes: int = 10
    epochs: int = 200
    batch_size: int = 64
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
    drives: int = 20
    drive_models: int = 3


PRESETS: Final[dict[str, Preset]] = {
    "paper": Preset("paper"),
    "smoke": Preset(
        "smoke",
        episodes=8,
        test_episodes=3,
        epochs=20,
        noises=(0.0, 0.5),
        ideal_answers=200,
        test_motions=100,
        runs=3,
        steps=100,
        ideal_steps=200,
        curves=Curves(models=("cae",), noises=(0.0,), answers=(1, 3, 5), ensemble_steps=40, candidates=30),
        drives=1,
        drive_models=1,
    ),
}
