"""Pictures of every page and state: for desks and phones, light, dark and forced colours, in each language.

The run is driven by a script for them: a simulated person; some states are made by changing what the server
says. A contact sheet shows all pictures of the folder, a row for each state and a column for each look:

    python scripts/teleop_screenshots.py RUN --out pictures --only drive --looks laptop-light-en phone-dark-de

With ``--tree FILE`` the pages are written as a screen reader has them instead, in English on a laptop.
"""

import argparse
import itertools
import json
import re
import shutil
import subprocess
import tempfile
import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from datetime import date
from pathlib import Path
from typing import Any

from PIL import Image, ImageDraw, ImageFont
from playwright.sync_api import Browser, Locator, Page, WebSocketRoute
from playwright.sync_api import Error as PlaywrightError

from latentarm.web.protocol.personalise_messages import Personalise
from latentarm.web.words.catalogue import COOKIE, Words, languages
from teleop_page import chromium, drive_back, enable, served

SIZES = {
    "desk": (1440, 900),
    "laptop": (1280, 720),
    "phone": (390, 844),
    "side": (844, 390),
    "zoomed": (640, 360),
}
"""Of the page, CSS pixels; ``zoomed`` is a laptop at 200 %, ``side`` a phone on its side."""
SCHEMES: dict[str, dict[str, Any]] = {
    "light": {"color_scheme": "light", "forced_colors": "none"},
    "dark": {"color_scheme": "dark", "forced_colors": "none"},
    "forced": {"color_scheme": "dark", "forced_colors": "active"},
}
CROSS = (
    "laptop-light-en",
    "laptop-dark-de",
    "laptop-forced-en",
    "laptop-light-es",
    "laptop-light-zh",
    "phone-light-en",
    "phone-dark-de",
    "phone-light-zh",
    "side-light-en",
    "side-dark-es",
    "zoomed-light-en",
)
"""Looks in which each size, scheme and language is there."""

TILE = (200, 160)
GAP = 6
MARGIN = 150
PERSON = "Ada"
SETTLE_MS = 800
EPISODES = 3
MOST_STARTS = 5
LEARNING_MS = 120_000
EXERCISE_S = 25.0
TREES = {
    "Drive": ("drive-ready", "body"),
    "Drive, with a switch": ("drive-switch", "#controls"),
    "Drive, settings": ("drive-settings", "#settings"),
    "Check the fit": ("fit", "main"),
    "Personalise, a question": ("personalise-question", "main"),
    "Teach": ("teach-none", "main"),
    "People": ("people", "main"),
    "History": ("history", "main"),
}
"""Pages as a screen reader has them: of which state, and which part: what surrounds it is the same on all."""
LEARNED = Personalise(phase="learned", name=PERSON, answers=10, error=0.13, error_without=0.84).model_dump()
PASSING = ("drive", "drive-ready")
"""States that end by themselves, or when the page is sized anew: reached for each picture."""
BEGUN = "#answer-cancel, #working-cancel, #discard, #trial-discard"


@dataclass(frozen=True)
class Visit:
    """A page that is visited in some language.

    Attributes:
        page: as the browser has it.
        words: its texts.
    """

    page: Page
    words: Words

    def button(self, key: str) -> Locator:
        """The button with this text."""
        return self.page.get_by_role("button", name=self.words.say(key), exact=True)

    def mode(self, name: str) -> None:
        """Choose what the stick moves."""
        self.page.get_by_role("radio", name=self.words.say(f"modes.{name}"), exact=True).check()

    def choose(self, name: str, value: str) -> None:
        """Choose one of several."""
        self.page.locator(f"input[name={name}][value={value}]").evaluate("one => one.click()")


def fresh(visit: Visit) -> None:
    """The Drive page as a new person finds it."""


def open_with_state(
    visit: Visit, path: str = "", learned: Mapping[str, Any] | None = None, **changes: Any
) -> None:
    """Open a page, with some fields of the server's states replaced, or what is learned of a person."""

    def hear(socket: WebSocketRoute) -> None:
        def changed(text: str | bytes) -> None:
            said = json.loads(text)
            if said["type"] == "state":
                merge(said, changes)
            if said["type"] == "learning" and learned:
                said["personalise"] = learned
            socket.send(json.dumps(said))

        socket.connect_to_server().on_message(changed)

    visit.page.route_web_socket("**/drive", hear)
    visit.page.goto(f"{visit.page.url}{path}")
    visit.page.locator(".label").first.wait_for(state="attached")


def merge(into: dict[str, Any], changes: dict[str, Any]) -> None:
    """Replace parts of a message, at any depth; things are left out of it while they stand still."""
    for key, value in changes.items():
        if isinstance(value, dict) and isinstance(into.get(key), dict):
            merge(into[key], value)
        elif key != "things":
            into[key] = value


def skip_practice(visit: Visit) -> None:
    """Skip it, where it is still offered."""
    if visit.button("practice.skip").is_visible():
        visit.button("practice.skip").click()


def ready(visit: Visit) -> None:
    """Enabled, and nothing pressed."""
    skip_practice(visit)
    enable(visit.page)


def held_back(visit: Visit) -> None:
    """Slower than asked, and why."""
    open_with_state(visit, phase="moving", held_back="joint_position")


def done(visit: Visit) -> None:
    """The task is done."""
    open_with_state(visit, task={"outcome": "success", "time_s": 41.0})


def failed(visit: Visit) -> None:
    """Something was spilled."""
    open_with_state(visit, task={"outcome": "failure", "why": {"code": "spilled", "thing": "cup"}})


def copilot_asks(visit: Visit) -> None:
    """Somebody asks to be co-pilot, and somebody else to drive."""
    open_with_state(visit, copilot_asking={"id": "b", "name": PERSON}, asking="c", asking_name=2)


def unconnected(visit: Visit) -> None:
    """A real arm that has lost its connection."""
    open_with_state(visit, lost=True, phase="disengaged", reason={"code": "arm_off", "parameters": {}})


def disconnected(visit: Visit) -> None:
    """The page of who drove has lost the server."""
    sockets: list[WebSocketRoute] = []

    def hear(socket: WebSocketRoute) -> None:
        sockets.append(socket)
        if len(sockets) == 1:
            socket.connect_to_server()
        else:
            socket.close()

    visit.page.route_web_socket("**/drive", hear)
    visit.page.goto(visit.page.url)
    ready(visit)
    sockets[0].close()
    visit.page.locator("#status[data-phase=lost]").wait_for()


def things_to_tell(visit: Visit) -> None:
    """Drive at a task with things: touch-to-locate buttons and saved poses."""
    seen = [("cup", "seen", 7.0), ("plate", "unseen", 0.0), ("bowl", "doubted", 1.0)]
    things = [{"name": name, "seen": how, "age_s": age, "source": "tag"} for name, how, age in seen]
    open_with_state(visit, things={"seen": things})
    visit.page.locator("#poses-open").click()


def fit(visit: Visit) -> None:
    """Check the fit, as a person finds it."""
    visit.page.goto(f"{visit.page.url}fit")


def fit_exercise(visit: Visit) -> None:
    """An exercise of a hand."""
    fit(visit)
    visit.page.locator("#fit-begin").click()


def fit_result(visit: Visit) -> None:
    """The result page after a hand has done every exercise."""
    page = visit.page
    size = page.viewport_size
    # A small picture is drawn without a pause: after one an exercise begins anew.
    page.set_viewport_size({"width": 360, "height": 480})
    fit_exercise(visit)
    for to in ((0.0, 0.0), (0.9, 0.0), (0.0, 0.8), (-0.7, 0.0), (0.0, -0.6)):
        task = page.locator("#fit-task")
        before = task.inner_text()
        push(page, *to)
        end_s = time.monotonic() + EXERCISE_S
        while task.is_visible() and task.inner_text() == before and time.monotonic() < end_s:
            page.wait_for_timeout(100)
        page.mouse.up()
        if task.is_visible() and task.inner_text() == before:
            page.locator("#fit-skip").click()
    page.locator("#result").wait_for()
    if size:
        page.set_viewport_size(size)


def driving(visit: Visit) -> None:
    """With help, under way to a goal; the stick stays pushed."""
    page = visit.page
    skip_practice(visit)
    enable(page)
    page.evaluate("scrollTo(0, 0)")
    box = page.locator("#stick").bounding_box()
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


def practising(visit: Visit) -> None:
    """The guided practice, with its first step to do."""
    visit.button("practice.begin").click()


def buttons(visit: Visit) -> None:
    """The direction buttons."""
    visit.choose("panel", "dpad")


def switch(visit: Visit) -> None:
    """What one switch chooses from."""
    visit.choose("panel", "switch")
    enable(visit.page)
    visit.page.wait_for_timeout(1500)


def explained(visit: Visit) -> None:
    """Explanations, opened."""
    settings(visit)
    visit.page.locator(".explain").evaluate_all("all => all.forEach((one) => { one.open = true; })")


def settings(visit: Visit) -> None:
    """The settings."""
    visit.button("settings.title").click()


def recorded(visit: Visit) -> None:
    """The Teach page with recordings to learn from: the same few seconds, driven three times."""
    page = visit.page
    visit.mode("end_effector")
    while episodes(page) < EPISODES:
        before = episodes(page)
        drive_back(page)
        page.locator("#record").dispatch_event("click")
        push_for(page, 2000)
        page.keyboard.press("Escape")
        page.wait_for_timeout(600)
        page.locator("#record").dispatch_event("click")
        while episodes(page) <= before:
            page.wait_for_timeout(100)
    page.goto(f"{page.url}teach")
    page.locator("#episodes input").nth(EPISODES - 1).wait_for()


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
    """How many are recorded, as the page says it in any language; 0 while it records."""
    if page.locator("#record-teach").get_attribute("hidden") is not None:
        return 0
    number = re.search(r"\d+", page.locator("#record-text").text_content() or "")
    return int(number.group()) if number else 0


def nothing_recorded(visit: Visit) -> None:
    """The Teach page before anything was recorded."""
    visit.page.goto(f"{visit.page.url}teach")
    visit.page.locator("#train").wait_for()


def trained(visit: Visit) -> None:
    """The Teach page after a training."""
    recorded(visit)
    page = visit.page
    if page.locator("#training-drive").is_hidden():
        page.locator("#train-begin").click()
        page.locator("#training-drive, #training-why").filter(visible=True).first.wait_for(timeout=120_000)
    page.locator("#training").scroll_into_view_if_needed()


def personalise(visit: Visit) -> None:
    """The Personalise page as a person finds it."""
    visit.page.goto(f"{visit.page.url}personalise")
    visit.page.locator("#begin").wait_for()


def asked(visit: Visit) -> None:
    """A question, and an answer that is still held."""
    personalise(visit)
    page = visit.page
    page.locator("#begin input[name=person]").fill("Ada")
    page.locator("#begin select").select_option("6")
    page.locator("#begin button[type=submit]").click()
    page.locator("#asking").wait_for(timeout=LEARNING_MS)
    push_aside(page)


def refused(visit: Visit) -> None:
    """What comes of the same answer to every question."""
    asked(visit)
    page = visit.page
    page.mouse.up()
    while page.locator("#asking, #working").filter(visible=True).count():
        if page.locator("#stick").is_visible():
            push(page, 0.6, 0.2)
            page.mouse.up()
            page.locator("#answer-send").click()
        page.wait_for_timeout(600)
    page.locator("#refused").wait_for()


def learned(visit: Visit) -> None:
    """A person's directions have been learned."""
    open_with_state(visit, "personalise", LEARNED)
    visit.page.locator("#learned").wait_for()


def tried(visit: Visit) -> None:
    """What was learned, under trial."""
    open_with_state(visit, "", LEARNED, profile=".trial")
    visit.page.locator("#trial").wait_for()


def stopped(visit: Visit) -> None:
    """After Stop, with the stick to be let go."""
    driving(visit)
    visit.page.keyboard.press("Escape")


def watching(visit: Visit) -> None:
    """A page that watches while another one drives."""
    skip_practice(visit)
    visit.page.locator("#release").dispatch_event("click")
    other = visit.page.context.new_page()
    other.goto(visit.page.url)
    other.locator("#ask").dispatch_event("click")


def people(visit: Visit) -> None:
    """The people of the server."""
    visit.page.goto(f"{visit.page.url}people")
    visit.page.locator("#people li").nth(1).wait_for()


def people_scanned(visit: Visit) -> None:
    """The people, one of whom a switch would choose."""
    visit.choose("panel", "switch")
    people(visit)
    visit.page.locator(".lit").wait_for()


def person_erased(visit: Visit) -> None:
    """What would go with a person."""
    people(visit)
    visit.page.locator("#people li").nth(1).locator("button").last.click()
    visit.page.locator("#erase").wait_for()


def history_of_nobody(visit: Visit) -> None:
    """No drives."""
    visit.page.goto(f"{visit.page.url}history")
    visit.page.locator("#filters input[name=until]").fill("2001-01-02")


def history(visit: Visit) -> None:
    """The drives."""
    visit.page.goto(f"{visit.page.url}history")
    visit.page.locator("#drives li").first.wait_for()


def replayed(visit: Visit) -> None:
    """A drive that is shown again."""
    history(visit)
    visit.page.locator("#drives li").first.locator("button").first.click()
    visit.page.locator("#replay .label").first.wait_for(state="attached")
    visit.page.locator("#replay").scroll_into_view_if_needed()


def reported(visit: Visit) -> None:
    """The report, as it is printed."""
    history(visit)
    visit.page.emulate_media(media="print")


def card(visit: Visit) -> None:
    """The card, as it is printed."""
    visit.page.emulate_media(media="print")


def tidy(page: Page) -> None:
    """End what was begun, so that the next picture finds the page as this one did."""
    page.mouse.up()
    while page.locator(BEGUN).filter(visible=True).count():
        page.locator(BEGUN).filter(visible=True).first.click()
        page.wait_for_timeout(SETTLE_MS)


def push_aside(page: Page) -> None:
    """Hold the stick to the right and a little up."""
    push(page, 0.6, 0.2)
    page.wait_for_timeout(600)


def push(page: Page, right: float, up: float) -> None:
    """Hold the stick, as shares of half its drawing."""
    box = page.locator("#stick").bounding_box()
    if box is None:
        raise SystemExit("The page has no stick.")
    page.mouse.move(box["x"] + 0.5 * box["width"], box["y"] + 0.5 * box["height"])
    page.mouse.down()
    to_x, to_y = 0.5 + 0.5 * right, 0.5 - 0.5 * up
    page.mouse.move(box["x"] + to_x * box["width"], box["y"] + to_y * box["height"], steps=3)


SHOTS: dict[str, Callable[[Visit], None]] = {
    "drive-new": fresh,
    "drive-ready": ready,
    "drive": driving,
    "drive-held-back": held_back,
    "drive-done": done,
    "drive-failed": failed,
    "drive-asked": copilot_asks,
    "drive-not-connected": unconnected,
    "drive-lost": disconnected,
    "drive-things": things_to_tell,
    "drive-stopped": stopped,
    "drive-watching": watching,
    "drive-practice": practising,
    "drive-buttons": buttons,
    "drive-switch": switch,
    "drive-explained": explained,
    "drive-settings": settings,
    "card": card,
    "personalise": personalise,
    "personalise-question": asked,
    "personalise-refused": refused,
    "personalise-learned": learned,
    "personalise-trial": tried,
    "teach-none": nothing_recorded,
    "teach": recorded,
    "teach-trained": trained,
    "fit": fit,
    "fit-exercise": fit_exercise,
    "fit-result": fit_result,
    "people": people,
    "people-switch": people_scanned,
    "people-delete": person_erased,
    "history-empty": history_of_nobody,
    "history": history,
    "history-replay": replayed,
    "history-report": reported,
}


def begin(page: Page, address: str, language: str) -> Visit:
    """The Drive page, drawn, in this language and in learned motions."""
    page.context.add_cookies([{"name": COOKIE, "value": language, "url": address}])
    page.goto(address)
    page.locator(".label").first.wait_for(state="attached")
    page.wait_for_timeout(SETTLE_MS)
    visit = Visit(page, languages()[language])
    visit.mode("latent")
    return visit


def drive_once(browser: Browser, address: str) -> None:
    """A person with a record drives for a few seconds: the history is not empty."""
    context = browser.new_context(reduced_motion="reduce")
    page = context.new_page()
    page.goto(f"{address}/people")
    page.locator("#add input").fill(PERSON)
    page.locator("#add button").click()
    page.locator("#people li").nth(1).wait_for()
    begin(page, address, "en")
    push_for(page, 2000)
    page.keyboard.press("Escape")
    drive_back(page)
    context.close()


def take(browser: Browser, address: str, name: str, language: str, looks: Sequence[str], out: Path) -> None:
    """Take pictures of a state in one language, with each size and scheme."""
    # Twice as fine: the software renderer spares pixels.
    with browser.new_context(device_scale_factor=2, reduced_motion="reduce") as context:
        page = context.new_page()
        visit = begin(page, address, language)
        drive_back(page)
        for number, look in enumerate(looks):
            size, scheme = look.split("-")
            width, height = SIZES[size]
            page.set_viewport_size({"width": width, "height": height})
            page.emulate_media(**SCHEMES[scheme])
            if number == 0 or name in PASSING:
                SHOTS[name](visit)
            page.wait_for_timeout(SETTLE_MS)
            page.screenshot(path=out / f"{name}-{look}-{language}.png")
        tidy(page)
    # So that the next page finds nobody who drives.
    time.sleep(0.3)


def write_trees(browser: Browser, address: str, file: Path) -> None:
    """Write the pages as a screen reader has them: roles, names and states."""
    git = ["git", "log", "-1", "--format=%h"]
    commit = subprocess.run(git, capture_output=True, text=True, check=True).stdout.strip()
    parts = [
        "# The pages as a screen reader has them",
        f"Generated by `python scripts/teleop_screenshots.py RUN --tree {file}`, commit {commit},"
        f" {date.today().isoformat()}: roles, names, states and texts by `aria_snapshot()`, in English at"
        " 1280 by 720. No screen reader has been used; a help behind a question mark is a `group` here.",
    ]
    for title, (name, part) in TREES.items():
        with browser.new_context(viewport={"width": 1280, "height": 720}, reduced_motion="reduce") as context:
            page = context.new_page()
            SHOTS[name](begin(page, address, "en"))
            page.wait_for_timeout(SETTLE_MS)
            parts += [f"## {title}", f"```yaml\n{page.locator(part).aria_snapshot()}\n```"]
            tidy(page)
        time.sleep(0.3)
    file.write_text("\n\n".join(parts) + "\n")


def contact_sheet(out: Path) -> None:
    """All pictures of the folder on one, small: a row for each state, a column for each look."""
    columns = [look for look in CROSS if any((out / f"{name}-{look}.png").exists() for name in SHOTS)]
    rows = [name for name in SHOTS if any((out / f"{name}-{look}.png").exists() for look in columns)]
    wide, high = TILE[0] + GAP, TILE[1] + GAP
    sheet = Image.new("RGB", (MARGIN + len(columns) * wide, 30 + len(rows) * high), "white")
    draw = ImageDraw.Draw(sheet)
    font = ImageFont.load_default(size=15)
    for column, look in enumerate(columns):
        draw.text((MARGIN + column * wide, 6), look, "black", font)
        for row, name in enumerate(rows):
            picture = out / f"{name}-{look}.png"
            if not picture.exists():
                continue
            with Image.open(picture) as whole:
                small = whole.convert("RGB")
            small.thumbnail(TILE, Image.Resampling.LANCZOS)
            sheet.paste(small, (MARGIN + column * wide, 30 + row * high))
    for row, name in enumerate(rows):
        draw.text((6, 30 + row * high), name.replace("-", "\n"), "black", font)
    sheet.save(out / "contact-sheet.webp", quality=85)


def main() -> None:
    """Take all pictures."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("run", type=Path)
    parser.add_argument("--out", type=Path, default=Path("pictures"))
    parser.add_argument("--only", nargs="+", choices=SHOTS, default=list(SHOTS))
    parser.add_argument("--looks", nargs="+", default=list(CROSS), metavar="SIZE-SCHEME-LANGUAGE")
    parser.add_argument("--tree", type=Path)
    given = parser.parse_args()
    given.out.mkdir(parents=True, exist_ok=True)
    missing: list[str] = []
    with tempfile.TemporaryDirectory() as folder:
        # What is learned for the pictures is not kept.
        run = Path(shutil.copytree(given.run, Path(folder) / given.run.name))
        with served(run) as site, chromium() as browser:
            drive_once(browser, site.address)
            if given.tree:
                write_trees(browser, site.address, given.tree)
                return
            for name, language in itertools.product(given.only, languages()):
                looks = [look.removesuffix(f"-{language}") for look in given.looks if look.endswith(language)]
                if not looks:
                    continue
                try:
                    take(browser, site.address, name, language, looks, given.out)
                except PlaywrightError as error:
                    # The other pictures are taken all the same.
                    missing.append(f"{name}-{language}: {error.message.splitlines()[0]}")
                else:
                    print(f"{name}-{language}", flush=True)
    contact_sheet(given.out)
    if missing:
        raise SystemExit("Not taken:\n" + "\n".join(missing))


if __name__ == "__main__":
    main()
