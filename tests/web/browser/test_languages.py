"""In each language every page fits: no text is cut off by its box, and nothing sticks out of the screen."""

import pytest

from latentarm.web.words.catalogue import COOKIE, languages

from .conftest import STICKS_OUT

SIZES = {"a laptop": (1280, 720), "a phone": (390, 844)}
PAGES = ("", "fit", "teach", "personalise", "people", "history")

# Texts whose letters reach beyond the box that they stand in.
CUT_OFF = """() => {
  const found = [];
  const walker = document.createTreeWalker(document.body, NodeFilter.SHOW_TEXT);
  while (walker.nextNode()) {
    const text = walker.currentNode;
    const box = text.parentElement;
    if (!text.data.trim() || !box.checkVisibility({ visibilityProperty: true })) continue;
    if (box.closest(".visually-hidden, .skip, .labels, svg, script, option")) continue;
    const { display, clipPath } = getComputedStyle(box);
    // What is clipped away is for screen readers.
    if (display === "inline" || clipPath === "inset(50%)") continue;
    const range = document.createRange();
    range.selectNodeContents(text);
    const letters = range.getBoundingClientRect();
    const around = box.getBoundingClientRect();
    const out = letters.left < around.left - 1 || letters.right > around.right + 1
      || letters.top < around.top - 4 || letters.bottom > around.bottom + 4;
    if (out) found.push(text.data.trim().slice(0, 60));
  }
  return found;
}"""

# Panels of the settings and the like, opened as a person would.
OPEN_ALL = "() => document.querySelectorAll('details').forEach((one) => { one.open = true; })"


@pytest.mark.parametrize("size", SIZES)
@pytest.mark.parametrize("language", sorted(languages()))
def test_every_page_fits_in_every_language(open_page, address, language, size):
    width, height = SIZES[size]
    page = open_page(viewport={"width": width, "height": height}, reduced_motion="reduce")
    page.context.add_cookies([{"name": COOKIE, "value": language, "url": address}])
    misfits = {}
    for path in PAGES:
        page.goto(f"{address}/{path}")
        page.locator("#status:not([data-phase=connecting], [data-phase=lost])").wait_for()
        assert page.evaluate("document.documentElement.lang") == language
        for panel in ("stick", "dpad", "switch"):
            radio = page.locator(f"input[name=panel][value={panel}]")
            if radio.count():
                radio.evaluate("one => one.click()")
            _note(misfits, page, (path, panel))
        page.evaluate(OPEN_ALL)
        _note(misfits, page, (path, "explained"))
    page.get_by_role("button", name=languages()[language].say("settings.title"), exact=True).click()
    _note(misfits, page, ("settings", "dialog"))
    assert misfits == {}


def test_the_language_of_the_browser_is_spoken_until_another_is_chosen(open_page):
    page = open_page(locale="es-MX")
    page.get_by_role("button", name="Parar", exact=True).wait_for()
    page.get_by_role("button", name="Ajustes", exact=True).click()
    page.locator("#language").select_option(label="中文（简体）")
    page.get_by_role("button", name="停止", exact=True).wait_for()
    assert page.evaluate("document.documentElement.lang") == "zh"


def _note(misfits, page, where):
    found = page.evaluate(STICKS_OUT) + page.evaluate(CUT_OFF)
    if found or page.evaluate("document.documentElement.scrollWidth > innerWidth"):
        misfits[where] = found
