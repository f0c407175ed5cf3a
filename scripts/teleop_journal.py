"""What journals tell and cost: times from a fault to rest, and bytes and time for each sample.

    python scripts/teleop_journal.py --samples 30000

writes a journal of so many samples and prints what they cost. The functions here read times from a fault to
rest out of the journal that the control process wrote on its own clock.
On Linux all processes share the clock that `MonotonicClock` reads, so a script's times and these compare.
"""

import argparse
import json
import tempfile
import time
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from latentarm.control.journal import JournalEpisode, read_journal
from latentarm.control.recorder import EpisodeHeader, Recorder
from latentarm.core.types import BoolArray, Command, FloatArray, StepRecord

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


def costs(samples: int, folder: Path) -> dict[str, float]:
    """What one episode costs: a Panda that is steered without help, among three goals, at 100 Hz.

    Returns:
        Bytes on the disk for each sample, at most during the episode and after it, and the time of a commit:
        median, 99th percentile and worst, us.
    """
    rng = np.random.default_rng(0)
    path = folder / "journal.sqlite"
    recorder = Recorder(path)
    recorder.begin_episode(EpisodeHeader("panda", tuple(f"joint{i + 1}" for i in range(7)), 100.0))
    state, largest, times_s = np.zeros(7), 0, np.empty(samples)
    for tick in range(samples):
        velocity = rng.uniform(-0.5, 0.5, 7)
        state = state + 0.01 * velocity
        u = rng.uniform(-1.0, 1.0, 2)
        record = StepRecord(
            time_s=0.01 * tick,
            state=state,
            input=u,
            latent=u,
            action_human=velocity + 1e-9,
            action_assist=np.zeros(7),
            alpha=0.0,
            belief=rng.dirichlet(np.ones(3)),
            mode=0,
            command=Command(velocity, 0.05, None, ("ramp",)),
        )
        began_s = time.perf_counter()
        recorder.record(record)
        times_s[tick] = time.perf_counter() - began_s
        if tick % 100 == 99:
            largest = max(largest, _bytes(path))
    recorder.end_episode()
    recorder.close()
    median, p99, worst = 1e6 * np.percentile(times_s, [50, 99, 100])
    return {
        "samples": samples,
        "bytes_per_sample_while_recording": round(largest / samples, 1),
        "bytes_per_sample_afterwards": round(_bytes(path) / samples, 1),
        "commit_median_us": round(median, 1),
        "commit_p99_us": round(p99, 1),
        "commit_worst_us": round(worst, 1),
    }


def _bytes(path: Path) -> int:
    return sum(file.stat().st_size for file in path.parent.iterdir())


def main() -> None:
    """Print what samples cost, as JSON."""
    parser = argparse.ArgumentParser(description=main.__doc__)
    parser.add_argument("--samples", type=int, default=30_000)
    samples = parser.parse_args().samples
    with tempfile.TemporaryDirectory() as folder:
        print(json.dumps(costs(samples, Path(folder)), indent=1))


if __name__ == "__main__":
    main()
