"""How long arms take to come to rest after a fault in motion.

Each arm of the catalogue is driven at 100 Hz by its tool, with a full stick in a random direction, in
simulated time. Then something happens (`latentarm.testing.fault_trials`), from which all times count. 0.6 s
later the fault is repaired, and for another 0.3 s the stick is still pushed: the arm must not move before the
person lets go and enables it. Stop is also pressed while readings are 1 to 5 ticks late.

    python scripts/arm_faults.py --tries 20
"""

import argparse
import json
from dataclasses import dataclass
from typing import Final

import numpy as np
from rich.console import Console
from rich.table import Table

from latentarm.arms.catalogue import ARMS
from latentarm.robots.panda import panda
from latentarm.testing.fault_trials import FAULTS, PERIOD_S, Fault, Trial, try_fault

LATE_TICKS: Final = (0, 1, 2, 3, 4, 5)


@dataclass(frozen=True)
class Row:
    """One fault of one arm.

    Attributes:
        arm: its name in the catalogue.
        fault: what happened, in words.
        trials: each try.
    """

    arm: str
    fault: str
    trials: list[Trial]

    def figures(self) -> dict[str, str | int | float]:
        """What the table shows: times are median / worst, ms."""
        zero = _times_ms([one.zero_command_s for one in self.trials])
        rest = _times_ms([one.rest_s for one in self.trials])
        return {
            "arm": self.arm,
            "fault": self.fault,
            "tries": len(self.trials),
            "zero_command_ms": zero,
            "rest_ms": rest,
            "moved_before_enabled_rad": max(one.moved_rad for one in self.trials),
            "moved_once_enabled": sum(one.moves_again for one in self.trials),
        }


def _times_ms(times_s: list[float]) -> str:
    return f"{1000.0 * np.median(times_s):.0f} / {1000.0 * max(times_s):.0f}"


def _ticks(count: int) -> str:
    return "1 tick" if count == 1 else f"{count} ticks"


def rows(arm: str, tries: int) -> list[Row]:
    """All faults of one arm."""

    def tried(fault: Fault, late_ticks: int = 0) -> list[Trial]:
        late_s = PERIOD_S * late_ticks
        return [try_fault(ARMS[arm], panda(), fault, seed, late_s) for seed in range(tries)]

    stops = [
        Row(arm, f"{FAULTS['stop_pressed']}, readings {_ticks(late)} late", tried("stop_pressed", late))
        for late in LATE_TICKS
    ]
    return [*stops, *(Row(arm, said, tried(name)) for name, said in FAULTS.items() if name != "stop_pressed")]


def main() -> None:
    """Try them all, and print a table or JSON."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--arms", nargs="+", default=list(ARMS), choices=list(ARMS))
    parser.add_argument("--tries", type=int, default=20)
    parser.add_argument("--json", action="store_true")
    config = parser.parse_args()
    found = [row.figures() for arm in config.arms for row in rows(arm, config.tries)]
    if config.json:
        print(json.dumps(found, indent=1))
        return
    table = Table("arm", "fault", "zero command (ms)", "rest (ms)", "moved too early (rad)", "moves again")
    for row in found:
        table.add_row(
            *(str(row[key]) for key in ("arm", "fault", "zero_command_ms", "rest_ms")),
            f"{row['moved_before_enabled_rad']:.0e}",
            f"{row['moved_once_enabled']} of {row['tries']}",
        )
    Console(width=140).print(table, "median / worst")


if __name__ == "__main__":
    main()
