"""Check the fit on the real page, by keyboard and by one switch: no arm is asked for anything."""

import json
import re

import httpx
import numpy as np
import pytest

from .test_gamepads import PADS

SENT = """
{
  window.sent = [];
  const send = WebSocket.prototype.send;
  WebSocket.prototype.send = function (text) {
    if (typeof text === "string") window.sent.push(JSON.parse(text).type);
    return send.call(this, text);
  };
}
"""
SHAKING_PAD = """
plug(0);
window.base = [0.02, 0];
setInterval(() => {
  pads[0].axes = [base[0] + 0.15 * Math.sin((2 * Math.PI * 5 * performance.now()) / 1000), base[1], 0];
}, 4);
"""
PRESSES = 8
REACTS_MS = 350
KEPT = "JSON.parse(localStorage[`latentarm.settings.${JSON.parse(localStorage['latentarm.person']).id}`])"


@pytest.fixture
def fitted(chromium, address, arm):
    """Opens the page as this person; at the end the arm is where it was, and only Stop was sent."""
    opened, errors = [], []

    def fitted(name):
        headers = {"origin": address}
        person = httpx.post(f"{address}/records/people", json={"name": name}, headers=headers).json()
        page = chromium.new_context(viewport={"width": 1280, "height": 720}).new_page()
        page.on("pageerror", lambda error: errors.append(str(error)))
        seat = f"localStorage['latentarm.person'] ??= {json.dumps(json.dumps(person))};"
        page.add_init_script(SENT + PADS + seat)
        page.goto(f"{address}/fit")
        page.locator("#status:not([data-phase=connecting], [data-phase=lost])").wait_for()
        opened.append((page, arm.tool))
        return page, person["id"]

    yield fitted
    for page, tool in opened:
        assert set(page.evaluate("sent")) <= {"hello", "stop"}
        assert not arm.enabled
        assert np.array_equal(arm.tool, tool)
        page.context.close()
    assert errors == []


def press_lit(page, ids, gone):
    """Press the switch when one of these is lit, until something is gone; which one it was."""
    while True:
        lit = page.locator(", ".join(f"#{one}.lit" for one in ids)).first
        lit.wait_for(timeout=60_000)
        pressed = lit.get_attribute("id")
        page.wait_for_timeout(REACTS_MS)
        page.keyboard.press("Enter", delay=80)
        page.wait_for_timeout(500)
        if not page.locator(gone).is_visible():
            return pressed


def test_by_keyboard_the_computer_is_measured_and_next_time_compared(fitted, address):
    page, person = fitted("Fit by keys")
    for said in ("Measured for the first time", "since"):
        page.locator("input[value=keys]").focus()
        page.keyboard.press("ArrowDown")
        page.keyboard.press("ArrowUp")
        for _ in range(10):
            page.keyboard.press("Tab")
            if page.evaluate("document.activeElement.id") == "fit-begin":
                break
        page.keyboard.press("Enter")
        page.locator("#fit-task", has_text="eight times").wait_for()
        for press in range(PRESSES):
            page.keyboard.press(["ArrowLeft", "ArrowUp"][press % 2], delay=60)
            page.wait_for_timeout(60)
        page.locator("#changes li", has_text=re.compile(said, re.IGNORECASE)).wait_for()
        page.locator("#findings li", has_text="From press to picture").wait_for()
        # Stop works here as everywhere.
        page.keyboard.press("Escape")
        page.locator("#fit-keep").focus()
        page.keyboard.press("Enter")
        page.locator("#choose").wait_for()
    assert "stop" in page.evaluate("sent")
    # It is sent within a second.
    page.wait_for_timeout(1000)
    kept = httpx.get(f"{address}/records/people/{person}").json()["settings"]["fit"]
    assert 0 < kept["keys"]["speed"] < 5000


def test_by_one_switch_scanning_is_measured_and_its_times_are_proposed(fitted, wait_in_page):
    page, _ = fitted("Fit by switch")
    page.locator("input[value=switch]").check()
    press_lit(page, ["fit-begin"], "#choose")
    before = page.evaluate(KEPT)
    presses = 0
    while page.locator("#exercise").is_visible():
        assert presses < 3 * PRESSES
        cell = page.locator("#fit-task").inner_text().split()[1]
        lit = f"document.querySelector('#scan [aria-current=true]')?.textContent === '{cell}'"
        wait_in_page(page, f"{lit} || !document.querySelector('#exercise').checkVisibility()", within_s=30.0)
        page.wait_for_timeout(REACTS_MS)
        page.keyboard.press("Enter", delay=100)
        page.wait_for_timeout(200)
        presses += 1
    page.locator("#result").wait_for()
    measured = page.evaluate(KEPT)["fit"]["switch"]
    assert measured["reaction"] >= REACTS_MS / 1000 - 0.1
    assert measured["chosen"] > 0
    page.locator("#findings li", has_text="Time on each choice").wait_for()
    # What is lit there is pressed, and the settings are kept or changed as the person says.
    uses = press_lit(page, ["fit-use", "fit-keep"], "#result") == "fit-use"
    after = page.evaluate(KEPT)["dwellS"]
    assert after >= measured["reaction"] if uses else after == before["dwellS"]


def test_a_gamepad_shows_drift_shaking_and_range_and_what_is_proposed_is_used(fitted):
    page, _ = fitted("Fit by pad")
    page.evaluate(f"() => {{ {SHAKING_PAD} }}")
    page.locator("input[value=pad]").check()
    page.locator("#fit-begin").click()
    # Up is the pad's negative second axis. Left is not tried.
    for task, push in (("Right", "[0.8, 0]"), ("Up", "[0, -0.7]"), ("Left", None), ("Down", "[0, 0.75]")):
        page.locator("#fit-task", has_text=task).wait_for(timeout=40_000)
        if push is None:
            page.locator("#fit-skip").click()
        else:
            page.evaluate(f"() => {{ window.base = {push}; }}")
    found = page.locator("#findings")
    found.locator("li", has_text="5 times a second").wait_for(timeout=40_000)
    found.locator("li", has_text="Too little was measured").wait_for()
    page.locator("#fit-use").click()
    page.locator("#fit-said", has_text="in use").wait_for()
    values = page.evaluate(KEPT)
    assert values["deadZone"] >= 0.15
    assert values["tremor"] != "off"
    assert values["reach"] == 1
