"""Cameras on the page: a picture is as old as the page says, and what is old does not look current."""

import os
import signal
import time
from pathlib import Path

import av
import numpy as np
import pytest

from latentarm.cameras.clock_pattern import BITS, ROWS

from .conftest import find_chromium

# Notes, for each picture of the first camera, when the page showed it and what it shows: the code of
# the test pattern, read from the pixels.
READ_CLOCK = """([bits, rows]) => {
  const video = document.querySelector(".camera video");
  const canvas = document.createElement("canvas");
  window.seen = [];
  const look = (_, { expectedDisplayTime, width, height }) => {
    if (width) {
      canvas.width = width;
      canvas.height = 1;
      const pen = canvas.getContext("2d", { willReadFrequently: true });
      pen.drawImage(video, 0, (rows / 2) * (height / 480), width, 1, 0, 0, width, 1);
      const { data } = pen.getImageData(0, 0, width, 1);
      let code = 0n;
      for (let bar = 0; bar < bits; bar += 1) {
        const bit = BigInt(data[4 * Math.floor((bar + 0.5) * (width / bits))] > 128);
        code = (code << 1n) | (bit ^ (code & 1n));
      }
      // The canvas gets what the video shows now, which may be a later picture than this call is about.
      const shown = performance.timeOrigin + Math.max(expectedDisplayTime, performance.now());
      const age = Number(BigInt.asIntN(bits, BigInt(Math.round(shown)) - code));
      const said = parseFloat(document.querySelector(".picture-age").textContent);
      window.seen.push([age, said]);
    }
    video.requestVideoFrameCallback(look);
  };
  video.requestVideoFrameCallback(look);
}"""


@pytest.fixture(scope="module")
def video(tmp_path_factory):
    """A short film that is light, then dark."""
    path = tmp_path_factory.mktemp("film") / "film.mp4"
    with av.open(str(path), "w") as out:
        stream = out.add_stream("libx264", rate=20)
        stream.width, stream.height, stream.pix_fmt = 320, 180, "yuv420p"
        for number in range(240):
            picture = np.full((180, 320, 3), 160 if number < 120 else 12, np.uint8)
            out.mux(stream.encode(av.VideoFrame.from_ndarray(picture, format="rgb24")))
        out.mux(stream.encode())
    return path


@pytest.fixture(scope="module")
def cameras(start_server, tmp_path_factory, video):
    """Where a page with two cameras is; the second has a name that would do harm as HTML."""
    folder = tmp_path_factory.mktemp("teleop")
    with start_server(folder, "--camera", "front=testsrc", "--camera", f"<i>s&={video}") as address:
        yield address


@pytest.fixture(scope="module")
def without_graphics(chromium):
    """A Chromium that draws pages without OpenGL, as it does without a graphics processor."""
    sandbox = ["--no-sandbox"] if os.getuid() == 0 else []
    flags = ["--enable-unsafe-swiftshader", *sandbox]
    browser = chromium.browser_type.launch(executable_path=find_chromium(), args=flags)
    yield browser
    browser.close()


@pytest.fixture
def page(without_graphics, cameras):
    context = without_graphics.new_context(viewport={"width": 1280, "height": 720})
    page = context.new_page()
    page.set_default_timeout(15_000)
    errors = []
    page.on("pageerror", lambda error: errors.append(str(error)))
    page.on("console", lambda said: errors.append(said.text) if "Security" in said.text else None)
    page.goto(cameras)
    page.locator("#status:not([data-phase=connecting], [data-phase=lost])").wait_for()
    yield page
    context.close()
    assert errors == []


def clear(page, number=0):
    page.locator(".camera[data-old=false]").nth(number).wait_for()


def test_the_page_says_how_old_the_picture_is_and_the_pixels_agree(page):
    clear(page, 1)
    page.evaluate(READ_CLOCK, [BITS, ROWS])
    page.wait_for_timeout(6000)
    seen = np.array([one for one in page.evaluate("seen") if one[1] is not None], float)
    assert len(seen) > 30
    truth, said = np.median(seen, axis=0)
    # What is said is how old the picture is when one looks, not when it came: up to a frame more.
    assert abs(truth - said) < 60
    assert page.locator(".camera bdi").all_inner_texts() == ["front", "<i>s&"]


def test_the_drawn_arm_stays_in_reach_and_the_choice_is_kept(page):
    clear(page)
    assert not page.locator("#scene").is_visible()
    page.get_by_role("button", name="Settings").click()
    page.get_by_role("radio", name="Show the drawn arm").check()
    page.get_by_role("button", name="Done").click()
    page.locator("#view-front .label").first.wait_for(state="attached")
    assert page.locator("#scene").is_visible()
    assert not page.locator("#cameras").is_visible()
    page.reload()
    page.locator("#scene").wait_for()
    page.get_by_role("button", name="Settings").click()
    page.get_by_role("radio", name="Show the cameras").check()
    page.get_by_role("button", name="Done").click()
    clear(page)


def test_too_little_light_is_said(page):
    clear(page, 1)
    page.get_by_text("It is too dark to see well").wait_for(timeout=20_000)
    page.get_by_text("It is too dark to see well").wait_for(state="hidden", timeout=20_000)


def test_a_process_that_hangs_greys_the_picture_and_one_that_dies_is_replaced(page):
    clear(page)
    (process,) = camera_processes()
    os.kill(process, signal.SIGSTOP)
    try:
        page.locator(".camera[data-old=true]").first.wait_for(timeout=3000)
        page.get_by_text("This picture is old").first.wait_for()
    finally:
        os.kill(process, signal.SIGCONT)
    clear(page)
    os.kill(process, signal.SIGKILL)
    page.locator(".camera[data-old=true]").first.wait_for(timeout=3000)
    page.locator(".camera[data-old=false]").first.wait_for(timeout=60_000)
    assert camera_processes() != [process]


def test_a_page_that_has_gone_is_sent_nothing(page, cameras):
    clear(page)
    offer = {"page": "somebody", "sdp": "v=0"}
    refused = page.request.post(f"{cameras}/cameras", data=offer, headers={"origin": cameras})
    assert refused.status == 400
    refused = page.request.post(f"{cameras}/cameras", data=offer, headers={"origin": "http://elsewhere"})
    assert refused.status == 403


def camera_processes():
    """The processes of this test's server that hold the cameras: those that listen for pages by UDP."""
    found = []
    for folder in Path("/proc").glob("[0-9]*"):
        try:
            words = (folder / "cmdline").read_bytes()
            loaded = b"libavcodec" in (folder / "maps").read_bytes() and b"spawn_main" in words
        except OSError:
            continue
        if loaded and descends(int(folder.name), os.getpid()):
            found.append(int(folder.name))
    return found


def descends(process, ancestor):
    while process > 1:
        if process == ancestor:
            return True
        stat = Path(f"/proc/{process}/stat").read_text()
        process = int(stat.rpartition(")")[2].split()[1])
    return False


@pytest.mark.parametrize(("width", "height"), [(1280, 720), (390, 844), (844, 390), (640, 360)])
def test_cameras_stick_and_stop_are_on_one_screen(page, width, height):
    page.set_viewport_size({"width": width, "height": height})
    page.get_by_role("button", name="Skip", exact=True).click()
    page.evaluate("scrollTo(0, 0)")
    for selector in (".camera", "#stick", "#enable", "#stop"):
        box = page.locator(selector).first.bounding_box()
        assert box["x"] >= 0, selector
        assert box["y"] >= 0, selector
        assert box["x"] + box["width"] <= width + 1, selector
        assert box["y"] + box["height"] <= height + 1, selector
    assert page.evaluate("document.documentElement.scrollWidth <= innerWidth")
    assert page.evaluate("document.scrollingElement.scrollHeight <= innerHeight")


def test_it_ends_with_its_server(start_server, tmp_path):
    before = set(camera_processes())
    with start_server(tmp_path, "--camera", "front=testsrc"):
        (process,) = set(camera_processes()) - before
    end_s = time.monotonic() + 5.0
    while process in camera_processes() and time.monotonic() < end_s:
        time.sleep(0.05)
    assert process not in camera_processes()
    assert "Traceback" not in (tmp_path / "said").read_text()
