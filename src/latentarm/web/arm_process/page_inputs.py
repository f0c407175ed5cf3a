"""The driver's inputs, from their page."""

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Final, final

import numpy as np

from latentarm.arms.contract import INPUT_BUDGET_S
from latentarm.control.clock import Clock
from latentarm.control.input_port import InputPort, InputSource
from latentarm.core.types import Input
from latentarm.web.protocol.notice import Notice
from latentarm.web.protocol.orders import Given, Paced
from latentarm.web.protocol.shared_memory import LatestSlot

INPUT_TIMEOUT_S: Final = 0.05
"""How long a fresh input moves any arm: 2.5 inputs of a page that sends 50 per second. The rest of 0.15 s is
for the stop."""

LATCH_MAX_S: Final = 10.0  # how long a deflection counts that is latched, or constant like a dead stick's, s
COPILOT_TIMEOUT_S: Final = 0.5  # how long a co-pilot's pace counts, s: five times the period of their page


@final
@dataclass(eq=False)
class PageInputs(InputSource):
    """The newest input in a slot, if it is the driver's and fresh.

    An arm that allows more than `INPUT_BUDGET_S` stands still while inputs are missing, and goes on when they
    come back within that time.
    """

    _slot: LatestSlot
    _clock: Clock
    _input_dim: int
    _dead_zone: float  # a smaller deflection is neutral
    _budget_s: float  # of the arm, see `ArmSpec.input_budget_s`
    # stops the arm: when a deflection has lasted too long without a change, another person starts to drive,
    # or the driver's co-pilot comes, goes, or is silent
    _stop: Callable[[Notice], None]

    def __post_init__(self) -> None:
        self._version = self._slot.version
        self._port = InputPort(self._input_dim, self._clock, self._budget_s)
        self._same_since_s = math.inf
        self._raw: tuple[float, ...] = ()
        self._paced: Paced | None = None
        self.driver = -1  # number of the driver; -1 before the first
        self.fresh = False  # whether the newest input still counts
        self.deflected = False  # whether it is outside the dead zone
        # kind, number and name of the deflected device; None for none
        self.held_by: tuple[str, int, str] | None = None
        # kinds of device that have moved the arm or its gripper since this was last emptied
        self.devices: set[str] = set()
        self._was_used = False

    def latest(self, now_s: float) -> tuple[Input, float]:
        if self._slot.version != self._version:
            self._take()
        given, age_s = self._port.latest(now_s)
        self.fresh = age_s <= INPUT_TIMEOUT_S
        if now_s - self._same_since_s > LATCH_MAX_S:
            self._same_since_s = math.inf
            self._stop(Notice(code="latch_ended", parameters={"seconds": round(LATCH_MAX_S)}))
        given = replace(given, pace=self._pace())
        if self.fresh or self._budget_s <= INPUT_BUDGET_S or age_s == math.inf:
            return given, age_s
        # It brakes as for a stop, whatever the robot does by itself, and nothing is learned from an old push.
        return replace(given, u=np.zeros_like(given.u), pace=0.0, delay_s=math.nan), INPUT_TIMEOUT_S

    def take_used(self) -> bool:
        """True if the stick was deflected, or the gripper asked for something, since the last call."""
        used, self._was_used = self._was_used, False
        return used

    def issue_nonce(self) -> str:
        """A nonce for the driver's page to echo."""
        return self._port.issue_nonce()

    def _pace(self) -> float:
        """The share of the driver's speed that the co-pilot allows; zero if they are silent."""
        if self._paced is None:
            return 1.0
        if self._port.nonce_age_s(self._paced.nonce) <= COPILOT_TIMEOUT_S:
            return self._paced.pace
        self._stop(Notice(code="copilot_late"))
        return 0.0

    def _take(self) -> None:
        found = self._slot.read()
        if found is None:
            return
        self._version, message = found
        given = Given.parse(message)
        if given is None or len(given.u) != self._input_dim:
            return
        if given.driver != self.driver:
            self.driver = given.driver
            self._port = InputPort(self._input_dim, self._clock, self._budget_s)
            self._same_since_s = math.inf
            self._stop(Notice(code="driver_changed"))
        if _copilot(given.paced) != _copilot(self._paced):
            self._stop(Notice(code="copilot_changed"))
        self._paced = given.paced
        u, asked = np.array(given.u), given.gripper
        # Its own number, which must grow, makes it count once; its own nonce makes it count only in time.
        if asked is not None and self._port.offer(Input(u, gripper=asked.ask), asked.nonce, asked.seq):
            self._note(given)
            self._used(given.source)
        if self._port.offer(Input(u, opens=given.opens), given.nonce, given.seq):
            self._note(given)

    def _note(self, given: Given) -> None:
        self.deflected = math.hypot(*given.u) > self._dead_zone
        self.held_by = (given.source, given.device, given.name) if self.deflected else None
        raw, before = given.u if given.raw is None else given.raw, self._raw
        self._raw = raw
        if not self.deflected:
            self._same_since_s = math.inf
            return
        self._used(given.source)
        if self._same_since_s == math.inf or not (given.latched or raw == before):
            self._same_since_s = self._clock.now_s()

    def _used(self, device: str) -> None:
        self._was_used = True
        self.devices.add(device)


def _copilot(paced: Paced | None) -> int | None:
    return None if paced is None else paced.copilot
