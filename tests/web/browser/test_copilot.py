"""A second person slows the arm, with the driver's consent, and either ends it."""

from playwright.sync_api import expect

from .conftest import set_up


def test_a_copilot_asks_is_accepted_slows_and_ends(page, arm, open_page, press_enable):
    other = open_page()
    with set_up(other) as dialog:
        dialog.get_by_role("button", name="Ask to be co-pilot").click()
    expect(page.locator("#copilot")).to_contain_text("never make it faster")
    page.get_by_role("button", name="Say yes to").click()
    arm.wait(lambda: arm.state["copilot"] is not None)
    expect(other.locator("#copilot")).to_contain_text("You are the co-pilot")
    other.get_by_role("button", name="Slow", exact=True).filter(visible=True).click()
    arm.wait(lambda: arm.state["copilot"]["pace"] == 0.4)
    expect(page.locator("#copilot")).to_contain_text("40 % of your speed")
    press_enable(page, arm)
    other.get_by_role("button", name="Hold still").click()
    expect(page.locator("#status")).to_contain_text("holds the arm still")
    page.locator("#stick").focus()
    page.keyboard.down("ArrowUp")
    arm.stays()
    page.keyboard.up("ArrowUp")
    other.get_by_role("button", name="End co-pilot").click()
    arm.wait(lambda: arm.state["copilot"] is None)
    arm.comes_to_rest()
    assert arm.state["reason"]["code"] in ("copilot_ended", "copilot_changed", "input_late", "copilot_late")
