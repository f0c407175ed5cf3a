"""A week of drives, made through the page by a SCRIPTED person, and what the page makes of them.

Nobody took part: arm, things and person are simulated. On each of seven days the person does two drives by
what the page shows; the server is started anew for each day, with a calendar that is so many days behind.
Then the History page is looked at, the report printed to PDF and the drives saved as a table. At last the
person deletes one drive and then themselves, and the server's folder must hold nothing of them. For example:

    python scripts/page_week.py --without-views --out week
"""

import argparse
import tempfile
from pathlib import Path
from typing import Final

from playwright.sync_api import Browser, Page

from latentarm.web.records.records import FOLDER
from page_person import DESKTOP, begin
from person_drive import Person
from person_hands import HANDS, stopped
from teleop_page import NO_GL, SOFTWARE_GL, Site, chromium, served

NAME: Final = "Ada Lovelace"
ON_DAY: Final = (str(Path(__file__).with_name("teleop_on_day.py")),)
DAYS: Final = ("keyboard", "pointer", "keyboard", "dpad", "keyboard", "gamepad", "two switches")
"""What the person presses with on each day."""

TASK: Final = "marshmallows"
WANTED: Final = ("left marshmallow", "middle marshmallow", "right marshmallow")
DRIVES: Final = 2
"""On each day."""

TALL: Final = {"width": 1280, "height": 1500}
WAIT_MS: Final = 20_000


def arrive(browser: Browser, site: Site, script: str = "") -> Page:
    """The People page, where the person has said that it is they; they add themselves on the first day."""
    page = browser.new_context(viewport=DESKTOP, locale="en-GB").new_page()
    page.set_default_timeout(WAIT_MS)
    if script:
        page.add_init_script(script)
    page.goto(f"{site.address}/people")
    page.get_by_role("button", name="Choose Guest").wait_for()
    choose = page.get_by_role("button", name=f"Choose {NAME}")
    if choose.count() == 0:
        page.locator("#add input").fill(NAME)
        page.get_by_role("button", name="Add a person").click()
    else:
        choose.click()
    page.locator("#people li[data-here=true]", has_text=NAME).wait_for()
    return page


def drive(browser: Browser, site: Site, day: int) -> None:
    """What the person does on a day."""
    name = DAYS[day]
    kind = HANDS[name]
    page = arrive(browser, site, kind.script)
    page.goto(site.address)
    page.locator("#status:not([data-phase=connecting], [data-phase=lost])").wait_for()
    page.locator(".label, #scene-lost:not([hidden])").first.wait_for(state="attached")
    skip = page.get_by_role("button", name="Skip", exact=True)
    if skip.is_visible():
        skip.click()
    # Their settings may still name what they pressed with yesterday.
    page.get_by_role("radio", name="Stick").check()
    hand = kind(page)
    hand.sit_down()
    person = Person(hand)
    for number in range(DRIVES):
        begin(page, WANTED[(DRIVES * day + number) % len(WANTED)], anew=number > 0)
        page.locator(kind.at).focus()
        done = person.drive()
        stopped(hand)
        print(f"{name}: {done.said} ({done.presses} presses, {done.stops} stops by itself)", flush=True)
    page.context.close()


def look_back(browser: Browser, site: Site, out: Path) -> list[str]:
    """The history of the week: pictures, the report as PDF, the table.

    Returns:
        Ids of the drives.
    """
    page = arrive(browser, site)
    page.set_viewport_size(TALL)
    page.goto(f"{site.address}/history")
    page.locator("#drives li").first.wait_for()
    page.locator("#status:not([data-phase=connecting])").wait_for()
    page.screenshot(path=out / "history.png")
    with page.expect_download() as download:
        page.locator("#csv").click()
    download.value.save_as(out / "drives.csv")
    page.pdf(path=out / "report.pdf", prefer_css_page_size=True)
    drives = page.request.get(f"{site.address}/records/drives").json()["drives"]
    page.context.close()
    return [one["id"] for one in drives]


def erase(browser: Browser, site: Site) -> str:
    """The person deletes one drive, which could be brought back, and then themselves.

    Returns:
        The id that they had.
    """
    page = arrive(browser, site)
    person: str = page.evaluate("JSON.parse(localStorage['latentarm.person']).id")
    page.goto(f"{site.address}/history")
    page.locator("#drives li").first.get_by_role("button", name="Delete").click()
    page.get_by_role("button", name="Undo").wait_for()
    page.goto(f"{site.address}/people")
    page.get_by_role("button", name=f"Delete {NAME}").click()
    page.get_by_role("button", name="Delete everything").click()
    page.get_by_role("button", name=f"Choose {NAME}").wait_for(state="detached")
    left = [page.request.get(f"{site.address}/records/{what}").json()[what] for what in ("people", "drives")]
    kept = page.evaluate("JSON.stringify({ ...localStorage })")
    if left != [[], []] or NAME in kept or person in kept:
        raise SystemExit(f"The page still knows: {left}, {kept}")
    page.context.close()
    return person


def naming(folder: Path, names: list[str]) -> list[Path]:
    """Files and folders under a folder that hold one of some names, or are named so."""
    traces = [name.encode() for name in names]
    return [
        path
        for path in folder.rglob("*")
        if any(
            trace in str(path).encode() + (path.read_bytes() if path.is_file() else b"") for trace in traces
        )
    ]


def main() -> None:
    """Drive for a week, look at it, delete the person."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("--out", type=Path, required=True, help="for the pictures, the report and the table")
    parser.add_argument("--seed", type=int, default=1, help="of where things are placed on the first day")
    parser.add_argument("--without-views", action="store_true", help="in a browser that cannot draw them")
    given = parser.parse_args()
    given.out.mkdir(parents=True, exist_ok=True)
    with (
        tempfile.TemporaryDirectory() as kept,
        chromium(NO_GL if given.without_views else SOFTWARE_GL) as browser,
    ):
        folder = Path(kept)
        for day in range(len(DAYS)):
            ago, seed = len(DAYS) - 1 - day, given.seed + DRIVES * day
            options = ("--days-ago", str(ago), "--task", TASK, "--seed", str(seed))
            with served(None, folder, options, ON_DAY) as site:
                drive(browser, site, day)
        with served(None, folder, ("--task", TASK)) as site:
            drives = look_back(browser, site, given.out)
            found = naming(folder, [NAME])
            print(f"{len(drives)} drives; {len(found)} files name {NAME} before the deletion.")
            person = erase(browser, site)
            left = naming(folder, [NAME, person, *drives])
        # The server has ended, and nothing can be brought back any more.
        left += naming(folder, [NAME, person, *drives])
        left += [path for path in (folder / FOLDER).rglob("*") if path.is_file()]
        files = sorted(str(path.relative_to(folder)) for path in folder.rglob("*") if path.is_file())
    print(f"{len(left)} files are left of them. In the server's folder: {', '.join(files)}.")
    if left:
        raise SystemExit("\n".join(map(str, left)))


if __name__ == "__main__":
    main()
