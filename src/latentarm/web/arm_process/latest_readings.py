"""The newest readings of the arm: its joints and its gripper."""

import math
from typing import final

from latentarm.core.types import FloatArray, StepRecord
from latentarm.robots.gripper import Gripper
from latentarm.web.protocol.report import GripperState


@final
class LatestReadings:
    """Keeps the newest valid readings."""

    def __init__(self, start: FloatArray, gripper: Gripper | None) -> None:
        self._gripper = gripper
        self.q = start  # (n,), joint positions, rad
        self._read_s: float | None = None
        # measurement, and whether the last command was to close; None before the first
        self.gripper: GripperState | None = None

    def age_s(self, now_s: float) -> float:
        """How long ago, at the loop's time, s, the joints were read, or should have been at first."""
        return 0.0 if self._read_s is None else now_s - self._read_s

    def see(self, record: StepRecord) -> None:
        if not math.isnan(record.state[0]):
            self.q, self._read_s = record.state, record.time_s
        elif self._read_s is None:
            self._read_s = record.time_s
        measured, command = record.gripper, record.command.gripper
        if self._gripper is None or measured is None:
            return
        closing = None if self.gripper is None else self.gripper.closing
        if command is not None:
            closing = command.width_m < self._gripper.width_m / 2.0
        self.gripper = GripperState(width_m=measured.width_m, holding=measured.holding, closing=closing)
