"""Measure how long arms take to come to rest after a fault in motion.

Each arm is driven at 100 Hz by its tool, with a full stick in a random direction, in simulated time. Then
something happens (`latentarm.testing.fault_trials`), from which all times count. 0.6 s later the fault is
repaired, and for another 0.3 s the stick is still pushed: the arm must not move before the person lets go and
enables it. Stop is also pressed while readings are 1 to 5 ticks late.
"""

from functools import partial
from typing import Final

import numpy as np

from latentarm.arms.catalogue import ARMS
from latentarm.core.errors import UserError
from latentarm.robots.panda import panda
from latentarm.testing.fault_trials import FAULTS, PERIOD_S, Fault, FaultTrial, try_fault
from latentarm_research.measurements.catalogue import Stops
from latentarm_research.measurements.measurement import Outcome, Work, line

LIMITS_MS: Final = {"zero_command_worst_ms": 150.0, "rest_worst_ms": 400.0}
MOVED_RAD: Final = 1e-11
LATE_TICKS: Final = range(6)


def measure(options: Stops, work: Work) -> Outcome:
    """Times from each fault to the last command and to rest; whether the arm moves before it is enabled."""
    rows, broken = [], list[str]()
    faults: list[tuple[str, Fault, int]] = [
        *((f"{FAULTS['stop_pressed']}, {late} ticks late", "stop_pressed", late) for late in LATE_TICKS),
        *((words, fault, 0) for fault, words in FAULTS.items() if fault != "stop_pressed"),
    ]
    for arm in options.arms:
        if arm not in ARMS:
            raise UserError(f"There is no simulated arm {arm!r}: choose from {', '.join(ARMS)}.")
        for words, fault, late in faults:
            trials = work.each(partial(tried, arm, fault, PERIOD_S * late), range(options.tries))
            zero, rest = (1000.0 * np.array([[one.zero_command_s, one.rest_s] for one in trials])).T
            figures = {
                "zero_command_median_ms": np.median(zero),
                "zero_command_worst_ms": zero.max(),
                "rest_median_ms": np.median(rest),
                "rest_worst_ms": rest.max(),
                "moved_before_enabled_rad": max(one.moved_rad for one in trials),
                "moves_once_enabled": sum(one.moves_again for one in trials),
            }
            rows += line("stops", words, len(trials), figures, arm)
            past = [f"{name} is above {most:g}" for name, most in LIMITS_MS.items() if figures[name] > most]
            past += ["moved before it was enabled"] * bool(figures["moved_before_enabled_rad"] > MOVED_RAD)
            past += ["does not move again"] * bool(figures["moves_once_enabled"] < len(trials))
            broken += [f"{arm}, {words}: {one}" for one in past]
    return Outcome(rows, broken)


def tried(arm: str, fault: Fault, late_s: float, seed: int) -> FaultTrial:
    """One fault of one arm of the catalogue."""
    return try_fault(ARMS[arm], panda(), fault, seed, late_s)
