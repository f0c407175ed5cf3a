"""How large the study is, what is driven with, and its streams of randomness."""

from collections.abc import Mapping
from dataclasses import dataclass
from enum import IntEnum
from typing import Final, final

from latentarm.operators.catalogue import OperatorName

CONTEXTS: Final[Mapping[str, tuple[str, ...]]] = {
    "joints": ("joints",),
    "joints objects": ("joints", "objects"),
}
"""What a decoder may see, by the name of the condition; the model's parameter ``context`` for each."""


@final
@dataclass(frozen=True)
class Preset:
    """Sizes of the study.

    Attributes:
        name: what it is called on the command line.
        runs: of each task, by the scripted demonstrator and in every condition.
        demonstrations: further runs of the demonstrator, those that succeed train the models; a fifth of them
            is for validation and decides which epoch is best.
        models: kinds that are driven with.
        context: what their decoders see, a name of `CONTEXTS`.
        moved_contexts: the same, side by side, where things were moved.
        seeds: models of each kind, used in turn, so that no figure depends on one of them.
        epochs: passes over the training pairs, at most.
        batch_size: pairs per step.
        hidden: units of each hidden layer.
        state_noise_rad: SD of the noise on training states, rad.
        person: who drives.
        block: runs that one cell of the grid takes.
    """

    name: str
    runs: int = 50
    demonstrations: int = 60
    models: tuple[str, ...] = ("cvae", "homogeneous")
    context: str = "joints objects"
    moved_contexts: tuple[str, ...] = ("joints", "joints objects")
    seeds: int = 3
    epochs: int = 60
    batch_size: int = 256
    hidden: tuple[int, ...] = (64, 64)
    state_noise_rad: float = 0.01
    person: OperatorName = "planning"
    block: int = 5


PRESETS: Final[dict[str, Preset]] = {
    "paper": Preset("paper"),
    "smoke": Preset("smoke", runs=2, demonstrations=6, seeds=1, epochs=6, block=1),
}


class Stream(IntEnum):
    """The uses of randomness."""

    RUNS = 0
    DEMONSTRATIONS = 1
    NETWORKS = 2
