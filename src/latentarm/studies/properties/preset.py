"""How large the study is."""

from dataclasses import dataclass, field
from typing import Final

from latentarm.models.catalogue import KINDS

LEFT_OUT: Final = frozenset({"cae_jacobian", "cvae_jacobian", "odd_cae", "flow", "scn", "low_turning"})
"""Variants for recorded demonstrations, which `compare` measures. The study has the paper's models, cAE with
a penalty on rest or on reversal, the models whose speed is controlled, and those of plug-ins."""


def _models() -> tuple[str, ...]:
    return tuple(name for name in KINDS.usable() if name not in LEFT_OUT)


@dataclass(frozen=True)
class Preset:
    """Sizes of the study.

    Attributes:
        name: what it is called on the command line.
        models: names in the catalogue of models; by default all that load but `LEFT_OUT`.
        episodes: demonstrations to train on, of 100 pairs each; the paper trains on 10000 pairs. A fifth of
            them is for validation and decides which epoch is best.
        test_episodes: further demonstrations, that figures are taken on (drives into the goal region have
            separate starts and goals).
        seeds: models of each kind; the paper's figures are over 10.
        epochs: passes over the training pairs, at most.
        batch_size: pairs per step.
        hidden: units of each hidden layer; the paper leaves them open.
        kl_weight: lambda of equations 7 and 8; the paper says below 1.
        reach_pairs: pairs of start and goal states by which controllability is measured; 1000 in the paper.
        reach_goals: goals in the region that reach is driven to.
        states: along the task, from which the effects of a grid of latent actions are measured; 25 in the
            paper.
        grid: latent actions in [-1, 1] at each of them.
        noises_rad: standard deviations of the noise on states, rad; 0 is the paper's setting.
    """

    name: str
    models: tuple[str, ...] = field(default_factory=_models)
    episodes: int = 100
    test_episodes: int = 20
    seeds: int = 10
    epochs: int = 60
    batch_size: int = 100
    hidden: tuple[int, ...] = (64, 64)
    kl_weight: float = 0.001
    reach_pairs: int = 1000
    reach_goals: int = 100
    states: int = 25
    grid: int = 21
    noises_rad: tuple[float, ...] = (0.0, 0.01, 0.1)


PRESETS: Final[dict[str, Preset]] = {
    "paper": Preset("paper"),
    "smoke": Preset(
        "smoke",
        episodes=12,
        test_episodes=4,
        seeds=2,
        epochs=4,
        reach_pairs=20,
        reach_goals=5,
        states=9,
        noises_rad=(0.0, 0.1),
    ),
}
