"""A scripted person who does a task of the page, by what the page shows and nothing else.

They drive straight lines, one direction at a time: look what is left of the way, choose a direction, push for
as long as that should take, let go, look again. From each push they learn how far the tool goes.
"""

import logging
import time
from dataclasses import asdict, dataclass, field
from typing import Any, Final

from person_hands import Hand, stopped
from person_page import Left, Look, Unit, look

READS_S: Final = 0.3
"""How long they look before they press: the page's words change four times a second."""

_log = logging.getLogger(__name__)

LEVELS: Final = ({"cm": 1.0, "°": 10.0}, {"cm": 0.5, "°": 5.0}, {"cm": 0.3, "°": 3.0})
"""What they leave as it is: first the large parts of the way, then the small ones."""

FIRST_GUESS: Final = {"cm": 15.0, "°": 28.0}
"""How fast they take the tool to be before they have seen it move, per second."""

SHORTEST_S: Final = 0.04
SHARE: Final = 0.92
"""How much of a long way they dare to drive at once."""

TURN_AT_ONCE: Final = 30.0
"""Degrees; two turns at once come out otherwise than one after the other."""

LONG_CM: Final = 3.0
POUR_AT_LEAST: Final = 12.0
"""Degrees; who pours tips the cup a little at a time, and looks."""

SHARE_AT_LEAST: Final = 4.0
"""Degrees; who must keep some of it in the cup tips it by less."""

TIPPED: Final = 20.0
"""Degrees; a cup that leans so far is set upright before it is carried elsewhere."""

GIVES_UP_S: Final = 600.0
STUCK_LOOKS: Final = 25
MOST_GRIPS: Final = 3
"""Grips in vain after which they have the task begin again, where the page offers that."""

MOST_RESTARTS: Final = 2


@dataclass
class Drive:
    """What became of a try.

    Attributes:
        success: whether the page said that all is done.
        seconds: from the first press until the page said how it ended.
        presses: in this time.
        stops: how often the arm stopped by itself.
        first_step_s: until the first step was ticked off; None if never.
        steps: how many were.
        said: what the page said at the end, or why the person gave up.
        reasons: why the arm stopped, as the page said it.
        pushes: how often the arm was pushed.
        restarts: how often Again was pressed because the task could not be done any more.
    """

    success: bool = False
    seconds: float = 0.0
    presses: int = 0
    stops: int = 0
    first_step_s: float | None = None
    steps: int = 0
    said: str = ""
    reasons: list[str] = field(default_factory=list)
    pushes: int = 0
    restarts: int = 0

    def as_json(self) -> dict[str, Any]:
        """For a file."""
        found = asdict(self)
        found["seconds"] = round(self.seconds, 1)
        if self.first_step_s is not None:
            found["first_step_s"] = round(self.first_step_s, 1)
        return found


class Person:
    """Drives with one hand.

    Args:
        hand: what they press with.
    """

    def __init__(self, hand: Hand) -> None:
        self.hand = hand
        self._rate = dict(FIRST_GUESS)
        self._more_s: dict[Unit, float] = {"cm": 0.02, "°": 0.02}
        self._in_vain = 0

    def drive(self) -> Drive:
        """Do the task that the page shows, from its start on."""
        drive = Drive()
        self._in_vain = 0
        began_s, before = time.monotonic(), self.hand.presses
        was_enabled, quiet = False, 0
        while time.monotonic() - began_s < GIVES_UP_S:
            seen = look(self.hand.page)
            _log.info("%s", _brief(seen))
            drive.steps = seen.done
            if drive.first_step_s is None and (seen.done or seen.outcome == "success"):
                drive.first_step_s = time.monotonic() - began_s
            if seen.outcome == "success":
                drive.success, drive.said = True, seen.said
                break
            if seen.outcome == "failure" or self._cannot_go_on(seen):
                drive.said = seen.said
                if drive.restarts == MOST_RESTARTS:
                    break
                drive.restarts += 1
                self._again()
                was_enabled, quiet = False, 0
                continue
            if not seen.enabled:
                if was_enabled:
                    drive.stops += 1
                    drive.reasons.append(seen.status)
                    time.sleep(READS_S)
                was_enabled = self._enable()
                continue
            was_enabled = True
            acted = self._act(seen, drive)
            quiet = 0 if acted else quiet + 1
            if quiet > STUCK_LOOKS:
                drive.said = "gave up: nothing is left to drive"
                break
            time.sleep(READS_S)
        else:
            drive.said = f"gave up after {GIVES_UP_S:.0f} s"
        drive.seconds, drive.presses = time.monotonic() - began_s, self.hand.presses - before
        return drive

    def _cannot_go_on(self, seen: Look) -> bool:
        """Whether the page offers Again, and taking the thing once more has failed or cannot help."""
        return seen.said.startswith("Too little is left") or (
            "press Again" in seen.said and self._in_vain >= MOST_GRIPS
        )

    def _again(self) -> None:
        """Have the helper put everything back as it was."""
        stopped(self.hand)
        self.hand.page.locator("#task-again").click(timeout=5000)
        self._in_vain = 0
        for _ in range(50):
            now = look(self.hand.page)
            if now.outcome is None and "press Again" not in now.said:
                break
            time.sleep(0.1)
        # Enter on a button that was pressed last would press it again.
        self.hand.page.locator(self.hand.at).focus()

    def _enable(self) -> bool:
        self.hand.enable()
        for _ in range(20):
            if look(self.hand.page).enabled:
                return True
            time.sleep(0.05)
        return False

    def _act(self, seen: Look, drive: Drive) -> bool:
        """Do one thing; whether there was anything to do."""
        if "gripper now" in seen.step:
            self._grip("Close" in seen.step, seen)
            return True
        if seen.gripper.startswith("Closed") and "go to" in seen.step.lower():
            self._grip(False, seen)
            return True
        wanted = _next(seen)
        if wanted is None:
            return False
        if wanted.pair != seen.pair:
            self._choose(wanted.pair, seen.pair)
            return True
        drive.pushes += 1
        self._push(wanted, seen)
        return True

    def _choose(self, pair: int, now: int) -> None:
        self.hand.choose(pair, now)
        for _ in range(12):
            if look(self.hand.page).pair == pair:
                return
            time.sleep(0.05)

    def _grip(self, close: bool, seen: Look) -> None:
        self.hand.grip(close)
        for _ in range(15):
            time.sleep(0.2)
            now = look(self.hand.page)
            if now.gripper.startswith("Holding") == close and "gripper now" not in now.step:
                self._in_vain = 0
                return
            if not now.enabled:
                return
        self._in_vain += 1

    def _push(self, wanted: Left, seen: Look) -> None:
        unit, far = wanted.unit, wanted.amount
        if unit == "cm" and far > LONG_CM:
            far *= SHARE
        if unit == "°":
            far = min(far, TURN_AT_ONCE)
            if "pour" in seen.step.lower():
                far = min(far, SHARE_AT_LEAST if _shares(seen) else max(POUR_AT_LEAST, far / 2))
        speed = self._rate[unit]
        hold_s = max(far / speed - self._more_s[unit], SHORTEST_S)
        _log.info("push %s %.2f s for %.1f %s", wanted.direction, hold_s, far, unit)
        self.hand.push(wanted.direction, hold_s)
        time.sleep(READS_S)
        now = look(self.hand.page)
        after = [one for one in now.left if (one.pair, one.unit) == (wanted.pair, unit)]
        rest = sum(
            one.amount * {wanted.direction: 1.0, _OTHER[wanted.direction]: -1.0}.get(one.direction, 0.0)
            for one in after
        )
        gone = wanted.amount - rest
        self._learn(unit, hold_s, gone, far)

    def _learn(self, unit: Unit, hold_s: float, gone: float, meant: float) -> None:
        """How much longer the arm moves than it is pushed."""
        if not 0.3 * meant < gone < 2.5 * meant + 2.0 or hold_s <= SHORTEST_S:
            return
        error_s = gone / self._rate[unit] - hold_s
        self._more_s[unit] = min(max(0.7 * self._more_s[unit] + 0.3 * error_s, -0.05), 0.25)


_OTHER: Final = {"Up": "Down", "Down": "Up", "Left": "Right", "Right": "Left"}


def _brief(seen: Look) -> str:
    left = ", ".join(f"{one.pair} {one.direction} {one.amount:g}{one.unit}" for one in seen.left)
    full = ", ".join(f"{one.thing} {one.percent}%" for one in seen.fills)
    return f"{seen.enabled} | {seen.step} | {seen.pair} | {left} | {seen.gripper} | {full} | {seen.said}"


def _next(seen: Look) -> Left | None:
    """What to drive next: up first, then across, then turns, and down last; what is held is turned first."""
    tipped = [one for one in seen.left if one.unit == "°" and one.amount >= TIPPED]
    if tipped and seen.gripper.startswith("Holding") and "go over" in seen.step.lower():
        return min(tipped, key=lambda one: (one.pair != seen.pair, -one.amount))
    for level in LEVELS:
        wanted = [one for one in seen.left if one.amount >= level[one.unit]]
        if not wanted:
            continue
        first = min(wanted, key=lambda one: (_order(one), one.pair != seen.pair, -one.amount))
        if _order(first) == _DOWN:
            # Down only from right over it.
            aside = [
                one
                for one in seen.left
                if _order(one) < _DOWN and one.unit == "cm" and one.amount >= LEVELS[1]["cm"]
            ]
            return max(aside, key=lambda one: one.amount) if aside else first
        return first
    return None


def _shares(seen: Look) -> bool:
    """Whether something must stay in the cup: another bowl needs some of it as well."""
    needy = [one for one in seen.fills if one.enough is not None and one.percent < one.enough]
    return len(needy) > 1


_DOWN: Final = 3


def _order(one: Left) -> int:
    if one.unit == "°":
        return 2
    if one.pair == 0:
        return 1
    return 0 if one.direction == "Up" else _DOWN
