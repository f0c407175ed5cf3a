"""On every page axe finds nothing, and the keyboard and two switches reach everything that can be pressed."""

import json

import numpy as np
import pytest
from axe_playwright_python.sync_playwright import Axe
from playwright.sync_api import expect

from latentarm.web.words.catalogue import COOKIE

from .conftest import move, press_switch, set_up

NAME = "Ada"
PAGES = ("", "fit", "teach", "personalise", "people", "history")
STILL = ("fit", "teach", "people", "history")
"""Pages without a stick, at least at first."""

GUEST_SETTINGS = "latentarm.settings."
PRACTISED = {"practised": True}
TWO_SWITCHES = PRACTISED | {"panel": "switch", "switches": "2"}
MOST_KEYS = 400
MOVED_M = 0.02

# What can be pressed or filled in, as often as Tab must stop there: once for all radio buttons of a group.
CONTROLS = """(root) => {
  const kinds = 'a[href], button, input, select, summary, [tabindex="0"]';
  const all = [...document.querySelectorAll(`${root} :is(${kinds})`)];
  const groups = new Set();
  return all.filter((one) => {
    if (!one.checkVisibility() || one.disabled || one.tabIndex < 0) return false;
    if (one.type !== "radio") return true;
    const first = !groups.has(one.name);
    groups.add(one.name);
    return first;
  });
}"""
COUNT = f"(root) => {{ window.controls = ({CONTROLS})(root); return window.controls.length; }}"
FOCUSED = """() => {
  const one = document.activeElement;
  const group = (other) => other === one || (one.type === "radio" && other.name === one.name);
  const box = (one.closest("label") ?? one).getBoundingClientRect();
  const bar = document.querySelector(".action-bar").getBoundingClientRect();
  const inBar = one === document.body || one.closest(".action-bar, .page-switch, dialog") !== null;
  const under = box.left < bar.right && box.right > bar.left && box.bottom > bar.top && box.top < bar.bottom;
  return {
    number: window.controls.findIndex(group),
    html: one.outerHTML.slice(0, 120),
    seen: box.height > 0 && box.bottom > 0 && (inBar || !under),
  };
}"""


WITHOUT_TYPING = """(all) => all
  .filter((one) => !one.closest("[data-not-scanned]") && one.getAttribute("aria-disabled") !== "true")
  .filter((one) => one.type !== "submit" || one.form.checkValidity())
  .map((one) => one.getAttribute("aria-label") ?? one.textContent.trim())"""


@pytest.fixture(scope="module")
def served(start_server, tmp_path_factory):
    with start_server(tmp_path_factory.mktemp("walk"), "--task", "entree") as address:
        yield address


@pytest.fixture(scope="module")
def driven(chromium, served, watch, press_enable, add_person):
    """A server on which Ada has driven and recorded for a moment: every page has something to show."""
    context = chromium.new_context(viewport={"width": 1280, "height": 720})
    page = context.new_page()
    add_person(page, served, NAME)
    with watch(served) as arm:
        arm.wait(lambda: arm.state["driver_name"] == NAME)
        with set_up(page) as dialog:
            dialog.get_by_role("button", name="Start recording").click()
        press_enable(page, arm)
        page.locator("#stick").focus()
        begin = arm.tool
        # On a busy computer the arm stops now and then. A recording without motion is not kept.
        while np.linalg.norm(arm.tool - begin) < MOVED_M:
            move(page, arm, lambda: page.keyboard.down("ArrowUp"), lambda: page.keyboard.up("ArrowUp"))
            page.wait_for_timeout(600)
            page.keyboard.up("ArrowUp")
        page.keyboard.press("Escape")
        arm.comes_to_rest()
        page.get_by_role("button", name="Stop recording").click()
        with set_up(page) as dialog:
            dialog.get_by_role("link", name="Teach the arm from these").wait_for()
    context.close()
    return served


@pytest.fixture
def open_path(chromium, driven):
    """Opens a page as a guest, and fails the test if anything goes wrong on it."""
    contexts = []
    errors = []

    def open_path(path, values=None, **options):
        context = chromium.new_context(**{"viewport": {"width": 1280, "height": 720}, **options})
        contexts.append(context)
        context.add_cookies([{"name": COOKIE, "value": "en", "url": driven}])
        page = context.new_page()
        page.set_default_timeout(10_000)
        page.on("pageerror", lambda error: errors.append(str(error)))
        keep = f"localStorage['{GUEST_SETTINGS}'] = JSON.stringify({json.dumps(values or PRACTISED)})"
        page.add_init_script(f"if (!localStorage['{GUEST_SETTINGS}']) {keep}")
        page.goto(f"{driven}/{path}")
        page.locator("#status:not([data-phase=connecting], [data-phase=lost])").wait_for()
        if path == "history":
            page.get_by_role("button", name="Show: Tofu").first.wait_for()
        if path == "people":
            page.get_by_role("button", name=f"Choose {NAME}").wait_for()
        page.wait_for_timeout(300)
        return page

    yield open_path
    for context in contexts:
        context.close()
    assert errors == []


def found(page):
    """What axe has to say against the page."""
    violations = Axe().run(page).response["violations"]
    return [(one["id"], [node["html"] for node in one["nodes"]]) for one in violations]


def walk(page, root):
    """Press Tab until everything has had the focus: what never had it, and what stood out of sight."""
    count = page.evaluate(COUNT, root)
    reached, hidden = set(), []
    for _ in range(MOST_KEYS):
        page.keyboard.press("Tab")
        focused = page.evaluate(FOCUSED)
        if not focused["seen"]:
            hidden.append(focused["html"])
        reached.add(focused["number"])
        if len(reached - {-1}) == count:
            break
    missing = page.evaluate(
        "(reached) => window.controls.filter((_, at) => !reached.includes(at)).map((one) => one.outerHTML)",
        sorted(reached),
    )
    return missing, hidden


@pytest.mark.parametrize("scheme", ["light", "dark"])
@pytest.mark.parametrize("path", PAGES)
def test_axe_finds_nothing(open_path, path, scheme):
    page = open_path(path, color_scheme=scheme)
    assert found(page) == []


@pytest.mark.parametrize("path", PAGES)
def test_tab_reaches_everything_in_sight(open_path, path):
    page = open_path(path)
    assert walk(page, "body") == ([], [])


@pytest.mark.parametrize("path", PAGES)
def test_tab_reaches_every_setting(open_path, path):
    page = open_path(path)
    page.get_by_role("button", name="Settings").click()
    assert walk(page, "#settings") == ([], [])


def offered(page):
    return page.locator("#scan li").all_text_contents()


def go_to(page, number):
    """Move the light to the choice with this number."""
    for _ in range(60):
        if page.locator("#scan li").nth(number).get_attribute("aria-current"):
            return
        press_switch(page, "Backspace")
    raise AssertionError(f"{offered(page)[number]} is never lit")


def scanned(page, names):
    """Go through all choices and what they open; what lights up on the page goes to ``names``."""
    choices = offered(page)
    assert "Stop" in choices
    for number, name in enumerate(choices):
        if name in ("Settings …", "Other page …", "Stop", "Back"):
            continue
        go_to(page, number)
        page.wait_for_timeout(150)
        lit = page.locator(".lit")
        expect(lit).to_have_count(1)
        names.append(name)
        if name.endswith(" …") and lit.evaluate("one => one.matches('section, article, form, fieldset, li')"):
            press_switch(page, "Enter")
            page.wait_for_timeout(150)
            scanned(page, names)
            go_to(page, offered(page).index("Back"))
            press_switch(page, "Enter")
            page.wait_for_timeout(150)


@pytest.mark.parametrize("path", STILL)
def test_two_switches_reach_everything_that_can_be_pressed(open_path, path):
    page = open_path(path, TWO_SWITCHES)
    page.locator("#page-switch").wait_for()
    names = []
    scanned(page, names)
    controls = page.locator("#controls").locator("button:enabled:visible, a:visible, summary:visible")
    wanted = controls.evaluate_all(WITHOUT_TYPING)
    assert set(wanted) <= set(names)
    # And away again.
    go_to(page, offered(page).index("Other page …"))
    press_switch(page, "Enter")
    page.wait_for_timeout(150)
    go_to(page, offered(page).index("Drive"))
    press_switch(page, "Enter")
    page.locator("#enable").wait_for()


def test_a_dialog_is_scanned_too(open_path):
    page = open_path("people", TWO_SWITCHES)
    page.get_by_role("button", name=f"Delete {NAME}").click()
    page.get_by_role("dialog").wait_for()
    page.wait_for_timeout(300)
    names = offered(page)
    assert names[-1] == "Stop"
    go_to(page, names.index("Keep everything"))
    press_switch(page, "Enter")
    expect(page.get_by_role("dialog")).to_be_hidden()
    page.wait_for_timeout(300)
    assert len(offered(page)) > 3
    assert page.locator("#page-switch").evaluate("one => one.parentElement === document.body")
