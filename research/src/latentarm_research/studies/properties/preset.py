"""How large the study is."""

from dataclasses import dataclass, field
from typing import Final

from latentarm.models.catalogue import KINDS

LEFT_OUT: Final = frozenset({"cae_jacobian", "cvae_jacobian", "odd_cae"})
"""Variants for recorded demonstrations, which `compare` measures. The study has the paper's models, cAE with
a penalty on rest or on reversal, the models whose speed is controlled, and those of plug-ins."""


@dataclass(frozen=True)
class Preset:
    """Sizes of the study."""

    name: str  # what it is called on the command line
    # names in the catalogue of models; by default all that load but `LEFT_OUT`
    models: tuple[str, ...] = field(
        default_factory=lambda: tuple(name for name in KINDS.usable() if name not in LEFT_OUT)
    )
    # demonstrations that each model has to itself; with 10 pairs each, the 10000 pairs that the paper trains
    # on. A fifth of them is for validation and decides which epoch is best
    episodes: int = 1000
    test_episodes: int = 200  # further demonstrations, of its own too, that each model's figures are taken on
    seeds: int = 10  # models of each kind; the paper's figures are over 10
    epochs: int = 30  # passes over the training pairs, at most
    batch_size: int = 100  # pairs per step
    hidden: tuple[int, ...] = (64, 64)  # units of each hidden layer; the paper leaves them open
    kl_weight: float = 0.03  # lambda of equations 7 and 8; the paper says below 1
    # pairs of start and goal states by which a model's controllability is measured; over ten models they are
    # the paper's 1000
    reach_pairs: int = 100
    reach_goals: int = 100  # goals in the region that each model of reach is driven to
    # along the task, from which the effects of a grid of latent actions are measured; 25 in the paper
    states: int = 25
    grid: int = 21  # latent actions in [-1, 1] at each of them


PRESETS: Final[dict[str, Preset]] = {
    "paper": Preset("paper"),
    "smoke": Preset(
        "smoke",
        episodes=40,
        test_episodes=10,
        seeds=2,
        epochs=4,
        reach_pairs=10,
        reach_goals=5,
        states=9,
    ),
}
