"""Figures of drives that nobody drove."""

from dataclasses import replace
from typing import Any

import numpy as np

from latentarm_research.metrics.drives import Drive

ONE = Drive(True, 1.0, 1.0, 1.0, 1.0, 1.0, 3, 1.0, 0, 1.0, 1.0, 0.0, 0.0, np.nan, 1.0, 1.0, 0, 0)


def drive_of(success: bool, **changes: Any) -> Drive:
    """Figures of a drive, without an alignment and without grains."""
    return replace(ONE, success=success, **changes)
