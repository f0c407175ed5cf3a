"""Simulated people take a study in a real browser at once, far away, late, with wrong answers and drop-outs.

Twelve are a command: ``LATENTARM_STUDY_PEOPLE=12 python -m pytest tests/web/browser/test_study_together.py``.
"""

import asyncio
import json
import os
import random
from contextlib import suppress
from pathlib import Path
from typing import final

import pytest
from playwright.async_api import Browser, Error, Page, async_playwright

from latentarm.cli import main
from latentarm_research.user_studies.catalogue import load_definition
from latentarm_research.user_studies.recorded import DATABASE, read_recorded
from latentarm_research.user_studies.serving.store import Store
from study_line import far_away
from study_participant import next_link, serving

from .conftest import SOFTWARE_GL, find_chromium

PEOPLE = int(os.environ.get("LATENTARM_STUDY_PEOPLE", "3"))
"""Number of participants; two drive at once."""
EACH_WAY_S = 0.075
SIZES = ((1280, 720), (844, 390), (390, 844))
ARRIVES_S = 5.0
"""Each comes so much later than the one before, at most."""
SHARED = {"round_trip_ms": 500.0, "jitter_ms": 500.0}
"""Limits of the check of a device: all browsers and the server share the processors here."""
WITHIN_MS = 900_000
"""The last one waits for the drives of all others."""
RIGHT, WRONG = 2, 1
STATE = """document.readyState === "loading" ? "sends" : !document.body.dataset.sends ? "gone"
  : document.querySelector(".problem").hidden ? "sends" : "lost\""""
"""`gone` once the next page is there, `lost` if the page shows a problem, `sends` otherwise."""
UNDERSTOOD = {
    "name": "stop",
    "text": "When may you stop?",
    "options": ["at the end", "always"],
    "attention": RIGHT,
}


@final
class Person:
    """Somebody who takes the whole study."""

    def __init__(self, browser: Browser, link: str, number: int) -> None:
        self.browser, self.link = browser, link
        self.rng = random.Random(number)  # noqa: S311
        self.dropped = 0
        self.faults: list[str] = []

    async def takes_part(self) -> None:
        await asyncio.sleep(self.rng.uniform(0.0, ARRIVES_S * PEOPLE))
        width, height = self.rng.choice(SIZES)
        context = await self.browser.new_context(viewport={"width": width, "height": height})
        page = await self._arrives(await context.new_page())
        does = {
            "consent": self.consent, "device": self.check, "comprehension": self.answer_wrongly_first,
            "practice": self.ready, "trial": self.drive, "questions": self.answer,
        }  # fmt: skip
        while (part := await page.locator("body").get_attribute("data-part")) != "finished":
            assert part is not None
            await page.wait_for_timeout(self.rng.uniform(0.0, 1500.0))
            await does[part](page)
            if part == "trial" and not page.is_closed():
                await page.wait_for_url("**/study", timeout=WITHIN_MS)
            if page.is_closed():
                await asyncio.sleep(self.rng.uniform(0.0, 3.0))
                page = await self._arrives(await context.new_page())
        await context.close()

    async def _arrives(self, page: Page) -> Page:
        page.on("pageerror", lambda error: self.faults.append(str(error)))
        await page.goto(self.link, timeout=WITHIN_MS)
        return page

    async def _send(self, page: Page, to: str) -> None:
        """Press the button of a form, again where the page says that the server cannot be reached."""
        state = "lost"
        # Before its script is there a form does nothing.
        await page.wait_for_load_state("domcontentloaded", timeout=WITHIN_MS)
        await page.evaluate("document.body.dataset.sends = 'yes'")
        while state != "gone":
            if state == "lost":
                # A click by the mouse would wait for the next page, however long that takes.
                await page.locator(f"form[data-to={to}] button").evaluate("one => one.click()")
                state = "sends"
            await page.wait_for_timeout(100)
            with suppress(Error):  # the next page is coming
                state = await page.evaluate(STATE)

    async def consent(self, page: Page) -> None:
        await page.get_by_role("checkbox").check()
        await self._send(page, "consent")

    async def check(self, page: Page) -> None:
        await self._send(page, "device")

    async def answer_wrongly_first(self, page: Page) -> None:
        again = await page.locator("[role=status]:not([hidden])").count()
        await page.locator(f"input[value='{RIGHT if again else WRONG}']").check()
        await self._send(page, "comprehension")

    async def ready(self, page: Page) -> None:
        await self._send(page, "ready")

    async def answer(self, page: Page) -> None:
        for item in await page.locator("fieldset").all():
            if self.rng.random() < 0.9:
                await item.get_by_role("radio").nth(self.rng.randrange(7)).check()
        await self._send(page, "answers")

    async def drive(self, page: Page) -> None:
        """Drive until the study's page comes back, or close the page on the way."""
        await self._send(page, "begin")
        with suppress(Error):  # the drive is over, and its page has gone
            await page.locator("#status[data-phase=disengaged]").wait_for()
            await page.locator("#stick").focus()
            while not page.url.endswith("/study"):
                await page.keyboard.press("Enter")
                await page.wait_for_timeout(300)
                key = self.rng.choice(["ArrowUp", "ArrowLeft", "ArrowRight"])
                await page.keyboard.down(key)
                await page.wait_for_timeout(self.rng.uniform(500.0, 1500.0))
                if self.dropped < 2 and self.rng.random() < 0.2:
                    self.dropped += 1
                    await page.close()
                    return
                await page.keyboard.up(key)


def test_people_far_away_take_part_in_browsers_at_once(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    study, out = tmp_path / "bites.json", tmp_path / "people"
    given = load_definition("eating").as_json()
    study.write_text(
        json.dumps(
            {**given, "name": "bites", "people": PEOPLE, "comprehension": [UNDERSTOOD], "device": SHARED}
        )
    )

    async def everybody(link: str) -> list[Person]:
        sandbox = ("--no-sandbox",) if os.getuid() == 0 else ()
        origin = link.partition("/study")[0]
        server = origin.removeprefix("http://")
        with far_away(origin, EACH_WAY_S) as port:
            async with async_playwright() as playwright:
                args = [*SOFTWARE_GL, *sandbox, f"--host-resolver-rules=MAP {server} 127.0.0.1:{port}"]
                browser = await playwright.chromium.launch(executable_path=find_chromium(), args=args)
                people = [Person(browser, next_link(out, number), number) for number in range(PEOPLE)]
                await asyncio.gather(*(one.takes_part() for one in people))
                await browser.close()
        return people

    with serving(str(study), "--out", str(out), "--at-once", "2") as (link, _):
        people = asyncio.run(everybody(link))
    assert [one.faults for one in people] == [[]] * PEOPLE
    recorded = read_recorded(out)
    assert sorted(recorded.met) == list(range(PEOPLE))
    assert len(recorded.trials) == 8 * PEOPLE
    store = Store(out / DATABASE)
    kept = store.people()
    store.close()
    assert all(one.finished and one.comprehension == (False, True) for one in kept)
    assert all(one.device["round_trip_ms"] >= 2000.0 * EACH_WAY_S for one in kept)
    drives = [
        (one.number, drive.order, drive.task, drive.trial, drive.choice)
        for one in kept
        for drive in one.drives
    ]
    assert len(drives) == len(set(drives)) == 8 * PEOPLE
    capsys.readouterr()
    assert main(["study", "replay", str(out), "--json"]) == 0
    assert json.loads(capsys.readouterr().out) == {"drives": 8 * PEOPLE, "differ": 0}
    assert main(["study", "analyse", str(out), "--out", str(tmp_path / "report")]) == 0
    report = (tmp_path / "report" / "report.html").read_text()
    assert f"{PEOPLE} real people (preset smoke)" in report
    assert "0 answered all questions about it right at the first try." in report
