"""What is shown of a drive and need not be new in every tick: ghosts, and how punctual the loop is."""

import math
from typing import Final, final

from latentarm.control.loop import ControlLoop
from latentarm.control.step import Step
from latentarm.types import FloatArray, StepRecord
from latentarm.web.arm_process.drive_setup import DriveSetup
from latentarm.web.arm_process.ghosts import GhostPaths
from latentarm.web.arm_process.steering import Steering
from latentarm.web.protocol.report import Ghosts

_LOOK_EVERY: Final = 10
_STATISTICS_EVERY: Final = 100


@final
class Outlook:
    """Work that can wait, a little in each tick that has time left.

    Args:
        setup: what is driven.
        step: says what a controller is told.
        loop: whose deadlines are counted.
        steering: how the arm is steered.

    Attributes:
        late_share: share of the loop's deadlines that were missed.
        late_p99_ms: 99th percentile of the time from a tick's due time until its command was sent.
    """

    def __init__(self, setup: DriveSetup, step: Step, loop: ControlLoop, steering: Steering) -> None:
        self._setup = setup
        self._step = step
        self._loop = loop
        self._steering = steering
        self._ghosts = GhostPaths(setup.task, setup.controller, setup.help)
        self.late_share = self.late_p99_ms = 0.0

    @property
    def ghosts(self) -> Ghosts | None:
        """What each direction would do; None before that is known."""
        return self._ghosts.newest

    def look(self, record: StepRecord, q: FloatArray) -> None:
        """Look along one direction, or at the statistics, if it is the tick for it.

        Args:
            record: of this tick.
            q: (n,), joint positions as they were last read, rad.
        """
        phase = self._steering.tick % _LOOK_EVERY
        if phase < 4:
            # Without a reading nobody knows the gripper, which the decoder may look at.
            if not math.isnan(record.state[0]):
                mode = self._setup.mode_index(self._steering.mode, self._steering.axes)
                self._ghosts.look(phase, self._step.context(q), mode)
        elif self._steering.tick % _STATISTICS_EVERY == _LOOK_EVERY - 1:
            statistics = self._loop.statistics()
            self.late_share = 1.0 - statistics.met_share
            self.late_p99_ms = 1000.0 * statistics.p99_s
