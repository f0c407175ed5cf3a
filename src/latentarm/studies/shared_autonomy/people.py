"""The simulated people of section 8.2: how rational they are over time, and what they want when."""

from dataclasses import dataclass
from typing import Final

NEAR_OPTIMAL: Final = 1000.0
"""Rationality of people who change their mind, 1/m²: the paper calls them near-optimal."""

DRIVE_S: Final = 12.0
"""How long a drive lasts, s: two to three times as long as a demonstration."""

CHANGING_DRIVE_S: Final = 16.0
"""How long a drive with a change of mind lasts, s: the latest change leaves as much time as it took."""


@dataclass(frozen=True)
class Person:
    """A simulated person, whose rationality is ``beta(t) = beta + beta_per_s t``.

    Attributes:
        label: what they are called in tables.
        beta: rationality at the start, 1/m².
        beta_per_s: how fast it grows, 1/m² per s.
        changes_at_s: until then they want the other cup, s.
        drive_s: how long they drive, s.
    """

    label: str
    beta: float
    beta_per_s: float = 0.0
    changes_at_s: float = 0.0
    drive_s: float = DRIVE_S

    def rationality(self, time_s: float) -> float:
        """beta(t), 1/m²."""
        return self.beta + self.beta_per_s * time_s


def of_fixed_expertise(beta: float) -> Person:
    """Someone who does not change, with a rationality in 1/m²."""
    return Person(f"beta {beta:g}", beta)


def learner(name: str, beta_per_s: float) -> Person:
    """Someone who begins at random and learns, ``beta(t) = m t``."""
    return Person(f"{name} learner", 0.0, beta_per_s=beta_per_s)


def changing(after_s: float) -> Person:
    """Someone near-optimal who drives to the wrong cup first, and after a while to the right one."""
    return Person(f"change after {after_s:g} s", NEAR_OPTIMAL, changes_at_s=after_s, drive_s=CHANGING_DRIVE_S)
