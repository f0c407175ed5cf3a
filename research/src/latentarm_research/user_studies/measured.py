"""Names of the figures that a simulated person's drive has."""

from typing import Final

MEASURED: Final = (
    "success_rate",
    "steps_done",
    "time_s",
    "idle_s",
    "input_magnitude",
    "turned_round",
    "mode_switches",
    "path_length",
    "stops",
    "preference_alignment",
    "attempts",
)
"""Figures of every trial that has a value for them."""

MEASURED_AT_PLATES: Final = ("goal_error_m_s", "goal_error_m")
"""Figures of drives at tasks with plates."""
