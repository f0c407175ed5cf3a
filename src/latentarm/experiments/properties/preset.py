"""How large the study is: as in the paper, or small enough to try."""

from dataclasses import dataclass
from typing import Final


@dataclass(frozen=True)
class Preset:
    """Sizes of the study of section 8.1.

    Attributes:
        name: what the user calls it.
        episodes: demonstrations to learn from, each of 100 state-action pairs; a fifth of them says which
            epoch was best. The paper has 10000 pairs.
        test_episodes: further demonstrations to measure on.
        seeds: models of each kind.
        epochs: passes over the training pairs.
        batch_size: pairs per step of the training.
        hidden: units of each hidden layer, of encoder and decoder.
        kl_weight: lambda of equations 7 and 8 for the variational models; the paper says only that it is
            below 1.
        reach_pairs: start-goal pairs for controllability.
        reach_goals: goals in the region of the reach task.
        states: states for consistency, scalability and angles.
        grid: values of z in [-1, 1] at each of these states.
        noises_rad: SDs of the noise on states; the first, 0, is the study as the paper has it.
    """

    name: str
    episodes: int = 100
    test_episodes: int = 20
    seeds: int = 10
    epochs: int = 80
    batch_size: int = 128
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
        episodes=10,
        test_episodes=4,
        seeds=2,
        epochs=4,
        hidden=(16, 16),
        reach_pairs=20,
        reach_goals=10,
    ),
}
