"""A scripted person who does tasks by what the page shows and nothing else.

They drive straight lines, one direction at a time: look how much of the way is left, choose a direction, push
for as long as that should take, let go, look again. From each push they learn how long the arm moves on.
"""

import math
import re
import time
from dataclasses import dataclass
from typing import Any, Final

from playwright.sync_api import Page

from .hands import Hand

LOOK: Final = """() => {
  const words = (element) => element.innerText.replace(/\\s+/g, " ").trim();
  const seen = (at) => [...document.querySelectorAll(at)].filter((one) => one.checkVisibility());
  return {
    phase: document.querySelector("#status").dataset.phase,
    said: seen("#task-said").map(words).join(" "),
    pairs: seen("#to-go li").map((item) => [...item.children].map(words)),
    pair: seen("#axes input").findIndex((input) => input.checked),
    gripper: document.querySelector("#gripper [data-next=true]")?.id.replace("gripper-", "") ?? "",
  };
}"""

WAY: Final = re.compile(r"(Up|Down|Left|Right) ([\d.]+) ?(cm|°)")
OPPOSITE: Final = {"Up": "Down", "Down": "Up", "Left": "Right", "Right": "Left"}
LEVELS: Final = ({"cm": 1.0, "°": 10.0}, {"cm": 0.5, "°": 5.0}, {"cm": 0.3, "°": 3.0})
"""Distances that they ignore: first they drive the large ones, then the small ones."""

SPEED: Final = {"cm": 15.0, "°": 28.0}
"""Expected speed of the tool, per second."""

TURNS: Final = 30.0
"""They turn no farther than this at a push, in degrees."""
POURS: Final = "Pour into"
TIPS: Final = 10.0
"""The same where the page says `POURS`: grains fall while they look."""

READS_S: Final = 0.3
SHORTEST_S: Final = 0.04
GRIPS_S: Final = 2.0
"""The gripper takes no longer than this to do what it was asked."""
ACROSS: Final = 0
"""The pair of directions that is parallel to the table. The person faces the arm: Up is back to its base."""
DOWN: Final = 5
"""Down towards the table comes after all other ways."""


@dataclass(frozen=True)
class Left:
    """How much of the way is left in one direction of the stick.

    Attributes:
        pair: index of the pair of directions.
        direction: of the stick.
        amount: in cm or degrees.
        unit: one of the two.
    """

    pair: int
    direction: str
    amount: float
    unit: str

    @property
    def order(self) -> int:
        """Up first, then back, aside, and forward, so that things are passed; then turns, and down last."""
        if self.unit == "°":
            return 4
        if self.pair == ACROSS:
            return {"Up": 1, "Down": 3}.get(self.direction, 2)
        return 0 if self.direction == "Up" else DOWN


class Person:
    """Does the task on a page in English, with one input."""

    def __init__(self, page: Page, hand: Hand) -> None:
        self._page, self.hand = page, hand
        self._more_s = {"cm": 0.02, "°": 0.02}
        self._gripped_s = -math.inf

    def drive(self) -> str:
        """Drive until the page says how the task ended, or give up; the page's last sentence."""
        seen: dict[str, Any] = {"said": ""}
        end_s = time.monotonic() + self.hand.gives_up_s
        while time.monotonic() < end_s:
            seen = self._page.evaluate(LOOK)
            if seen["said"].startswith(("Done!", "Too little is left")) or "try again" in seen["said"]:
                break
            left = ways(seen["pairs"])
            if seen["phase"] not in ("ready", "moving"):
                self.hand.enable()
            elif seen["gripper"]:
                if time.monotonic() - self._gripped_s > GRIPS_S:
                    self._gripped_s = time.monotonic()
                    self.hand.gripper(seen["gripper"])
            elif left and (wanted := choose(left, seen["pair"])):
                if wanted.pair == seen["pair"]:
                    self._push(wanted, TIPS if POURS in seen["said"] else TURNS)
                else:
                    self.hand.pair(wanted.pair)
            time.sleep(READS_S)
        return seen["said"]

    def _push(self, wanted: Left, turn: float) -> None:
        aim = min(wanted.amount, turn) if wanted.unit == "°" else wanted.amount
        speed = self.hand.speed * SPEED[wanted.unit]
        hold_s = max(aim / speed - self._more_s[wanted.unit], SHORTEST_S)
        self.hand.push(wanted.direction.lower())
        time.sleep(hold_s)
        self.hand.await_end()
        self.hand.let_go()
        time.sleep(READS_S)
        signs = {wanted.direction: 1.0, OPPOSITE[wanted.direction]: -1.0}
        rest = sum(
            signs.get(one.direction, 0.0) * one.amount
            for one in ways(self._page.evaluate(LOOK)["pairs"])
            if (one.pair, one.unit) == (wanted.pair, wanted.unit)
        )
        moved = wanted.amount - rest
        if 0.3 * aim < moved < 2.5 * aim + 2.0 and hold_s > SHORTEST_S:
            more_s = 0.7 * self._more_s[wanted.unit] + 0.3 * (moved / speed - hold_s)
            self._more_s[wanted.unit] = min(max(more_s, -0.05), 0.25)


def ways(pairs: list[list[str]]) -> list[Left]:
    """Read the distances that the page lists by pair of directions."""
    read = [(pair, WAY.fullmatch(part)) for pair, parts in enumerate(pairs) for part in parts[1:]]
    return [Left(pair, way[1], float(way[2]), way[3]) for pair, way in read if way]


def choose(left: list[Left], pair: int) -> Left | None:
    """The next distance to drive; down only from straight above."""
    for level in LEVELS:
        wanted = [one for one in left if one.amount >= level[one.unit]]
        if not wanted:
            continue
        first = min(wanted, key=lambda one: (one.order, one.pair != pair, -one.amount))
        aside = [one for one in left if one.unit == "cm" and one.order < DOWN and one.amount >= 0.5]
        return max(aside, key=lambda one: one.amount) if first.order == DOWN and aside else first
    return None
