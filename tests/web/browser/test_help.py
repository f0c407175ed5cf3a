"""How much the robot helps: on at first, chosen on the page, kept, and said in words."""

from playwright.sync_api import expect

from .conftest import ask_to_drive, set_up


def levels(page):
    return page.get_by_role("group", name="Help from the robot")


def test_help_is_on_at_first_and_each_level_says_what_it_does(page, arm):
    page.locator("#settings-open").click()
    expect(levels(page).get_by_role("radio", name="Medium")).to_be_checked()
    arm.wait(lambda: (arm.state["mode"], arm.state["help"]) == ("assisted", "medium"))
    said = set()
    for label, level in [("High", "high"), ("Low", "low"), ("Off", "off"), ("Medium", "medium")]:
        levels(page).get_by_role("radio", name=label).check()
        arm.wait(lambda level=level: arm.state["help"] == level)
        arm.wait(lambda level=level: arm.state["mode"] == ("latent" if level == "off" else "assisted"))
        page.wait_for_timeout(300)
        said.add(page.locator("#help-text").inner_text())
    assert len(said) == 4
    page.locator("#settings-close").click()
    page.get_by_role("radio", name="Straight lines").check()
    expect(page.locator("#help-text")).to_contain_text("does not help")
    page.get_by_role("radio", name="Learned motions").check()
    arm.wait(lambda: arm.state["mode"] == "assisted")


def test_the_level_is_kept_for_the_person(page, arm):
    with set_up(page):
        levels(page).get_by_role("radio", name="Low").check()
        arm.wait(lambda: arm.state["help"] == "low")
    page.reload()
    ask_to_drive(page)
    with set_up(page):
        expect(levels(page).get_by_role("radio", name="Low")).to_be_checked()
    arm.wait(lambda: arm.state["help"] == "low")
