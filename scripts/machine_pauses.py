"""How long this computer keeps a program of real-time priority from running, on each of its cores.

A process on each core wakes up 100 times a second, above everything else. Where those on all cores are late
at the same moment, the whole computer stood still, as a virtual machine does while its host runs others. Run
it next to a drive: a command lasts 25 ms, or 50 ms on the page, and a longer pause stops the arm. Times are
of the monotonic clock. For example:

    python scripts/machine_pauses.py --minutes 10
"""

import argparse
import json
import multiprocessing
import os
import time
from typing import Final

PERIOD_S: Final = 0.01
PRIORITY: Final = 60
LATE_S: Final = 0.02
TOGETHER_S: Final = 0.05


def late_wakings(core: int, until_s: float) -> list[tuple[float, float]]:
    """When this core woke us up too late, s of the monotonic clock, and by how much, s."""
    os.sched_setaffinity(0, {core})
    os.sched_setscheduler(0, os.SCHED_FIFO, os.sched_param(PRIORITY))
    late: list[tuple[float, float]] = []
    due_s = time.monotonic()
    while due_s < until_s:
        due_s += PERIOD_S
        time.sleep(max(0.0, due_s - time.monotonic()))
        behind_s = time.monotonic() - due_s
        if behind_s > LATE_S:
            late.append((due_s, behind_s))
            due_s += behind_s
    return late


def main() -> None:
    """Watch, and print the pauses as JSON."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--minutes", type=float, default=10.0)
    minutes: float = parser.parse_args().minutes
    cores = sorted(os.sched_getaffinity(0))
    began_s = time.monotonic()
    with multiprocessing.get_context("fork").Pool(len(cores)) as pool:
        found = pool.starmap(late_wakings, [(core, began_s + 60.0 * minutes) for core in cores])
    together = [
        (at_s, late_s)
        for at_s, late_s in found[0]
        if all(any(abs(at_s - other_s) < TOGETHER_S for other_s, _ in others) for others in found[1:])
    ]
    figures = {
        "minutes": minutes,
        "pauses_of_each_core": {core: len(late) for core, late in zip(cores, found, strict=True)},
        "pauses_of_all_cores": [
            {"at_s": round(at_s, 2), "ms": round(1e3 * late_s, 1)} for at_s, late_s in together
        ],
    }
    print(json.dumps(figures, indent=2))


if __name__ == "__main__":
    main()
