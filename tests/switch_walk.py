"""A random walk of a person with switches and a helper with mouse and keyboard, over all pages and dialogs.

While switches are the control, exactly one choice is lit and in sight, and a press does that alone. As
a command, in front of a server that drives a simulated arm:
``python tests/switch_walk.py http://127.0.0.1:8000 --presses 10000 --seed 1``.
"""

import argparse
import json
import random
import sys
from collections import Counter
from collections.abc import Callable
from pathlib import Path
from typing import Any

from playwright.sync_api import Error, Page, sync_playwright

SCRIPT = Path(__file__).with_name("switch_walk_page.js").read_text()
PAGES = ("", "fit", "personalise", "teach", "people", "history")
SIZES = ((1280, 720), (390, 844), (844, 390))
ARROWS = ("ArrowUp", "ArrowDown", "ArrowLeft", "ArrowRight")
HELPER_KEYS = ("Tab", "Shift+Tab", "Space", "Escape", *ARROWS, "g", "m")
SWITCH_KEYS = (("Enter", "Backspace"), ("Space", "Enter"), ("KeyR", "Space"), ("F8", "F9"))
STAY = 50
"""Steps on a page until another one is opened."""
LOOK_MS = 30
SETTLE_MS = 130
"""A page looks at its choices more often than this."""


class Walk:
    """One page, what is done to it, and what must not come of that."""

    def __init__(self, page: Page, address: str, seed: int, log: Callable[[str], None]) -> None:
        self.page, self.address, self.log = page, address, log
        self.rng = random.Random(seed)  # noqa: S311
        self.did: Counter[str] = Counter()
        self.faults: list[str] = []
        self.keys = ["Enter"]
        self.values: dict[str, Any] = {}
        self.enables = False
        """Whether the last press was on Enable."""
        page.add_init_script(SCRIPT)

    def go(self, presses: int) -> None:
        """So many presses of switches, and what a helper does between them."""
        left = 0
        while self.did["press"] < presses:
            left -= 1
            try:
                if left < 0 or not self._scans(self._snap()):
                    self._open()
                    left = STAY
                self._step()
            except Error as gone:
                # A page that is left while it is looked at.
                if not any(word in str(gone) for word in ("navigat", "destroyed", "not a function", "null")):
                    raise
                self.page.wait_for_load_state()
                self.page.wait_for_timeout(400)

    def _open(self) -> None:
        rng, page = self.rng, self.page
        width, height = rng.choice(SIZES)
        page.set_viewport_size({"width": width, "height": height})
        first, other = rng.choice(SWITCH_KEYS)
        self.values = {
            "practised": True,
            "panel": "switch",
            "switches": rng.choice("12"),
            "scan": rng.choice(["auto", "auto", "auto", "inverse", "step"]),
            "dwellS": 0.4,
            "acceptS": 0,
            "releaseS": 0,
            "switchKey": first,
            "nextKey": other,
        }
        self.keys = [first, other] if self.values["switches"] == "2" else [first]
        keep = "([values, keys]) => { localStorage.clear(); localStorage['latentarm.settings.'] = values; "
        keep += "sessionStorage.keys = keys; sessionStorage.told = '[]'; }"
        page.keyboard.press("Escape")
        page.goto(f"{self.address}/{rng.choice(PAGES)}")
        page.evaluate(keep, [json.dumps(self.values), " ".join(self.keys)])
        page.goto(f"{self.address}/{rng.choice(PAGES)}")
        page.locator("#status:not([data-phase=connecting], [data-phase=lost])").wait_for()
        page.wait_for_timeout(300)
        self._check(self._snap(), "open")

    def _step(self) -> None:
        draw = self.rng.random()
        if draw < 0.72:
            self._press()
        elif draw < 0.86:
            self._click()
        else:
            # A helper who answers a key's field gives the person another switch.
            asked = self._snap()["asking"]
            key = self.rng.choice(
                [one for one in HELPER_KEYS if one not in self.keys and not asked] or ["Escape"]
            )
            self.did["helper's key"] += 1
            self.page.keyboard.press(key)
            self.page.wait_for_timeout(SETTLE_MS)
            self._check(self._snap(), f"key {key}")

    def _click(self) -> None:
        targets = self.page.evaluate("targets()")
        if not targets:
            return
        one = self.rng.choice(targets)
        self.did["click"] += 1
        self.page.mouse.click(one["x"], one["y"])
        if one["select"]:
            # The list of a browser is not the page's: somebody who opened it closes it.
            self.page.keyboard.press("Escape")
        self.page.wait_for_timeout(SETTLE_MS)
        self._check(self._snap(), f"click {one['html']}")

    def _press(self) -> None:
        before = self._snap()
        key = self.rng.choice(self.keys)
        self.did["press"] += 1
        self.page.wait_for_timeout(self.rng.choice([0, 60, 210]))
        self.page.keyboard.press(key, delay=self.rng.choice([12, 12, 60]))
        self.page.wait_for_timeout(LOOK_MS)
        after = self._snap()
        self._check(after, f"press {key}")
        pressed = [one for one in after["told"] if "pressed" in one]
        if not pressed or any(one["kept"] for one in pressed):
            self.did["typed" if pressed else "unheard"] += 1
            return
        lit, led = pressed[-1], [one for one in after["told"] if "event" in one]
        if key == self.keys[0]:
            self.did[f"on {lit['tag'] or 'list'}"] += 1
        takes = self.values["scan"] == "auto" or self.values["switches"] == "2"
        faults = led
        # Neutral inputs go first: the order to enable may follow as late as the next press.
        enables = self.enables or any(one["pressed"] == "enable" for one in pressed)
        self.enables = lit["pressed"] == "enable"
        if any("enable" in one for one in after["told"]) and takes and not enables:
            faults.append({"enabled": lit})
        opened = set(before["open"]) ^ set(after["open"]) if before["path"] == after["path"] else set()
        if takes and ((after["toggled"] and lit["tag"] != "summary") or (opened and lit["pressed"] is None)):
            faults.append({"toggled": [*after["toggled"], *sorted(opened)]})
        if before["path"] != after["path"] and takes:
            leads = lit["tag"] in ("a", "button") or lit["pressed"].startswith(("page-", "link-", "button-"))
            if not leads:
                faults.append({"left": after["path"]})
        if faults:
            self._blame(f"press {key}", {"lit": lit, "faults": faults, "before": before, "after": after})

    def _check(self, now: dict[str, Any], did: str) -> None:
        self.log(f"{did} {now['path']} lit {now['seen']} open {now['open']} focus {now['focus'][:60]}")
        if not now["on"]:
            return
        if not _one_is_lit(now):
            self.page.wait_for_timeout(SETTLE_MS)
            again = self._snap()
            if again["on"] and not _one_is_lit(again):
                self._blame(did, {"law": "one is lit", "now": again})

    def _snap(self) -> dict[str, Any]:
        return self.page.evaluate("snap()")

    def _scans(self, now: dict[str, Any]) -> bool:
        """True while switches are the control, and as many as at first: a helper may set another number."""
        return now["on"] and now["switches"] == self.values["switches"]

    def _blame(self, did: str, why: dict[str, Any]) -> None:
        self.faults.append(f"{did} with {self.values}: {json.dumps(why)[:1500]}")
        self.log(self.faults[-1])


def _one_is_lit(now: dict[str, Any]) -> bool:
    """True if exactly one choice or row is lit and visible, and Stop can be chosen."""
    return now["lit"] == len(now["seen"]) == 1 and (now["row"] or now["lights"] <= 1) and now["stop"] > 0


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("address")
    parser.add_argument("--presses", type=int, default=10_000)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--chromium", default="/usr/bin/chromium")
    parser.add_argument("--log", type=Path, default=Path("switch_walk.log"))
    given = parser.parse_args()
    with sync_playwright() as playwright, given.log.open("w") as log:
        browser = playwright.chromium.launch(
            executable_path=given.chromium, args=["--disable-3d-apis", "--no-sandbox"]
        )
        walk = Walk(
            browser.new_page(), given.address, given.seed, lambda line: print(line, file=log, flush=True)
        )
        walk.go(given.presses)
        browser.close()
    sys.stdout.write("\n".join([f"{dict(walk.did)}, {len(walk.faults)} faults", *walk.faults[:20], ""]))
    return min(len(walk.faults), 1)


if __name__ == "__main__":
    sys.exit(main())
