"""Whatever happens to the pointer, the window, the page or the gamepad: the arm stops, and stays so."""

import time

import pytest

GAMEPAD = """
window.pad = { index: 0, id: "pad", mapping: "standard", connected: true, axes: [0, 0],
  buttons: [{ pressed: false }, { pressed: false }] };
navigator.getGamepads = () => (window.pad ? [window.pad] : [null]);
"""

LOSE_PICTURE = """
window.picture = document.querySelector("#scene").getContext("webgl2").getExtension("WEBGL_lose_context");
picture.loseContext();
"""


@pytest.fixture
def push(arm, drag_stick, press_until_moving):
    """Hold the stick to one side until the arm moves."""

    def push(page):
        press_until_moving(page, arm, lambda: drag_stick(page, -0.4, 0.0), page.mouse.up)

    return push


@pytest.fixture
def tilt(arm, press_until_moving):
    """The same with a gamepad."""

    def tilt(page):
        press_until_moving(
            page,
            arm,
            lambda: page.evaluate("pad.axes = [-1, 0]"),
            lambda: page.evaluate("pad.axes = [0, 0]"),
        )

    return tilt


def test_nothing_moves_before_enable(page, arm, drag_stick):
    drag_stick(page, -0.4, 0.4)
    arm.stays()
    page.mouse.up()


def test_letting_go_outside_the_window_stops_the_arm(enabled, arm, push):
    push(enabled)
    enabled.mouse.move(-80, -80)
    enabled.mouse.up()
    arm.is_let_go()


@pytest.mark.parametrize(
    ("fault", "said"),
    [
        ("window.dispatchEvent(new Event('blur'))", "no longer in front"),
        ("document.getElementById('stick').releasePointerCapture(1)", "lost track of the finger"),
        (
            "Object.defineProperty(document, 'hidden', { value: true, configurable: true });"
            "document.dispatchEvent(new Event('visibilitychange'));"
            "Object.defineProperty(document, 'hidden', { value: false, configurable: true })",
            "was hidden",
        ),
        (LOSE_PICTURE, "picture of the arm was gone"),
    ],
)
def test_a_doubtful_page_stops_the_arm_until_it_is_enabled_again(
    enabled, arm, push, press_enable, fault, said
):
    push(enabled)
    enabled.evaluate(fault)
    arm.comes_to_rest()
    enabled.get_by_role("status").get_by_text(said).wait_for()
    # Still held, and moved: nothing is armed by that.
    enabled.mouse.move(300, 300, steps=3)
    arm.stays()
    enabled.mouse.up()
    press_enable(enabled, arm)
    push(enabled)
    enabled.mouse.up()


def test_a_picture_that_was_lost_is_drawn_again(page):
    def drawn():  # letters of the picture
        return page.evaluate("document.querySelector('#scene').toDataURL().length")

    page.locator(".label").first.wait_for(state="attached")
    at_first = drawn()
    page.evaluate(LOSE_PICTURE)
    page.locator("#scene-lost", has_text="cannot draw").wait_for()
    assert drawn() < at_first / 2
    page.evaluate("picture.restoreContext()")
    page.locator("#scene-lost").wait_for(state="hidden")
    end_s = time.monotonic() + 10.0
    while drawn() < at_first / 2:
        assert time.monotonic() < end_s, "the arm was not drawn again"


def test_another_window_in_front_stops_the_arm(enabled, arm, push):
    # Playwright lets every page believe that it has the focus, until it is told not to.
    session = enabled.context.new_cdp_session(enabled)
    session.send("Emulation.setFocusEmulationEnabled", {"enabled": False})
    push(enabled)
    other = enabled.context.new_page()
    other.bring_to_front()
    arm.comes_to_rest()


def test_a_closed_page_stops_the_arm(enabled, arm, push):
    push(enabled)
    enabled.close()
    arm.comes_to_rest()
    assert arm.state["driver"] is None


def test_a_page_that_hangs_stops_the_arm(enabled, arm, push):
    push(enabled)
    enabled.evaluate(
        "setTimeout(() => { const end = performance.now() + 1500; while (performance.now() < end); })"
    )
    arm.comes_to_rest()
    time.sleep(1.2)
    arm.stays()


def test_a_gamepad_that_is_pulled_out_stops_the_arm(open_page, seat, arm, press_enable, tilt):
    page = seat(open_page(GAMEPAD), arm)
    press_enable(page, arm)
    tilt(page)
    page.evaluate("window.pad = null")
    arm.comes_to_rest()
    page.get_by_role("status").get_by_text("gamepad was disconnected").wait_for()


def test_a_gamepad_that_is_pushed_when_the_arm_is_enabled_moves_nothing_until_it_was_let_go(
    open_page, seat, arm, press_enable, tilt
):
    page = seat(open_page(GAMEPAD), arm)
    press_enable(page, arm)
    tilt(page)
    page.keyboard.press("Space")
    arm.comes_to_rest()
    press_enable(page, arm)
    page.get_by_role("status").get_by_text("is not at rest").wait_for()
    arm.stays()
    page.evaluate("pad.axes = [0, 0]")
    page.wait_for_timeout(200)
    press_enable(page, arm)
    tilt(page)
