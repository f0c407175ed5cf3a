"""What the page shows to a person: words that are visible or in the accessibility tree, and nothing else."""

import re
from dataclasses import dataclass
from typing import Any, Final, Literal

from playwright.sync_api import Page

Direction = Literal["Up", "Down", "Left", "Right"]
Unit = Literal["cm", "°"]

LOOK: Final = """() => {
  const words = (element) => element.innerText.replace(/\\s+/g, " ").trim();
  const seen = (at) => [...document.querySelectorAll(at)].filter((one) => one.checkVisibility());
  const text = (at) => seen(at).map(words).join(" ");
  return {
    status: text("#status-text"),
    mark: document.querySelector("#status").dataset.phase,
    steps: seen("#task-steps li").map(words),
    said: text("#task-said"),
    fills: seen("#task-fills li").map(words),
    pairs: seen("#to-go li").map((item) => [...item.children].map(words)),
    pair: seen("#axes input").findIndex((input) => input.checked),
    gripper: text("#gripper-state"),
    arrows: seen("#ghosts li").map(words),
  };
}"""
"""`mark` is what the colour and the shape of the mark before the sentence say."""

SCAN: Final = """() => {
  const choices = [...document.querySelectorAll("#scan li")].filter((one) => one.checkVisibility());
  const lit = choices.find((one) => one.getAttribute("aria-current") === "true");
  return { names: choices.map((one) => one.innerText.trim()), lit: lit?.innerText.trim() ?? "" };
}"""


@dataclass(frozen=True)
class Left:
    """What is left of the way in one direction of the stick.

    Attributes:
        pair: which pair of directions.
        direction: of the stick.
        amount: in cm or degrees.
        unit: which of them.
    """

    pair: int
    direction: Direction
    amount: float
    unit: Unit


@dataclass(frozen=True)
class Fill:
    """How full a cup or a bowl is, as the page tells it.

    Attributes:
        thing: its name.
        percent: of what is poured.
        enough: percent that must be in it; None for what is poured from.
    """

    thing: str
    percent: int
    enough: int | None


@dataclass(frozen=True)
class Look:
    """What a person sees at one moment.

    Attributes:
        status: the sentence next to Enable and Stop.
        enabled: whether its mark says that the arm may move.
        step: the step that is to be done now; "" where none is marked.
        done: how many steps are ticked off.
        outcome: how the task has ended, or None.
        said: what is said of that.
        left: what is left of the way.
        pair: which pair of directions is chosen.
        gripper: its state in words.
        speed_cm_s: of the tool along each direction, as the arrows tell it.
        fills: how full cups and bowls are; empty where nothing is poured.
    """

    status: str
    enabled: bool
    step: str
    done: int
    outcome: Literal["success", "failure"] | None
    said: str
    left: tuple[Left, ...]
    pair: int
    gripper: str
    speed_cm_s: dict[str, float]
    fills: tuple[Fill, ...]


def look(page: Page) -> Look:
    """Look at the page, which is in English."""
    seen: dict[str, Any] = page.evaluate(LOOK)
    said = seen["said"]
    ticked = sum(step.startswith("✓") for step in seen["steps"])
    return Look(
        status=seen["status"],
        enabled=seen["mark"] in ("ready", "moving"),
        step=next((step for step in seen["steps"] if step.startswith("▸")), ""),
        # A phone shows the step that is to be done now alone, and says how many are done.
        done=max([ticked, *map(int, re.findall(r"^Step (\d+)", said))]),
        outcome="success" if said.startswith("Done!") else "failure" if "try again" in said else None,
        said=said,
        left=tuple(one for pair, parts in enumerate(seen["pairs"]) for one in _left(pair, parts)),
        pair=seen["pair"],
        gripper=seen["gripper"],
        speed_cm_s=_speeds(seen["arrows"]),
        fills=tuple(_fill(one) for one in seen["fills"]),
    )


def choices(page: Page) -> tuple[list[str], str]:
    """What a switch may choose from, and which of it is lit."""
    seen = page.evaluate(SCAN)
    return seen["names"], seen["lit"]


def moving(page: Page) -> bool:
    """Whether the lit direction is marked as one in which the arm moves."""
    return page.locator("#scan li[data-moving]").count() > 0


def _left(pair: int, parts: list[str]) -> list[Left]:
    found = []
    for part in parts[1:]:
        if match := re.fullmatch(r"(Up|Down|Left|Right) ([\d.]+)( cm|°)", part):
            direction, amount, unit = match.groups()
            found.append(Left(pair, direction, float(amount), unit.strip()))  # type: ignore[arg-type]
    return found


def _fill(told: str) -> Fill:
    match = re.fullmatch(r"(.+): (\d+) % (?:left|in, (\d+) % is enough)", told)
    if match is None:
        raise ValueError(f"The page tells in a way unknown to this person how full something is: {told}")
    thing, percent, enough = match.groups()
    return Fill(thing, int(percent), None if enough is None else int(enough))


def _speeds(arrows: list[str]) -> dict[str, float]:
    """The arrows show where the tool goes within a second."""
    matches = [re.search(r"(Up|Down|Left|Right) .*: (\d+) cm$", one) for one in arrows]
    return {one.group(1): float(one.group(2)) for one in matches if one}
