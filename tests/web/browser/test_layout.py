"""The arm, the stick and Stop are on one screen, whatever its size, direction and colours."""

import itertools
import json

import pytest

from latentarm.tasks.catalogue import SCENE_TASKS, TASKS
from latentarm.web.protocol.personalise_messages import Personalise
from latentarm.web.words.catalogue import COOKIE, languages

from .conftest import STICKS_OUT, ask_to_drive, set_up

SEEN_PX = 90
"""A view that is smaller shows nothing."""

PRACTISED = '{"practised": true}'
SIZES = {
    "a laptop": (1280, 720),
    "a laptop below the bars of its browser": (1366, 600),
    "200 %": (640, 360),
    "a large screen at 200 %": (960, 540),
    "a phone": (390, 844),
    "a phone below the bars of its browser": (390, 664),
    "a small phone": (360, 640),
    "a phone on its side": (844, 390),
}
PANELS = {"stick": ["#stick"], "dpad": ["#dpad"], "switch": ["#scan", "#switch"]}

# Which of these are not wholly on the screen, or lie under the bar.
CUT_OFF = """(selectors) => {
  const bar = document.querySelector(".action-bar").getBoundingClientRect();
  return selectors.filter((selector) => {
    const one = document.querySelector(selector);
    const box = one.getBoundingClientRect();
    const inside = box.left >= 0 && box.top >= 0 && box.right <= innerWidth + 1
      && box.bottom <= innerHeight + 1;
    const under = !one.closest(".action-bar") && box.left < bar.right - 1 && box.right > bar.left + 1
      && box.top < bar.bottom - 1 && box.bottom > bar.top + 1;
    return !one.checkVisibility() || !inside || under;
  });
}"""


@pytest.fixture
def opened(open_page):
    def opened(size, **options):
        page = open_page(viewport={"width": size[0], "height": size[1]}, **options)
        page.evaluate("scrollTo(0, 0)")
        return page

    return opened


ALWAYS = [".line", "#enable", "#status", "#stop", "#poses-open", "#settings-open"]
CHOICES = [
    "#mode .options",
    "#axes .options",
    "#speed .options",
    "#gripper-close",
    "#gripper-open",
    "#gripper-state",
]
"""Some of these have nothing to choose in some tasks."""


def parts(page, panel):
    """The parts that must be wholly on the screen at this task."""
    shown = [one for one in CHOICES if page.locator(one).is_visible()]
    return [".views:not([hidden])", *ALWAYS, *PANELS[panel], *shown]


def screens(page):
    """Show the page at every size with every control; their names."""
    for name, panel in itertools.product(SIZES, PANELS):
        page.set_viewport_size({"width": SIZES[name][0], "height": SIZES[name][1]})
        page.locator(f"input[name=panel][value={panel}]").evaluate("one => one.click()")
        page.wait_for_timeout(120)
        yield name, panel


def assert_on_one_screen(page, look):
    assert page.evaluate(CUT_OFF, parts(page, look[-1])) == [], look
    assert page.evaluate("document.scrollingElement.scrollHeight <= innerHeight"), look
    assert page.evaluate("document.scrollingElement.scrollWidth <= innerWidth"), look
    view = page.locator(".view:visible").first.bounding_box()
    assert min(view["width"], view["height"]) >= SEEN_PX, look


@pytest.mark.parametrize("name", SIZES)
def test_arm_stick_and_stop_are_on_one_screen(opened, name):
    page = opened(SIZES[name])
    for offered in (True, False):
        if not offered:
            page.get_by_role("button", name="Skip", exact=True).click()
        for panel in PANELS:
            page.locator(f"input[name=panel][value={panel}]").evaluate("one => one.click()")
            assert_on_one_screen(page, (name, panel))


@pytest.mark.parametrize("name", SIZES)
def test_a_close_up_leaves_the_large_view_where_it_is(opened, name):
    page = opened(SIZES[name])
    boxes = page.evaluate("""() => {
      const views = document.querySelector("#views");
      const box = (one) => Object.values(one.getBoundingClientRect().toJSON()).slice(0, 4);
      const large = document.querySelector(`#view-${views.dataset.large}`);
      return [false, true].map((close) => {
        views.toggleAttribute("data-close", close);
        return box(large);
      });
    }""")
    assert boxes[0] == boxes[1]


@pytest.mark.parametrize("task", ["learned", *TASKS, *SCENE_TASKS])
def test_nothing_scrolls_in_any_task_at_any_size_with_any_control(
    chromium, start_server, tmp_path, trained, task
):
    named = [str(trained)] if task == "learned" else ["--task", task]
    physics = ["--arm", "mujoco"] if task in SCENE_TASKS else []
    with start_server(tmp_path, *named, *physics) as address:
        for language in languages():
            context = chromium.new_context(reduced_motion="reduce")
            context.add_cookies([{"name": COOKIE, "value": language, "url": address}])
            context.add_init_script(f"localStorage['latentarm.settings.'] = '{PRACTISED}'")
            page = context.new_page()
            page.goto(address)
            page.locator(".label").first.wait_for(state="attached")
            for shown in screens(page):
                assert_on_one_screen(page, shown)
            context.close()


@pytest.mark.parametrize("size", [*SIZES.values(), (375, 667), (320, 640), (320, 256)])
def test_stop_is_in_its_corner(opened, size):
    width, height = size
    page = opened(size)
    for panel in PANELS:
        page.locator(f"input[name=panel][value={panel}]").evaluate("one => one.click()")
        page.wait_for_timeout(120)
        box = page.locator("#stop").bounding_box()
        assert width - 16 < box["x"] + box["width"] <= width
        assert height - 16 < box["y"] + box["height"] <= height


@pytest.mark.parametrize("name", SIZES)
def test_the_practice_leaves_the_arm_the_stick_and_stop_on_the_screen(opened, name):
    page = opened(SIZES[name])
    page.get_by_role("button", name="Practise now").click()
    assert page.evaluate(CUT_OFF, ["#practice", "#status"]) == []
    assert_on_one_screen(page, (name, "stick"))


@pytest.mark.parametrize("language", languages())
def test_new_directions_under_trial_leave_the_arm_the_stick_and_stop_on_the_screen(
    chromium, address, language
):
    learned = Personalise(phase="learned", name="Ada", answers=10, error=0.1, error_without=0.8).model_dump()

    def hear(socket):
        def changed(text):
            message = json.loads(text)
            changes = {"state": {"profile": ".trial"}, "learning": {"personalise": learned}}
            socket.send(json.dumps(message | changes.get(message["type"], {})))

        socket.connect_to_server().on_message(changed)

    context = chromium.new_context(reduced_motion="reduce")
    context.add_cookies([{"name": COOKIE, "value": language, "url": address}])
    page = context.new_page()
    page.route_web_socket("**/drive", hear)
    page.goto(address)
    page.locator("#trial").wait_for()
    page.locator(".label").first.wait_for(state="attached")
    for shown in screens(page):
        assert_on_one_screen(page, shown)
        assert page.evaluate(CUT_OFF, ["#trial-keep", "#trial-discard"]) == [], shown
    context.close()


@pytest.mark.parametrize("name", ["a phone", "a phone on its side"])
def test_a_request_to_drive_and_a_recording_leave_the_stick_and_stop_on_the_screen(
    opened, open_page, arm, name
):
    page = opened(SIZES[name])
    ask_to_drive(page)
    with set_up(page) as dialog:
        dialog.get_by_role("button", name="Start recording").click()
    open_page().locator("#enable", has_text="Ask to drive").click()
    asked, recording = page.locator("#hand-over"), page.locator("#record-end")
    asked.wait_for()
    for panel in PANELS:
        page.locator(f"input[name=panel][value={panel}]").evaluate("one => one.click()")
        assert_on_one_screen(page, (name, panel))
        assert page.evaluate(CUT_OFF, ["#hand-over", "#record-end"]) == []
    recording.click()
    recording.wait_for(state="hidden")
    asked.click()
    arm.wait(lambda: not arm.state["recording"]["on"] and arm.state["watchers"] == 2)


@pytest.mark.parametrize("name", SIZES)
def test_a_request_of_a_copilot_leaves_the_whole_sentence_on_the_screen(opened, open_page, name):
    page = opened(SIZES[name])
    ask_to_drive(page)
    with set_up(open_page()) as dialog:
        dialog.get_by_role("button", name="Ask to be co-pilot").click()
    page.get_by_role("button", name="Say yes to").wait_for()
    assert page.evaluate(CUT_OFF, ["#stop", "#enable", "#status", "#copilot-accept", "#copilot-end"]) == []
    cut = page.locator("#status").evaluate("({ scrollHeight, clientHeight }) => scrollHeight > clientHeight")
    assert not cut
    page.get_by_role("button", name="Say no").click()
    page.locator("#copilot-accept").wait_for(state="hidden")
    assert page.evaluate(CUT_OFF, ALWAYS) == []


@pytest.mark.parametrize("language", ["en", "de", "es"])
def test_a_long_sentence_lies_over_no_control(chromium, start_server, tmp_path, language):
    astray = {"code": "joint_astray", "parameters": {"joint": "joint6", "off_deg": 3}}

    def hear(socket):
        def changed(text):
            message = json.loads(text)
            if message["type"] == "state":
                message["reason"] = astray
            socket.send(json.dumps(message))

        socket.connect_to_server().on_message(changed)

    # The task with the most to show: fill levels, a gripper, and three pairs of directions.
    with start_server(tmp_path, "--task", "apple_pie", "--arm", "mujoco") as address:
        context = chromium.new_context(reduced_motion="reduce")
        context.add_cookies([{"name": COOKIE, "value": language, "url": address}])
        context.add_init_script(f"localStorage['latentarm.settings.'] = '{PRACTISED}'")
        page = context.new_page()
        page.route_web_socket("**/drive", hear)
        page.goto(address)
        page.locator("#status-text", has_text="joint6").wait_for()
        for name, panel in screens(page):
            shown = ["#stop", "#enable", "#status", *PANELS[panel], "#gripper-open"]
            assert page.evaluate(CUT_OFF, shown) == [], (name, panel)
        context.close()


@pytest.mark.parametrize("path", ["", "personalise", "teach"])
@pytest.mark.parametrize("name", SIZES)
def test_a_script_from_right_to_left_breaks_nothing(opened, address, name, path):
    page = opened(SIZES[name])
    page.goto(f"{address}/{path}")
    page.locator("#status:not([data-phase=connecting], [data-phase=lost])").wait_for()
    page.evaluate("document.documentElement.dir = 'rtl'")
    assert page.evaluate("document.documentElement.scrollWidth <= innerWidth")
    assert page.evaluate(STICKS_OUT) == []
    assert page.evaluate(CUT_OFF, ["#stop", "#status"]) == []
    if not path:
        page.locator("input[name=panel][value=dpad]").evaluate("one => one.click()")
        left, right = (
            page.locator(f"#dpad [data-direction={side}]").bounding_box()["x"] for side in ("left", "right")
        )
        # Left is where the arm goes left, in every script.
        assert left < right
        if page.locator("#view-side").is_visible():
            front, side = (page.locator(f"#view-{view}").bounding_box()["x"] for view in ("front", "side"))
            assert front < side


COLOURS = """async (names) => {
  const base = document.querySelector("script[type=module]").src.replace(/drive\\/drive\\.js$/, "");
  const { colour } = await import(`${base}views/colours.js`);
  return names.map(colour);
}"""


@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_forced_colours_leave_food_table_and_paths_apart(opened, scheme):
    page = opened((1280, 720), forced_colors="active", color_scheme=scheme)
    names = ["food", "table", "view", "tool", "ghost-up", "ghost-down", "ghost-left", "ghost-right"]
    assert len(set(page.evaluate(COLOURS, names))) == len(names)
    # The arrows and what is chosen are told apart as well.
    marks = page.locator(".ghost-mark").evaluate_all(
        "all => all.map((one) => getComputedStyle(one).backgroundColor)"
    )
    assert len(set(marks)) == 4
    chosen, other = page.locator("#speed .options span").evaluate_all(
        "all => all.slice(0, 2).map((one) => getComputedStyle(one).backgroundColor)"
    )
    assert chosen != other
    fill = "one => getComputedStyle(one).backgroundColor"
    assert page.locator("#stop").evaluate(fill) != page.locator("#enable").evaluate(fill)


WAKE_LOCK = """
window.locks = [];
Object.defineProperty(navigator, "wakeLock", { value: { request: async (kind) => {
  const lock = { kind, held: true, release: async () => { lock.held = false; } };
  window.locks.push(lock);
  return lock;
} } });
"""


def test_the_screen_stays_on_while_the_arm_is_enabled(open_page, arm, seat, press_enable, wait_in_page):
    page = seat(open_page(WAKE_LOCK), arm)
    assert page.evaluate("locks") == []
    press_enable(page, arm)
    wait_in_page(page, "locks.length > 0 && locks.at(-1).held")
    assert page.evaluate("locks.at(-1).kind") == "screen"
    page.keyboard.press("Escape")
    wait_in_page(page, "locks.every((lock) => !lock.held)")


def test_the_page_can_be_installed_and_has_no_service_worker(open_page):
    page = open_page()
    manifest = page.evaluate(
        "fetch(document.querySelector('link[rel=manifest]').href).then((one) => one.json())"
    )
    assert (manifest["start_url"], manifest["display"]) == ("/", "standalone")
    for icon in manifest["icons"]:
        size = page.evaluate(
            """async (src) => {
              const image = new Image();
              image.src = new URL(src, document.querySelector("link[rel=manifest]").href);
              await image.decode();
              return `${image.naturalWidth}x${image.naturalHeight}`;
            }""",
            icon["src"],
        )
        assert size == icon["sizes"]
    assert page.evaluate("navigator.serviceWorker.getRegistrations().then((all) => all.length)") == 0


def test_a_question_mark_opens_an_explanation_without_hiding_stop(open_page):
    page = open_page()
    page.locator("#settings-open").click()
    for mark in page.locator(".explain > summary").all():
        if not mark.is_visible():
            continue
        mark.focus()
        page.keyboard.press("Enter")
        assert mark.evaluate(
            "one => one.parentElement.open && one.parentElement.querySelector('p').checkVisibility()"
        )
        assert mark.get_attribute("aria-label").startswith("What is this?")
        assert page.locator("#settings [data-stop]").is_visible()
    # Nothing has enabled the arm.
    assert page.locator("#status").get_attribute("data-phase") == "disengaged"


def test_the_card_is_one_page_for_the_input_of_the_person(open_page):
    page = open_page()
    page.locator("input[name=panel][value=switch]").evaluate("one => one.click()")
    page.emulate_media(media="print")
    card = page.locator("#card")
    assert "with your switch" in card.inner_text()
    assert not page.locator("#stop").is_visible()
    pdf = page.pdf(format="A4")
    assert pdf.count(b"/Type /Page\n") == 1
