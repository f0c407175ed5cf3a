"""How large the study is, and the simulated people of section 8.2."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Final

NEAR_OPTIMAL: Final = 1000.0
"""Rationality of people who change their mind, 1/m²: the paper calls them near-optimal."""

DRIVE_S: Final = 12.0  # how long a drive lasts, s: two to three times as long as a demonstration

CHANGING_DRIVE_S: Final = 16.0
"""How long a drive with a change of mind lasts, s: the latest change leaves as much time as it took."""


@dataclass(frozen=True)
class Person:
    """A simulated person, whose rationality is ``beta(t) = beta + beta_per_s t``."""

    label: str  # what they are called in tables
    beta: float  # rationality at the start, 1/m²
    beta_per_s: float = 0.0  # how fast it grows, 1/m² per s
    changes_at_s: float = 0.0  # until then they want the other cup, s
    drive_s: float = DRIVE_S  # how long they drive, s

    def rationality(self, time_s: float) -> float:
        """beta(t), 1/m²."""
        return self.beta + self.beta_per_s * time_s


def of_fixed_expertise(beta: float) -> Person:
    """Someone who does not change, with a rationality in 1/m²."""
    return Person(f"beta {beta:g}", beta)


def learner(name: str, beta_per_s: float) -> Person:
    """Someone who begins at random and learns, ``beta(t) = m t``."""
    return Person(f"{name} learner", 0.0, beta_per_s=beta_per_s)


def of_slope(beta_per_s: float) -> Person:
    """A learner whom only the sweep of the slope m knows."""
    return learner(f"m = {beta_per_s:g}", beta_per_s)


def changing(after_s: float) -> Person:
    """Someone near-optimal who drives to the wrong cup first, and after a while to the right one."""
    return Person(f"change after {after_s:g} s", NEAR_OPTIMAL, changes_at_s=after_s, drive_s=CHANGING_DRIVE_S)


@dataclass(frozen=True)
class Preset:
    """Sizes of the study."""

    name: str  # what it is called on the command line
    demonstrations: int = 60  # to train on; a fifth of them is for validation and decides which epoch is best
    seeds: int = 10  # models of each kind
    drives: int = 24  # drives with each of them and each person, half of them to each cup
    epochs: int = 60  # passes over the training pairs, at most
    batch_size: int = 100  # pairs per step
    hidden: tuple[int, ...] = (64, 64)  # units of each hidden layer
    # SD of the noise on training states, rad. Help leaves the arm within about this much of a cup, and there
    # the decoder has to do what was demonstrated at the cup
    state_noise_rad: float = 0.05
    kl_weight: float = 0.05  # lambda_1 of equation 16, for the cVAE
    entropy_weight: float = 3.0  # lambda_2 of equation 16
    sharpness: float = 8.0  # kappa of the entropy over goals, see `GoalEntropy`
    # rationalities of people of fixed expertise, 1/m²; the first and the last are the extremes
    betas: tuple[float, ...] = (0.0, 10.0, 30.0, 75.0, 1000.0, 10000.0)
    # how fast people learn, 1/m² per s, by name: the slowest and the fastest slope of a sweep at which help
    # with entropy and without it separated in development (planar arm, cAE, two models of 30 demonstrations)
    learners: Mapping[str, float] = field(default_factory=lambda: {"slow": 2.5, "fast": 25.0})
    slopes: tuple[float, ...] = (0.5, 8.0, 80.0, 250.0)  # of further learners, for the sweep, 1/m² per s
    changes_s: tuple[float, ...] = (0.0, 2.0, 4.0, 8.0)  # after how long people change their mind, s

    @property
    def people(self) -> tuple[Person, ...]:
        """Everyone who drives."""
        return (
            *(of_fixed_expertise(beta) for beta in self.betas),
            *(learner(name, slope) for name, slope in self.learners.items()),
            *(of_slope(slope) for slope in self.slopes),
            *(changing(after_s) for after_s in self.changes_s),
        )

    @property
    def by_slope(self) -> dict[float, Person]:
        """Everyone who learns, from the slowest to the fastest."""
        known = {slope: learner(name, slope) for name, slope in self.learners.items()}
        return dict(sorted((known | {slope: of_slope(slope) for slope in self.slopes}).items()))

    @property
    def latest_change(self) -> Person:
        """The person who changes their mind last."""
        return changing(max(self.changes_s))

    @property
    def drawn_changes_s(self) -> tuple[float, ...]:
        """After how long those change their mind whose course is drawn: an early change and the latest, s."""
        times = sorted(self.changes_s)
        return tuple(dict.fromkeys((times[max(len(times) // 2 - 1, 0)], times[-1])))


PRESETS: Final[dict[str, Preset]] = {
    "paper": Preset("paper"),
    "smoke": Preset(
        "smoke",
        demonstrations=12,
        seeds=2,
        drives=8,
        epochs=8,
        betas=(0.0, 75.0, 10000.0),
        slopes=(),
        changes_s=(2.0, 8.0),
    ),
}
