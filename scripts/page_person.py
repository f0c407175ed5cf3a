"""A SCRIPTED person does tasks of the page with seven inputs: how often, how fast, with how many presses.

Nobody took part: arm, things and person are simulated. The person follows what the page shows: its steps,
what is left of the way, the gripper's state, the choice that is lit, how the task ended. They never see the
server's state. Tries are appended to a file, so that a study can be done in portions. For example:

    python scripts/page_person.py --inputs keyboard --tries 10 --minutes 6 --out page_drives.json
"""

import argparse
import json
import logging
import sys
import time
from collections.abc import Iterator
from itertools import groupby
from pathlib import Path
from typing import Any, Final

from playwright.sync_api import Browser, Page
from playwright.sync_api import Error as PlaywrightError

from person_drive import Person
from person_hands import HANDS, stopped
from person_page import look
from teleop_page import NO_GL, SOFTWARE_GL, chromium, served

TASKS: Final = {
    "left marshmallow": ("marshmallows", "left marshmallow"),
    "middle marshmallow": ("marshmallows", "middle marshmallow"),
    "right marshmallow": ("marshmallows", "right marshmallow"),
    "pour": ("reach_and_pour", None),
    "stir": ("apple_pie", "apple"),
    "share": ("pour", None),
}
CYCLE: Final = tuple(name for name in TASKS if name != "share")
"""What tries cycle through where no tasks are named."""

DESKTOP: Final = {"width": 1024, "height": 800}
PHONE: Final = {"width": 390, "height": 844}


LOADS_S: Final = 30.0


def main() -> None:
    """Do the tries that the file does not have yet, as many as there is time for, and print what it has."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--inputs", nargs="+", choices=list(HANDS), default=list(HANDS))
    parser.add_argument("--tasks", nargs="+", choices=list(TASKS), default=list(CYCLE))
    parser.add_argument("--tries", type=int, default=10, help="of each input; they cycle through the tasks")
    parser.add_argument("--seed", type=int, default=1, help="of where things are placed in the first try")
    parser.add_argument("--minutes", type=float, default=8.0, help="no try begins after so long")
    parser.add_argument("--out", type=Path, default=Path("page_drives.json"))
    parser.add_argument("--without-views", action="store_true", help="in a browser that cannot draw them")
    parser.add_argument("--log", action="store_true", help="tell what the person sees and does")
    options = parser.parse_args()
    logging.basicConfig(
        level=logging.INFO if options.log else logging.WARNING, format="%(relativeCreated)d %(message)s"
    )
    end_s = time.monotonic() + 60.0 * options.minutes
    found: list[dict[str, Any]] = json.loads(options.out.read_text()) if options.out.exists() else []
    tries = [(number, options.tasks[number % len(options.tasks)]) for number in range(options.tries)]
    with chromium(NO_GL if options.without_views else SOFTWARE_GL) as browser:
        for name in options.inputs:
            had = {one["try"] for one in found if one["input"] == name}
            missing = [(number, task) for number, task in tries if number not in had]
            missing.sort(key=lambda one: TASKS[one[1]][0])
            for scene, some in groupby(missing, key=lambda one: TASKS[one[1]][0]):
                try:
                    for drive in drives(browser, name, scene, list(some), options.seed, end_s):
                        found.append(drive)
                        options.out.write_text(json.dumps(found, indent=1))
                        print(json.dumps(drive), flush=True)
                except PlaywrightError as error:
                    # The other tries are done all the same; this one is missing, and can be done again.
                    print(f"{name}, {scene}: {error}", file=sys.stderr, flush=True)


def drives(
    browser: Browser, name: str, scene: str, tries: list[tuple[int, str]], seed: int, end_s: float
) -> Iterator[dict[str, Any]]:
    """Tries of one input at one scene, while there is time.

    Args:
        browser: opens the page.
        name: of the input.
        scene: task of the server.
        tries: number and name of each.
        seed: of the first try of all.
        end_s: no try begins after this, s.
    """
    if not tries or time.monotonic() > end_s:
        return
    first = seed + tries[0][0]
    with served(None, options=("--task", scene, "--seed", str(first))) as site:
        kind = HANDS[name]
        phone = {"viewport": PHONE, "has_touch": True, "is_mobile": True}
        context = browser.new_context(**(phone if name == "touch" else {"viewport": DESKTOP}), locale="en-GB")
        page = context.new_page()
        page.set_default_timeout(20_000)
        if kind.script:
            page.add_init_script(kind.script)
        page.goto(site.address)
        page.locator("#status:not([data-phase=connecting], [data-phase=lost])").wait_for()
        # The drawing is loaded last, or the page says that it cannot draw.
        page.locator(".label, #scene-lost:not([hidden])").first.wait_for(state="attached")
        page.get_by_role("button", name="Skip", exact=True).click()
        hand = kind(page)
        hand.sit_down()
        person = Person(hand)
        for index, (number, task) in enumerate(tries):
            if time.monotonic() > end_s:
                break
            begin(page, TASKS[task][1], anew=index > 0)
            # Enter on a button that was pressed last would press it again.
            page.locator(kind.at).focus()
            drive = person.drive()
            stopped(hand)
            yield {"input": name, "task": task, "try": number, "seed": first + index, **drive.as_json()}
        context.close()


def begin(page: Page, choice: str | None, anew: bool) -> None:
    """Have a run of the task begin; a helper at the person's side does this."""
    if anew:
        page.locator("#task-next").click(timeout=5000)
        page.wait_for_timeout(1500)
    chooser = page.locator("#task-choice")
    if choice is not None and chooser.locator("option:checked").inner_text() != choice:
        chooser.select_option(label=choice)
        page.wait_for_timeout(1500)
    end_s = time.monotonic() + LOADS_S
    while look(page).outcome is not None and time.monotonic() < end_s:
        page.wait_for_timeout(200)


if __name__ == "__main__":
    main()
