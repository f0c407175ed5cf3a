"""Times from a fault to rest, read from the journal that the control process wrote on its own clock.

On Linux all processes share the clock that `MonotonicClock` reads, so a script's times and these compare.
"""

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from latentarm.control.journal import JournalEpisode, read_journal
from latentarm.core.types import BoolArray, FloatArray

STILL_RAD_S = 0.01


@dataclass(frozen=True)
class Halt:
    """How long after a fault, s.

    Attributes:
        zero_s: until the first command of zero velocity after which there was no other.
        rest_s: until the arm was below 0.01 rad/s for good, by the positions that it reported.
    """

    zero_s: float
    rest_s: float


def halts(journal: Path, faults_s: list[float]) -> list[Halt | None]:
    """One for each fault, in the order of the episodes; None where the arm had stopped before it."""
    episodes = read_journal(journal)
    return [halt(episode, fault_s) for episode, fault_s in zip(episodes, faults_s, strict=True)]


def halt(episode: JournalEpisode, fault_s: float) -> Halt | None:
    """See `Halt`; None where the arm had stopped before the fault.

    Raises:
        RuntimeError: the arm had not stopped when the episode ended.
    """
    times = np.array([record.time_s for record in episode.records])
    commands = np.array([np.abs(record.command.velocity).max() for record in episode.records])
    moves = np.abs(np.diff([record.state for record in episode.records], axis=0)).max(axis=1)
    # From each sample to the next; after the last one the arm does what it was told last.
    speeds = np.append(moves / np.diff(times), commands[-1])
    if commands[times <= fault_s][-1] < STILL_RAD_S:
        return None
    if commands[-1] > 0.0:
        raise RuntimeError(f"the arm never stopped after the fault in the episode {episode.header.task!r}")
    return Halt(
        first_after(times, commands > 0.0) - fault_s, first_after(times, speeds > STILL_RAD_S) - fault_s
    )


def first_after(times: FloatArray, moving: BoolArray) -> float:
    """When the first sample after the last that moved was taken, s."""
    return float(times[np.flatnonzero(moving)[-1] + 1])


def spread(times_s: list[float]) -> dict[str, float]:
    """Median, p95 and worst, ms."""
    shares = {"median_ms": 50, "p95_ms": 95, "worst_ms": 100}
    figures = {
        name: round(1000.0 * float(np.percentile(times_s, share)), 1) for name, share in shares.items()
    }
    return {"n": len(times_s), **figures}
