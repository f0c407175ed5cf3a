"""How large the comparison is."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, field
from enum import IntEnum
from typing import Final

from latentarm.core.errors import UserError
from latentarm.models.catalogue import KINDS
from latentarm.runs.checks import check_count

OURS: Final = "homogeneous"  # the model that is driven by default
REFERENCE: Final = "cae"  # the paper's model
BESIDE: Final = "cvae"  # the model of the paper's user studies, which is driven as well as ours
MOST_NOISES: Final = 6  # that markers of figures tell apart

CHOSEN_ON: Final = "pour_coffee"
"""Ending of the name of the recording that hyper-parameters were chosen on; frozen for the others."""


@dataclass(frozen=True)
class Preset:
    """Sizes of the comparison."""

    name: str  # what it is called on the command line
    # names in the catalogue of models; by default all that load
    models: tuple[str, ...] = field(default_factory=lambda: tuple(KINDS.usable()))
    noises_rad: tuple[float, ...] = (0.01, 0.1)  # SDs of the noise on the states, rad
    folds: int = 5  # parts of each dataset; each is held out once
    seeds: int = 5  # models of each kind in each fold
    epochs: int | None = None  # passes over the training pairs, at most; the model's own number where None
    batch_size: int = 128  # pairs per step: faster for every model than its own, and no worse
    hidden: tuple[int, ...] = (64, 64)  # units of each hidden layer, for every model
    searched_pairs: int = 500  # held-out pairs per fold, spread evenly, whose nearest inputs are searched for
    reach_pairs: int = 40  # pairs of start and goal per fold for the greedy operator
    turned_states: int = 100  # states in which the stick is led around
    # numbers of training demonstrations for the curves with fewer, each below what a fold leaves; that one is
    # added
    demonstrations: tuple[int, ...] = (3, 6)
    # folds whose held-out episodes are driven, and how many of each; None drives all
    drives: int | None = None
    drive_limit_s: float = 300.0  # a drive that lasts longer has failed, s
    ours: str = OURS  # the model that is driven

    def __post_init__(self) -> None:
        for name in (*self.models, self.ours):
            if name not in KINDS:
                raise UserError(f"There is no model {name!r}: choose from {', '.join(KINDS)}.")
        for noise_rad in self.noises_rad:
            if not (math.isfinite(noise_rad) and noise_rad >= 0):
                raise UserError(f"The noise is {noise_rad:g} rad; it must be a finite number, zero or more.")
        if len(self.noises_rad) > MOST_NOISES:
            raise UserError(f"Name at most {MOST_NOISES} noises.")
        check_each_once("models", self.models)
        check_each_once("noises", self.noises_rad)
        check_count("seeds", self.seeds)
        check_count("pairs for reaching", self.reach_pairs)
        if self.folds < 2:
            raise UserError(f"The number of folds is {self.folds}: it must be at least 2.")

    @property
    def given_fewer(self) -> list[str]:
        """The models that also learn from fewer demonstrations."""
        return [name for name in dict.fromkeys((self.ours, REFERENCE, BESIDE)) if name in self.models]


def check_each_once(what: str, given: Sequence[object]) -> None:
    """Raise a `UserError` unless there is at least one, and none twice."""
    if not given or len(set(given)) < len(given):
        raise UserError(f"Name at least one of the {what}, and none twice.")


PRESETS: Final[dict[str, Preset]] = {
    "paper": Preset("paper"),
    "smoke": Preset(
        "smoke",
        models=(REFERENCE, OURS),
        noises_rad=(0.01,),
        folds=2,
        seeds=1,
        epochs=3,
        searched_pairs=100,
        reach_pairs=4,
        turned_states=10,
        demonstrations=(1,),
        drives=1,
        drive_limit_s=10.0,
    ),
}


class Stream(IntEnum):
    """Streams of randomness: one per use, the same for every model and noise."""

    FOLDS = 0
    NETWORKS = 1
    TRAINING_NOISE = 2
    TEST_NOISE = 3
    DRIVES = 4
