"""What people read is true for them: who drives, who watches, who is cut off, and who finds no room."""

import json
import re
from contextlib import ExitStack

import pytest
from playwright.sync_api import expect
from websockets.sync.client import connect

from .conftest import control_with

CUT = """
const Real = window.WebSocket;
window.sockets = [];
window.cutOff = () => { window.cut = true; window.sockets.forEach((one) => one.close()); };
window.WebSocket = class extends Real {
  constructor(url) {
    if (window.cut) return Object.assign(new EventTarget(), { readyState: 0, close() {}, send() {} });
    super(url);
    window.sockets.push(this);
  }
};
"""
"""A page that can be cut off from its server for good."""

GAMEPAD = """
window.pad = { index: 0, id: "pad", mapping: "standard", connected: true, axes: [0, 0],
  buttons: [{ pressed: false }, { pressed: false }] };
navigator.getGamepads = () => [window.pad];
"""


@pytest.fixture
def stop_for(arm, press_enable):
    """Stop an enabled arm for a reason, again where a busy computer has stopped it for another one."""

    def stop_for(page, code, act):
        for _ in range(8):
            press_enable(page, arm)
            act()
            arm.comes_to(lambda: not arm.enabled, 1.5)
            if arm.state["reason"] is not None and arm.state["reason"]["code"] == code:
                return
        raise AssertionError(arm.state["reason"])

    return stop_for


def reads(page, words):
    expect(page.locator("#status-text")).to_have_text(re.compile(words))


class TestCutOff:
    def test_a_watcher_is_not_told_that_the_arm_stops(self, enabled, arm, open_page, hold_key):
        watcher = open_page(CUT)
        hold_key(enabled)
        watcher.evaluate("cutOff()")
        reads(watcher, "^The connection is lost. What you see is old: the arm may be moving")
        assert arm.state["phase"] == "moving" or "input_late" in str(arm.state["reason"])
        enabled.keyboard.up("ArrowLeft")

    def test_a_driver_is_told_that_the_arm_stopped(self, open_page, seat, arm, press_enable):
        page = seat(open_page(CUT), arm)
        press_enable(page, arm)
        page.evaluate("cutOff()")
        reads(page, "^The connection is lost, so the arm stopped")
        arm.comes_to_rest()


def test_a_page_that_finds_no_room_says_so_and_comes_in_when_there_is(chromium, address, arm):
    with ExitStack() as stack:
        others = []
        arm.wait(lambda: arm.state["watchers"] == 1)
        for _ in range(15):
            socket = stack.enter_context(connect(f"{address.replace('http', 'ws', 1)}/drive", origin=address))
            socket.send(json.dumps({"type": "hello", "version": 1}))
            others.append(socket)
        context = chromium.new_context()
        page = context.new_page()
        page.goto(address)
        reads(page, "^There is no room: 16 pages are open already. Close one of them")
        # Said without a break while the page tries again.
        page.wait_for_timeout(1500)
        reads(page, "^There is no room")
        others[0].close()
        reads(page, "Nobody is driving. Press Enable to drive.")
        context.close()


def test_stop_names_oneself_and_the_others(page, open_page, stop_for):
    watcher = open_page()
    stop_for(page, "stop_pressed_by", lambda: page.keyboard.press("Space"))
    reads(page, "^You pressed Stop. Press Enable to move the arm.$")
    reads(watcher, r"^Guest \d+ pressed Stop. Guest \d+ is driving; you are watching.$")
    stop_for(page, "stop_pressed_by", lambda: watcher.keyboard.press("Space"))
    reads(watcher, "^You pressed Stop. ")
    reads(page, r"^Guest \d+ pressed Stop. Press Enable")
    # It is known after the page was loaded anew, too.
    watcher.reload()
    reads(watcher, "^You pressed Stop. ")


def test_a_page_that_is_left_is_not_said_to_have_pressed_stop(page, open_page, stop_for):
    watcher = open_page()
    stop_for(page, "page_stopped", lambda: page.evaluate("window.dispatchEvent(new Event('blur'))"))
    reads(page, "this window is no longer in front")
    reads(watcher, r"^Guest \d+'s page stopped the arm: the page was left, or a control was lost")


def test_the_button_of_a_watcher_says_that_it_asks(page, arm, open_page):
    watcher, third = open_page(), open_page()
    button = watcher.locator("#enable")
    expect(button).to_have_text("Ask to drive")
    expect(button).to_be_enabled()
    # Enter enables; it asks nobody for anything.
    watcher.locator("#stick").focus()
    watcher.keyboard.press("Enter")
    reads(watcher, "^You are watching. Press “Ask to drive” first.$")
    assert arm.state["asking"] is None
    button.click()
    expect(button).to_have_text("You have asked")
    expect(button).to_be_disabled()
    reads(watcher, r"You have asked to drive: wait until Guest \d+ hands over.$")
    expect(third.locator("#enable")).to_be_disabled()
    expect(third.locator("#driver")).to_contain_text("has asked to drive already")
    page.get_by_role("button", name="Hand over to").click()
    reads(watcher, "Press Enable to move the arm.$")
    reads(page, "is driving; you are watching.$")
    expect(button).to_have_text("Enable")
    expect(page.locator("#enable")).to_have_text("Ask to drive")


def test_a_press_of_a_watcher_says_what_to_do(enabled, open_page):
    watcher = open_page()
    control_with(watcher, "Buttons")
    up = watcher.get_by_role("button", name="Up", exact=True)
    expect(up).to_be_disabled()
    up.click(force=True)
    reads(watcher, "^You are watching. Press “Ask to drive” first.$")


HANG = "setTimeout(() => { const end = performance.now() + 900; while (performance.now() < end); })"


def test_a_slow_computer_is_named(page, arm, open_page, stop_for):
    watcher = open_page()
    for _ in range(5):
        stop_for(page, "input_late", lambda: page.evaluate(HANG))
        page.wait_for_timeout(800)
        # A busy computer may have stopped it before the page hung.
        if "Your computer" in page.locator("#status-text").inner_text():
            break
    reads(page, "^Your computer was too slow for a moment, so the arm stopped. Press Enable")
    reads(watcher, "^The driver's computer or connection was too slow for a moment, so the arm stopped")


@pytest.fixture
def latched(page, arm, press_enable):
    """A page whose arm moves on by itself."""
    page.evaluate("localStorage.clear()")
    control_with(page, "Buttons")
    page.get_by_role("button", name="Settings").click()
    page.get_by_role("radio", name="moves the arm until I press again").check()
    page.get_by_role("button", name="Done").click()
    for _ in range(8):
        press_enable(page, arm)
        page.get_by_role("button", name="Up", exact=True).click()
        if arm.comes_to(lambda: arm.state["phase"] == "moving", 1.0):
            return page
    raise AssertionError(arm.state["reason"])


@pytest.mark.parametrize(
    "opens",
    [
        "click",
        "keyboard",
        "document.getElementById('settings').showModal()",
        "document.getElementById('settings').show()",
        "document.getElementById('settings').setAttribute('open', '')",
        "document.body.append(Object.assign(document.createElement('dialog'), { open: true }))",
    ],
)
def test_a_dialog_stops_what_goes_on_by_itself(latched, arm, opens):
    if opens == "click":
        latched.locator("#settings-open").click()
    elif opens == "keyboard":
        latched.locator("#settings-open").focus()
        latched.keyboard.press("Enter")
    else:
        latched.evaluate(opens)
    arm.comes_to_rest()
    arm.stays()
    reads(latched, "a window opened on this page. Close the window|too slow for a moment")


def test_nothing_is_enabled_behind_a_dialog(open_page, seat, arm):
    page = seat(open_page(GAMEPAD), arm)
    page.locator("#settings-open").click()
    page.evaluate("document.getElementById('enable').click()")
    page.evaluate("pad.buttons[0].pressed = true")
    assert not arm.comes_to(lambda: arm.enabled, 1.5)


@pytest.mark.parametrize("how", ["key", "choice"])
def test_a_held_stick_does_nothing_in_a_new_mode_before_it_is_let_go(enabled, arm, hold_key, how):
    for _ in range(5):
        hold_key(enabled)
        if how == "key":
            enabled.keyboard.press("m")
        else:
            enabled.get_by_role("radio", name="Straight lines").check()
        if arm.comes_to(lambda: arm.state["let_go_first"] and arm.state["phase"] == "ready", 1.5):
            break
        enabled.keyboard.up("ArrowLeft")
        enabled.get_by_role("radio", name="Learned").check()
        arm.wait(lambda: arm.state["mode"] == "assisted")
    if arm.enabled:
        reads(enabled, "^Let go of everything first, then push again.$")
    arm.stays()
    enabled.keyboard.up("ArrowLeft")
    arm.wait(lambda: not arm.state["let_go_first"])
    hold_key(enabled)
    enabled.keyboard.up("ArrowLeft")


def test_what_goes_on_by_itself_ends_with_a_new_mode(latched, arm):
    latched.get_by_role("radio", name="Straight lines").check()
    arm.wait(lambda: arm.state["phase"] != "moving", 1.0)
    arm.stays()
    expect(latched.get_by_role("button", name="Up", exact=True)).to_have_attribute("aria-pressed", "false")
