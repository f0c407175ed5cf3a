"""A scripted person does tasks on the page by every input, on several screens.

They follow only what the page shows, along straight lines (`web/browser/scripted_person.py`). As a command:
``python tests/scripted_drives.py --tasks marshmallows --tries 1`` drives simulated arms in real time and
prints for each drive how it ended, how long it took, and how often the person pressed and had to scroll.
"""

import argparse
import itertools
import json
import sys
import tempfile
import time
from pathlib import Path

from playwright.sync_api import Browser, sync_playwright

from web.browser.conftest import SOFTWARE_GL, started
from web.browser.hands import HANDS
from web.browser.scripted_person import Person

SIZES = {"1280x720": (1280, 720), "390x844": (390, 844), "844x390": (844, 390)}
TASKS = ("marshmallows", "entree", "dessert", "avoid", "reach_and_pour", "pour", "apple_pie")
SCROLLS = """
window.scrolls = 0;
addEventListener("scroll", ({ target }) => (scrolls += target.id !== "scan"), { capture: true });
"""


def drive(browser: Browser, task: str, hand: str, size: str, seed: int) -> dict[str, object]:
    """One drive at a server of its own."""
    kind, (width, height) = HANDS[hand], SIZES[size]
    folder = Path(tempfile.mkdtemp())
    with started(folder, "--task", task, "--seed", str(seed)) as address:
        context = browser.new_context(
            viewport={"width": width, "height": height}, locale="en-GB", has_touch=kind.touch
        )
        page = context.new_page()
        page.add_init_script(kind.script() + SCROLLS)
        page.goto(address)
        page.locator("#status:not([data-phase=connecting], [data-phase=lost])").wait_for()
        page.wait_for_timeout(1000)
        began_s = time.monotonic()
        person = Person(page, kind(page))
        said = person.drive()
        row = {
            "task": task,
            "input": hand,
            "screen": size,
            "seed": seed,
            "done": said.startswith("Done!"),
            "seconds": round(time.monotonic() - began_s, 1),
            "presses": person.hand.presses,
            "scrolls": page.evaluate("scrolls"),
            "said": said or page.locator("#status").inner_text(),
        }
        page.screenshot(path=folder / "end.png")
        context.close()
    return {**row, "picture": str(folder / "end.png")}


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--tasks", nargs="+", choices=TASKS, default=TASKS)
    parser.add_argument("--inputs", nargs="+", choices=tuple(HANDS), default=tuple(HANDS))
    parser.add_argument("--screens", nargs="+", choices=tuple(SIZES), default=tuple(SIZES))
    parser.add_argument("--tries", type=int, default=10)
    parser.add_argument("--chromium", default="/usr/bin/chromium")
    given = parser.parse_args()
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(
            executable_path=given.chromium, args=[*SOFTWARE_GL, "--no-sandbox"]
        )
        for seed, *what in itertools.product(range(given.tries), given.tasks, given.inputs, given.screens):
            sys.stdout.write(json.dumps(drive(browser, *what, seed)) + "\n")
            sys.stdout.flush()
        browser.close()


if __name__ == "__main__":
    main()
