"""Fit the SIMULATED people to half of the persons of a public study, and predict the other half.

The study is AutonomyFitts (Pan et al., HRI 2025): 24 people steer a Franka arm's tool by a Falcon to targets on
rings, 0.118 or 0.236 m apart and 0.01 or 0.02 m wide. Only trials without autonomy count. Fetch the repository
(https://github.com/mpan31415/AutonomyFitts) yourself; nothing of it is shipped here. For example:

    python scripts/people_from_logs.py AutonomyFitts --out people_from_logs.json
"""

import argparse
import csv
import json
import math
import tempfile
from collections.abc import Iterator, Sequence
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import Any, Final

import numpy as np
from scipy.signal import find_peaks, savgol_filter
from scipy.stats import norm

from latentarm.control.controller import Controller
from latentarm.operators.loop_limits import LoopLimits
from latentarm.operators.person import SimulatedPerson
from latentarm.operators.population import TRAITS, draw_people
from latentarm.operators.traits import Traits
from latentarm.robots.catalogue import load_robot
from latentarm.types import Context, FloatArray, Pose

SPLIT_SEED: Final = 39
"""Of which persons are fitted and which predicted; chosen before anything was fitted."""

RINGS: Final = ((0.06, 0.02), (0.12, 0.02), (0.06, 0.01), (0.12, 0.01))
"""Radius and width of targets, m."""

ORDER: Final = (0, 5, 1, 6, 2, 7, 3, 8, 4)
"""Of the nine targets of a ring. The way to the first of them does not count."""

COLUMNS: Final = ("target_id", "times", "ty", "tz")
LOGGED_HZ: Final = 40.0
GIVES_UP_S: Final = 15.0


@dataclass(frozen=True)
class Movement:
    """From one target to the next.

    Attributes:
        person: who moves.
        cell: the ring, and 4 more in the second half of the trials.
        time_s: from target to target, s.
        error_m: largest distance from the straight line, m.
        corrections: peaks of the speed after the first.
    """

    person: int
    cell: int
    time_s: float
    error_m: float
    corrections: int


def measured(person: int, cell: int, at_s: FloatArray, tool_m: FloatArray, ends_s: FloatArray) -> Iterator[Movement]:
    """The movements of a ring, all but the first.

    Args:
        person: who moves.
        cell: see `Movement`.
        at_s: (n,), times of samples, s.
        tool_m: (n, 2), the tool in the plane of the ring, m.
        ends_s: (8,), when each target was reached, s.
    """
    even_s = np.arange(at_s[0], at_s[-1], 1.0 / LOGGED_HZ)
    even_m = np.stack([np.interp(even_s, at_s, one) for one in tool_m.T], axis=1)
    speed = np.linalg.norm(savgol_filter(even_m, 7, 2, deriv=1, delta=1.0 / LOGGED_HZ, axis=0), axis=1)
    peaks, _ = find_peaks(speed, prominence=0.1 * np.percentile(speed, 95))
    for begin_s, end_s in zip(ends_s[:-1], ends_s[1:], strict=True):
        during = (even_s >= begin_s) & (even_s <= end_s)
        way = even_m[during] - even_m[during][0]
        along = way[-1] / np.linalg.norm(way[-1])
        off = np.abs(way[:, 0] * along[1] - way[:, 1] * along[0]).max()
        count = int(during[peaks].sum())
        yield Movement(person, cell, end_s - begin_s, float(off), max(count - 1, 0))


def logged(clone: Path) -> list[Movement]:
    """What the persons of the study did without autonomy."""
    found: list[Movement] = []
    csv.field_size_limit(2**24)
    for person in range(24):
        folder = clone / f"ros2_ws/src/cpp_pubsub/data_logging/csv_logs/part{person + 1}"
        with (folder / f"part{person + 1}_header.csv").open(newline="") as header:
            trials = [(int(one["trial_number"]), one) for one in csv.DictReader(header) if one["alpha_id"] == "5"]
        for number, trial in trials:
            with (folder / f"trial{number}.csv").open(newline="") as rows:
                columns = np.array([[float(row[one]) for one in COLUMNS] for row in csv.DictReader(rows)])
            changes = np.flatnonzero(np.diff(columns[:, 0])) + 1
            ends_s = columns[changes, 1]
            # The file does not say when the last target was reached; the header has how long it took.
            last_s = ends_s[-1] + json.loads(trial["mt_list"])[-1]
            cell = int(trial["ring_id"]) - 1 + 4 * (number > 12)
            found += measured(person, cell, columns[:, 1], columns[:, 2:], np.append(ends_s, last_s))
    return found
