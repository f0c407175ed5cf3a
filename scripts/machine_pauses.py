"""How long this computer keeps a program of real-time priority from running, on each of its cores.

A process on each core wakes up 100 times a second, above everything else, and does nothing. Where even that
one is late, the core stood still: a virtual machine's does while its host runs others. Run it next to a
drive. The loop's last command lasts 25 ms, or 50 ms on the page, and the next is due after 10 ms, so a core
that stands still for longer than 15 ms, or 40 ms, can stop the arm. Times are of the monotonic clock. For
example:

    python scripts/machine_pauses.py --minutes 10
"""

import argparse
import json
import multiprocessing
import os
import time
from typing import Final

import numpy as np

PERIOD_S: Final = 0.01
PRIORITY: Final = 60
SHARES: Final = (0.5, 0.99, 0.999, 1.0)
"""Quantiles of the lateness that are told."""


def wakings(core: int, until_s: float) -> list[tuple[float, float]]:
    """When this core was to wake us up, s of the monotonic clock, and by how much it was late, s."""
    os.sched_setaffinity(0, {core})
    os.sched_setscheduler(0, os.SCHED_FIFO, os.sched_param(PRIORITY))
    found: list[tuple[float, float]] = []
    due_s = time.monotonic()
    while due_s < until_s:
        due_s += PERIOD_S
        time.sleep(max(0.0, due_s - time.monotonic()))
        behind_s = time.monotonic() - due_s
        found.append((due_s, behind_s))
        if behind_s > PERIOD_S:
            due_s += behind_s
    return found


def main() -> None:
    """Watch, and print the figures as JSON."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--minutes", type=float, default=10.0)
    parser.add_argument("--longer-than", type=float, default=10.0, help="pauses to list, ms")
    chosen = parser.parse_args()
    cores = sorted(os.sched_getaffinity(0))
    until_s = time.monotonic() + 60.0 * chosen.minutes
    with multiprocessing.get_context("fork").Pool(len(cores)) as pool:
        found = dict(zip(cores, pool.starmap(wakings, [(core, until_s) for core in cores]), strict=True))
    figures = {
        "minutes": chosen.minutes,
        "late_ms": {
            core: {
                f"{share:g}": round(1e3 * float(np.quantile([late for _, late in one], share)), 2)
                for share in SHARES
            }
            for core, one in found.items()
        },
        "pauses": [
            {"core": core, "at_s": round(at_s, 2), "ms": round(1e3 * late_s, 1)}
            for core, one in found.items()
            for at_s, late_s in one
            if 1e3 * late_s > chosen.longer_than
        ],
    }
    print(json.dumps(figures, indent=2))


if __name__ == "__main__":
    main()
