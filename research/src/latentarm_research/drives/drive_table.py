"""One row per simulated drive, for ``drives.json`` and ``drives.csv``, and what is said of all of them."""

import csv
import io
from collections import Counter
from collections.abc import Mapping, Sequence
from math import isnan
from pathlib import Path
from typing import Final

from latentarm.core.files import write_text
from latentarm_research.drives.drives import Planned
from latentarm_research.drives.trace import Trace

COLUMNS: Final[dict[str, str]] = {
    "drive": "number of the drive, from 0",
    "choice": "index of what was to be done, from 0; at goals of the goal",
    "choice_name": "its name",
    "text": "what was to be done, in words",
    "repeat": "number of the drive for this choice, from 0",
    "seed": "seed of the command; things, start and inputs depend on seed, choice and repeat alone",
    "controller": "latent, latent_assist, end_effector, two_sticks or retargeting",
    "operator": "greedy, learning, reading, unsteady or planning; all are simulated",
    "success": "whether all steps were done and nothing went wrong; at goals each waypoint is a step",
    "steps_done": "share of the steps that were done, 0 to 1",
    "not_done": "the first step that was not done, in words",
    "ended_because": "done, mishap, time_limit, operator_stuck, held_back or safety_stop",
    "ended_in_words": "the same in words",
    "time_s": "duration, s",
    "idle_s": "time without input, s",
    "input_magnitude_s": "integral of the input's length over time, s of full deflection",
    "turned_round": "share of the time in which the stick is over 90 degrees from where it was within 0.5 s",
    "mode_switches": "how often the controller's mode changed",
    "path_length_m": "length of the tool's path, m",
    "stops": "how often the arm was stopped and had to be enabled again",
    "goal_error_m_s": "integral over time of the tool's distance to the closest goal, m s",
    "goal_error_m": "mean of the same distance over time, m",
    "final_distance_m": "tool from the last waypoint at the end, m",
    "final_angle_deg": "the same for orientation, degrees",
    "preference_alignment": "mean dot product of where the tool points and where it should",
    "table_force_n": "largest force of the tool on the table or a dish, N",
    "food_force_n": "largest force of the tool on food, N",
    "spilled": "grains that were spilled",
    "grains": "grains that there were",
}
"""Columns of ``drives.csv``, and fields of ``drives`` in ``drives.json``.

A figure that a drive does not have, such as a force where nothing can be touched, is empty, or null in JSON.
"""

FIGURES: Final[dict[str, str]] = {
    "input_magnitude_s": "input_magnitude",
    "path_length_m": "path_length",
    "final_distance_m": "final_distance",
}
"""Columns that have another name than their field of `Drive`."""


def drive_entries(
    planned: Sequence[Planned], traces: Sequence[Trace], *, controller: str, operator: str
) -> list[dict[str, object]]:
    """One mapping per drive, with the keys of `COLUMNS` in that order."""
    return [
        {name: None if isinstance(value, float) and isnan(value) else value for name, value in entry.items()}
        for entry in (
            _entry(number, plan, trace, controller, operator)
            for number, (plan, trace) in enumerate(zip(planned, traces, strict=True))
        )
    ]


def _entry(number: int, plan: Planned, trace: Trace, controller: str, operator: str) -> dict[str, object]:
    of_the_drive: dict[str, object] = {
        "drive": number,
        "choice": plan.choice,
        "choice_name": plan.setup.task.choices[plan.choice],
        "text": trace.text,
        "repeat": plan.repeat,
        "seed": plan.seed,
        "controller": controller,
        "operator": operator,
        "not_done": trace.ended_in,
        "ended_because": trace.ending.reason,
        "ended_in_words": trace.ending.detail,
    }
    return {
        name: of_the_drive[name] if name in of_the_drive else getattr(trace.figures, FIGURES.get(name, name))
        for name in COLUMNS
    }


def write_drives_csv(path: Path, entries: Sequence[Mapping[str, object]]) -> None:
    """Write one line per drive under a line of column names, whole or not at all."""
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
