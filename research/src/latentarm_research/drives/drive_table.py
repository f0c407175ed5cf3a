"""One row per simulated drive, for ``drives.json`` and ``drives.csv``, and what is said of all of them."""

import csv
import io
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Final

from latentarm.core.files import write_text
from latentarm_research.drives.drive import Trace
from latentarm_research.metrics.drives import Drive

EVERY_DRIVE: Final[dict[str, str]] = {
    "time_s": "duration, s",
    "idle_s": "time without input, s",
    "input_magnitude_s": "integral of the input's length over time, s of full deflection",
    "turned_round": "share of the time in which the stick is over 90 degrees from where it was within 0.5 s",
    "mode_switches": "how often the controller's mode changed",
    "path_length_m": "length of the tool's path, m",
}
"""Columns that the tables of all kinds of drives have, and what each holds."""

COLUMNS: Final[dict[str, str]] = {
    "drive": "number of the drive, from 0",
    "goal": "index of the goal, from 0",
    "goal_name": "its name",
    "manner": "what is done at the goal",
    "repeat": "number of the drive to this goal, from 0",
    "seed": "seed of the command; start and inputs depend on seed, goal and repeat alone",
    "controller": "latent, latent_assist, end_effector, two_sticks or retargeting",
    "operator": "greedy, learning, reading, unsteady or planning; all are simulated",
    "success": "whether all waypoints were reached",
    "ended_because": "reached, time_limit, operator_stuck, held_back or safety_stop",
    "ended_in_words": "the same as a sentence",
    **EVERY_DRIVE,
    "goal_error_m_s": "integral over time of the tool's distance to the closest goal, m s",
    "goal_error_m": "mean of the same distance over time, m",
    "final_distance_m": "tool from the last waypoint at the end, m",
    "final_angle_deg": "the same for orientation, degrees",
    "waypoints_reached": "share of the waypoints that were reached, 0 to 1",
}
"""What each column of ``drives.csv`` holds; ``drives`` in ``drives.json`` has the same fields."""


@dataclass(frozen=True)
class Planned:
    """A drive before it is driven.

    Attributes:
        goal_name: of the goal.
        manner: what is done at the goal.
        repeat: number of the drive to this goal.
    """

    goal_name: str
    manner: str
    repeat: int


def drive_entries(
    planned: Sequence[Planned], traces: Sequence[Trace], *, seed: int, controller: str, operator: str
) -> list[dict[str, object]]:
    """One mapping per drive, with the keys of `COLUMNS` in that order.

    Args:
        planned: the drives, in order.
        traces: what came of them.
        seed: of the command.
        controller: what drove.
        operator: who gave inputs.
    """
    return [
        {
            "drive": number,
            "goal": trace.goal,
            "goal_name": plan.goal_name,
            "manner": plan.manner,
            "repeat": plan.repeat,
            "seed": seed,
            "controller": controller,
            "operator": operator,
            "success": trace.figures.success,
            "ended_because": trace.ending.reason,
            "ended_in_words": trace.ending.detail,
            **every_drive(trace.figures),
            "goal_error_m_s": trace.measured.goal_error_m_s,
            "goal_error_m": trace.measured.goal_error_m,
            "final_distance_m": trace.measured.final_distance,
            "final_angle_deg": trace.measured.final_angle_deg,
            "waypoints_reached": trace.progress,
        }
        for number, (plan, trace) in enumerate(zip(planned, traces, strict=True))
    ]


def every_drive(figures: Drive) -> dict[str, object]:
    """The cells of `EVERY_DRIVE`.

    Args:
        figures: of one drive.
    """
    return {
        "time_s": figures.time_s,
        "idle_s": figures.idle_s,
        "input_magnitude_s": figures.input_magnitude,
        "turned_round": figures.turned_round,
        "mode_switches": figures.mode_switches,
        "path_length_m": figures.path_length,
    }


def write_drives_csv(path: Path, entries: Sequence[Mapping[str, object]]) -> None:
    """Write one line per drive under a line of column names, whole or not at all.

    Args:
        path: the file.
        entries: of the drives, at least one; all have the same keys.

    Raises:
        UserError: the file cannot be written.
    """
    stream = io.StringIO()
    table = csv.DictWriter(stream, list(entries[0]), lineterminator="\n")
    table.writeheader()
    table.writerows(
        {name: str(value).lower() if isinstance(value, bool) else value for name, value in entry.items()}
        for entry in entries
    )
    write_text(path, stream.getvalue())


def endings_in_words(entries: Sequence[Mapping[str, object]]) -> list[str]:
    """How many drives ended for which reason, one sentence each; those that succeeded come first."""
    found = Counter((not entry["success"], str(entry["ended_in_words"])) for entry in entries)
    return [f"{count} of {len(entries)} drives: {words}." for (_, words), count in sorted(found.items())]
