"""Two people with settings of their own, in any script; and one who is deleted leaves nothing behind."""

import pytest
from playwright.sync_api import expect

NAMES = ("Zoë Müller", "李雷")


@pytest.fixture(scope="module")
def place(tmp_path_factory):
    return tmp_path_factory.mktemp("people")


@pytest.fixture(scope="module")
def served(start_server, place):
    with start_server(place, "--task", "entree", "--pin") as address:
        yield address


@pytest.fixture
def page(chromium, served):
    context = chromium.new_context(viewport={"width": 1280, "height": 720})
    page = context.new_page()
    page.set_default_timeout(20_000)
    page.goto(f"{served}/people")
    page.get_by_role("button", name="Choose Guest").wait_for()
    yield page
    context.close()


def settings(page):
    page.get_by_role("button", name="Settings").click()
    return page.locator("#settings")


def test_two_people_have_settings_of_their_own_on_every_computer(page, chromium, served):
    for name, panel in zip(NAMES, ("behind", "facing"), strict=True):
        page.locator("#add input").fill(name)
        page.get_by_role("button", name="Add a person").click()
        expect(page.get_by_role("button", name=f"Choose {name}")).to_have_attribute("aria-pressed", "true")
        with page.expect_response(lambda answer: "/settings" in answer.url):
            settings(page).locator(f"input[name=seat][value={panel}]").set_checked(True, force=True)
            page.locator("#settings input[name=swapAxes]").set_checked(panel == "behind")
        page.get_by_role("button", name="Done").click()

    other = chromium.new_context().new_page()
    other.goto(served)
    chooser = settings(other).locator("#settings-person")
    for name, swapped in zip(NAMES, (True, False), strict=True):
        expect(chooser.get_by_role("option", name=name)).to_be_attached()
        chooser.select_option(name)
        expect(other.locator("#settings input[name=swapAxes]")).to_be_checked(checked=swapped)
    other.context.close()

    page.locator("#add input").fill("李雷")
    page.get_by_role("button", name="Add a person").click()
    expect(page.get_by_role("alert")).to_contain_text("There is a person called 李雷 already.")


def test_a_person_is_exported_deleted_and_brought_back(page, place, tmp_path):
    page.locator("#add input").fill("Grete")
    page.get_by_role("button", name="Add a person").click()
    page.get_by_role("button", name="Choose Grete").wait_for()
    with page.expect_download() as download:
        page.get_by_role("link", name="Export everything of Grete").click()
    download.value.save_as(tmp_path / "grete.zip")
    page.get_by_role("button", name="Delete Grete").click()
    dialog = page.locator("#erase")
    expect(dialog).to_contain_text("the name and the settings")
    dialog.get_by_role("button", name="Keep everything").click()
    page.get_by_role("button", name="Delete Grete").click()
    dialog.get_by_role("button", name="Delete everything").click()
    expect(page.get_by_role("button", name="Choose Grete")).to_have_count(0)
    assert [path for path in place.rglob("*") if path.is_file() and b"Grete" in path.read_bytes()] == []
    assert "Grete" not in page.evaluate("JSON.stringify({...localStorage})")
    expect(page.get_by_role("button", name="Choose Guest")).to_have_attribute("aria-pressed", "true")
    page.locator("#import-file").set_input_files(tmp_path / "grete.zip")
    page.get_by_role("button", name="Choose Grete").wait_for()


def test_a_record_with_a_pin_opens_by_keys_or_by_the_digits_on_the_screen(page, chromium, served):
    page.locator("#add input").fill("Mina")
    page.get_by_role("button", name="Add a person").click()
    page.get_by_role("button", name="Set a PIN for Mina").click()
    dialog = page.locator("#pin")
    expect(dialog).to_contain_text("New PIN for Mina")
    page.keyboard.type("2718")
    page.keyboard.press("Enter")
    page.get_by_role("button", name="Remove the PIN of Mina").wait_for()
    expect(page.get_by_role("button", name="Choose Mina")).to_have_attribute("aria-pressed", "true")

    context = chromium.new_context()
    other = context.new_page()
    other.goto(served)
    settings(other).locator("#settings-person").select_option("Mina")
    dialog = other.locator("#pin")
    expect(dialog).to_contain_text("PIN of Mina")
    expect(other).to_have_url(f"{served}/people#{other.url[-16:]}")
    other.keyboard.type("0000")
    other.keyboard.press("Enter")
    expect(dialog).to_contain_text("This PIN is wrong.")
    for digit in "2718":
        dialog.get_by_role("button", name=digit, exact=True).click()
    dialog.get_by_role("button", name="Done").click()
    expect(other.get_by_role("button", name="Choose Mina")).to_have_attribute("aria-pressed", "true")
    with other.expect_download():
        other.get_by_role("link", name="Export everything of Mina").click()
    # The next driver has not given it.
    other.get_by_role("button", name="Choose Guest").click()
    expect(other.get_by_role("button", name="Choose Guest")).to_have_attribute("aria-pressed", "true")
    other.get_by_role("button", name="Delete Mina").click()
    expect(dialog).to_contain_text("PIN of Mina")
    context.close()


def test_a_name_that_is_too_long_is_refused_in_words(page):
    field = page.locator("#add input")
    field.focus()
    page.keyboard.insert_text("x" * 200)
    expect(field).to_have_value("")
    assert "40 characters" in field.evaluate("field => field.validationMessage")
