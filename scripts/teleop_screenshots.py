"""Pictures of the teleoperation page, at the size of a desk and of a phone, light and dark.

The run is driven by a script for them: a simulated person. For example:

    python scripts/teleop_screenshots.py RUN --out docs/figures
"""

import argparse
import shutil
import tempfile
import time
from collections.abc import Callable
from pathlib import Path

from playwright.sync_api import Page

from teleop_page import chromium, enable, served

DESK = {"width": 1280, "height": 800}
SETTLE_MS = 800
EPISODES = 3
MOST_STARTS = 5
LEARNING_MS = 120_000
BEGUN = "#answer-cancel, #working-cancel, #discard, #trial-discard"
PHONE = {"width": 390, "height": 844}


def driving(page: Page) -> None:
    """With help, under way to a goal; the stick stays pushed."""
    enable(page)
    stick = page.locator("#stick")
    stick.scroll_into_view_if_needed()
    page.evaluate("scrollTo(0, 0)")
    box = stick.bounding_box()
    if box is None:
        raise SystemExit("The page has no stick.")
    for _ in range(MOST_STARTS):
        page.mouse.move(box["x"] + box["width"] / 2, box["y"] + box["height"] / 2)
        page.mouse.down()
        page.mouse.move(box["x"] + 0.4 * box["width"], box["y"] + 0.8 * box["height"], steps=3)
        page.wait_for_timeout(1200)
        if page.locator("#status[data-phase=moving]").count():
            return
        # A busy computer has stopped the arm.
        page.mouse.up()
        enable(page)
    raise SystemExit("The arm is never under way: " + page.locator("#status-text").inner_text())


def buttons(page: Page) -> None:
    """The direction buttons."""
    page.get_by_role("radio", name="Buttons").check()


def switch(page: Page) -> None:
    """What one switch chooses from."""
    page.get_by_role("radio", name="Switch").check()
    enable(page)
    page.wait_for_timeout(1500)


def settings(page: Page) -> None:
    """The settings."""
    page.get_by_role("button", name="Settings").click()


def recorded(page: Page) -> None:
    """The Teach page with episodes to learn from: the same few seconds, driven three times."""
    page.get_by_role("radio", name="Straight lines").check()
    page.get_by_label("What you are doing").fill("towards the table")
    while page.get_by_role("link", name="Teach the arm").is_hidden() or episodes(page) < EPISODES:
        before = episodes(page)
        page.get_by_role("button", name="Arm back to start").click()
        page.get_by_role("button", name="Start recording").click()
        push_for(page, 2000)
        page.keyboard.press("Escape")
        page.wait_for_timeout(600)
        page.get_by_role("button", name="Stop recording").click()
        page.wait_for_function(
            "n => parseInt(document.querySelector('#record-text').textContent) > n", arg=before
        )
    page.get_by_role("link", name="Teach the arm").click()
    page.get_by_role("checkbox", name="Recording 3").wait_for()


def push_for(page: Page, moving_ms: int) -> None:
    """Hold the up key until the arm has moved for so long; a busy computer stops it in between."""
    moved_ms = 0
    while moved_ms < moving_ms:
        if page.locator("#status[data-phase=ready], #status[data-phase=moving]").count() == 0:
            page.keyboard.up("ArrowUp")
            enable(page)
        page.locator("#stick").focus()
        page.keyboard.down("ArrowUp")
        page.wait_for_timeout(100)
        moved_ms += 100 * page.locator("#status[data-phase=moving]").count()
    page.keyboard.up("ArrowUp")


def episodes(page: Page) -> int:
    """How many are recorded, as the page says it."""
    said = page.locator("#record-text").inner_text()
    return int(said.split()[0]) if said[:1].isdigit() else 0


def trained(page: Page) -> None:
    """The Teach page after a training."""
    recorded(page)
    if page.locator("#training-drive").is_hidden():
        page.get_by_role("button", name="Train", exact=True).click()
        page.locator("#training-drive, #training-why").filter(visible=True).first.wait_for(timeout=120_000)
    page.locator("#training").scroll_into_view_if_needed()


def personalise(page: Page) -> None:
    """The Personalise page as a person finds it."""
    page.get_by_role("link", name="Personalise").click()
    page.get_by_role("button", name="Begin").wait_for()


def asked(page: Page) -> None:
    """A question, and an answer that is still held."""
    personalise(page)
    page.get_by_label("Your name").fill("Ada")
    page.get_by_label("Most motions to answer for").select_option("5")
    page.get_by_role("button", name="Begin").click()
    page.get_by_role("heading", name="Question 1").wait_for(timeout=LEARNING_MS)
    push_aside(page)


def learned(page: Page) -> None:
    """What comes of the same answer to every question."""
    asked(page)
    while page.get_by_role("heading", name="The robot has learned").is_hidden():
        answer = page.get_by_role("button", name="This is my answer")
        if answer.is_visible() and answer.is_enabled():
            page.mouse.up()
            answer.click()
            page.wait_for_timeout(600)
        elif page.locator("#stick").is_visible():
            push_aside(page)
        page.wait_for_timeout(200)


def tried(page: Page) -> None:
    """What was learned, under trial."""
    learned(page)
    page.get_by_role("button", name="Try it").click()
    page.get_by_role("heading", name="You are trying").wait_for()


def tidy(page: Page) -> None:
    """End what was begun, so that the next picture finds the page as this one did."""
    page.mouse.up()
    while page.locator(BEGUN).filter(visible=True).count():
        page.locator(BEGUN).filter(visible=True).first.click()
        page.wait_for_timeout(SETTLE_MS)


def push_aside(page: Page) -> None:
    """Hold the stick to the right and a little up."""
    box = page.locator("#stick").bounding_box()
    if box is None:
        raise SystemExit("The page has no stick.")
    page.mouse.move(box["x"] + 0.5 * box["width"], box["y"] + 0.5 * box["height"])
    page.mouse.down()
    page.mouse.move(box["x"] + 0.8 * box["width"], box["y"] + 0.4 * box["height"], steps=3)
    page.wait_for_timeout(600)


SHOTS: dict[str, Callable[[Page], None]] = {
    "drive": driving,
    "drive-buttons": buttons,
    "drive-switch": switch,
    "drive-settings": settings,
    "personalise": personalise,
    "personalise-question": asked,
    "personalise-learned": learned,
    "personalise-trial": tried,
    "teach": recorded,
    "teach-trained": trained,
}


def take(run: Path, names: list[str], out: Path) -> None:
    """Take these pictures, at each size and in each scheme."""
    with served(run) as site, chromium() as browser:
        for size_name, size in (("desk", DESK), ("phone", PHONE)):
            for scheme in ("light", "dark"):
                for name in names:
                    # Twice as fine: the software renderer spares pixels.
                    context = browser.new_context(
                        viewport=size, color_scheme=scheme, device_scale_factor=2, reduced_motion="reduce"
                    )
                    page = context.new_page()
                    page.goto(site.address)
                    page.locator(".label").first.wait_for(state="attached")
                    page.wait_for_timeout(SETTLE_MS)
                    page.get_by_role("radio", name="Learned motions").check()
                    page.get_by_role("button", name="Arm back to start").click()
                    page.evaluate("scrollTo(0, 0)")
                    page.wait_for_timeout(SETTLE_MS)
                    SHOTS[name](page)
                    page.wait_for_timeout(600)
                    page.screenshot(path=out / f"teleop-{name}-{size_name}-{scheme}.png")
                    tidy(page)
                    context.close()
                    # So that the next page finds nobody who drives.
                    time.sleep(0.3)


def main() -> None:
    """Take all pictures."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("run", type=Path)
    parser.add_argument("--out", type=Path, required=True)
    parser.add_argument("--only", nargs="+", choices=SHOTS, default=list(SHOTS))
    given = parser.parse_args()
    given.out.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory() as folder:
        # What is learned for the pictures is not kept.
        run = Path(shutil.copytree(given.run, Path(folder) / given.run.name))
        take(run, given.only, given.out)


if __name__ == "__main__":
    main()
