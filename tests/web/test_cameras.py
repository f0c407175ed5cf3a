"""Cameras: which are asked for, reading their pictures, and messages when one is missing."""

import asyncio
import json
import threading
import time
from pathlib import Path

import av
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from latentarm.cameras.clock_pattern import BITS, ROWS, clock_picture
from latentarm.cameras.decoding import ArrivalClock, CameraError, open_pictures
from latentarm.cameras.newest import NewestPicture
from latentarm.cameras.picture import MOST_HIGH, MOST_WIDE, Picture, fitted
from latentarm.cameras.sharing import SharedPictures
from latentarm.cameras.sources import CameraSource, kept, parse_cameras
from latentarm.core.errors import UserError
from latentarm.web.cameras.camera import Camera, check_camera, is_dark
from latentarm.web.cameras.viewer import asked_ms, without_candidates

SECRET = "hunter2"  # noqa: S105 - it must not be shown


def write_video(path: Path, frames: int = 12, size: tuple[int, int] = (320, 180), rate: int = 20) -> Path:
    """A video whose frames get lighter."""
    with av.open(str(path), "w") as out:
        stream = out.add_stream("libx264", rate=rate)
        stream.width, stream.height, stream.pix_fmt = *size, "yuv420p"
        for number in range(frames):
            grey = np.full((size[1], size[0], 3), 60 + 10 * number, np.uint8)
            out.mux(stream.encode(av.VideoFrame.from_ndarray(grey, format="rgb24")))
        out.mux(stream.encode())
    return path


@given(st.lists(st.text(max_size=30), max_size=6))
def test_whatever_is_typed_is_cameras_or_one_sentence(asked):
    refusal = ""
    try:
        cameras = parse_cameras(asked)
    except UserError as error:
        refusal, cameras = str(error), ()
    assert refusal.isprintable()
    assert refusal or len({camera.name for camera in cameras}) == len(asked) <= 4


@pytest.mark.parametrize(
    ("asked", "said"),
    [
        ([f"rtsp://ada:{SECRET}@host/live"], "not NAME=ADDRESS"),
        ([f"rtsp://ada:{SECRET}@host/live?a=b"], "not NAME=ADDRESS"),
        ([f"a/b=rtsp://ada:{SECRET}@host/live"], "not NAME=ADDRESS"),
        ([f"front=http://ada:{SECRET}@host/live"], "neither a device, a video file nor rtsp"),
        ([f"front=rtsp://ada:{SECRET}@:99999/live"], "names no host"),
        ([f"front=rtsp://ada:{SECRET}@host/live\n"], "holds characters"),
        (["front=testsrc", f"FRONT=rtsp://ada:{SECRET}@host/live"], "Two cameras are called FRONT"),
        ([f"{SECRET * 9}=testsrc"], "longer than 20 characters"),
        (["a=testsrc"] * 5, "the page shows 4 at most"),
        (["front=/dev/video77"], "the device does not exist"),
        (["front=nowhere.mp4"], "the file does not exist"),
    ],
)
def test_a_refusal_never_quotes_an_address(asked, said):
    with pytest.raises(UserError, match=said) as refused:
        parse_cameras(asked)
    assert SECRET not in str(refused.value)


def test_an_address_is_neither_shown_nor_written_to_the_file_of_options(tmp_path):
    video = f"file={write_video(tmp_path / 'a.mp4')}"
    asked = [f"front=rtsp://ada:{SECRET}@host/live", "side=testsrc", video]
    assert SECRET not in repr(parse_cameras(asked))
    assert kept(asked) == ("side=testsrc", video)


def test_what_cannot_be_reached_is_said_without_its_address():
    source = CameraSource("front", f"rtsp://ada:{SECRET}@127.0.0.1:9/live")
    assert check_camera(source, open_pictures) == (
        "Camera front cannot be opened: Connection refused. Check what follows front=."
    )


def test_a_file_that_is_no_video_is_said(tmp_path):
    (tmp_path / "page.html").write_text("<p>no video</p>")
    said = check_camera(CameraSource("front", str(tmp_path / "page.html")), open_pictures)
    assert said is not None
    assert "Invalid data" in said


def test_a_playlist_cannot_name_an_address_in_the_network(tmp_path):
    (tmp_path / "list.m3u8").write_text("#EXTM3U\n#EXTINF:1,\nhttp://127.0.0.1:9/a.ts\n#EXT-X-ENDLIST\n")
    assert check_camera(CameraSource("front", str(tmp_path / "list.m3u8")), open_pictures) is not None


def test_a_file_is_played_at_its_own_pace_and_begins_again(tmp_path):
    source = CameraSource("front", str(write_video(tmp_path / "a b:c.mp4")))
    began_s, seen = time.monotonic(), []
    for picture in open_pictures(source, threading.Event()):
        seen.append(picture)
        if len(seen) == 16:
            break
    assert time.monotonic() - began_s > 0.6
    assert [one.planes.shape for one in seen] == [(270, 320)] * 16
    light = [float(one.planes[0, 0]) for one in seen]
    assert light[:12] == sorted(light[:12])
    assert light[12] == pytest.approx(light[0], abs=1.0)
    assert np.all(np.diff([one.captured_s for one in seen]) > 0.0)


def test_a_large_picture_is_made_smaller(tmp_path):
    source = CameraSource("front", str(write_video(tmp_path / "large.mp4", 1, (1280, 720))))
    picture = next(iter(open_pictures(source, threading.Event())))
    assert picture.planes.shape == (540, 640)


@given(st.integers(1, 10_000), st.integers(1, 10_000))
def test_a_picture_fits_with_even_sides_and_its_own_shape(width, height):
    wide, high = fitted(width, height)
    assert 2 <= wide <= MOST_WIDE
    assert 2 <= high <= MOST_HIGH
    assert wide % 2 == high % 2 == 0
    assert abs(wide * height - high * width) <= 2 * max(width, height) + 2 * width


@given(st.floats(0.0, 4e9))
def test_the_test_pattern_shows_its_moment_to_the_millisecond(unix_s):
    row = clock_picture(unix_s)[ROWS // 2, :MOST_WIDE]
    gray = [int(row[(2 * bar + 1) * MOST_WIDE // BITS // 2] > 128) for bar in range(BITS)]
    code = 0
    for bit in gray:
        code = (code << 1) | (bit ^ (code & 1))
    assert code == int(unix_s * 1000.0) % (1 << BITS)


def planes(grey):
    return np.full((360, 320), grey, np.uint8)


def test_dusk_does_not_change_its_mind_with_every_picture():
    said = [False]
    for grey in [120, 30, 36, 38, 36, 45, 36]:
        said.append(is_dark(planes(grey), said[-1]))
    assert said[1:] == [False, True, True, True, True, False, False]


class Plug:
    """A camera that can be pulled out."""

    def __init__(self):
        self.opened = 0
        self.out = threading.Event()

    def __call__(self, source, closing):
        self.opened += 1
        while not closing.wait(0.01):
            if self.out.is_set():
                raise CameraError(f"Camera {source.name} has ended.")
            yield Picture(planes(120), time.monotonic())


def test_a_camera_is_open_while_somebody_looks_and_comes_back(monkeypatch):
    monkeypatch.setattr("latentarm.web.cameras.camera._RETRY_S", 0.02)
    monkeypatch.setattr("latentarm.web.cameras.camera.LOST_AFTER_S", 0.1)

    async def look():
        plug = Plug()
        camera = Camera(CameraSource("front", "testsrc"), plug, asyncio.get_running_loop())
        assert plug.opened == 0
        camera.look()
        assert camera.state == "opening"
        number, _ = await camera.after(-1)
        assert camera.state == "live"
        plug.out.set()
        await asyncio.sleep(0.3)
        assert camera.state == "lost"
        assert plug.opened > 2
        plugged_s = time.monotonic()
        plug.out.clear()
        later, picture = await camera.after(number + 40)
        assert later > number
        assert picture.captured_s > plugged_s
        assert camera.state == "live"
        camera.look_away()
        camera.end()
        opened = plug.opened
        await asyncio.sleep(0.1)
        assert plug.opened == opened

    asyncio.run(asyncio.wait_for(look(), 10.0))


@given(st.text() | st.binary() | st.none() | st.lists(st.floats()).map(json.dumps))
def test_whatever_a_page_says_is_a_question_or_nothing(message):
    assert asked_ms(message) is None


@given(st.floats(allow_nan=False, allow_infinity=False))
def test_a_question_for_the_time_is_understood(sent):
    assert asked_ms(json.dumps({"type": "time", "sent": sent})) == sent


@given(st.lists(st.text(st.characters(blacklist_categories=["Cc", "Zl", "Zp"]), max_size=40)))
def test_no_address_is_left_of_an_offer(lines):
    offer = "\r\n".join(
        [*lines, "a=candidate:1 1 udp 1 10.0.0.1 9 typ host", "a=end-of-candidates", "a=mid:0"]
    )
    left = without_candidates(offer).split("\r\n")
    assert "a=mid:0" in left
    assert not any(line.startswith("a=candidate") for line in left)


@given(st.floats(-1e5, 1e5), st.lists(st.floats(0.0, 0.2), min_size=30, max_size=60), st.floats(-1e-4, 1e-4))
def test_a_network_picture_is_as_old_as_its_delay_beyond_the_quickest(start, delays, drift):
    clock = ArrivalClock()
    ages = []
    for number, delay in enumerate(delays):
        taken_s = number / 20.0
        now_s = taken_s + 0.03 + delay
        clock.arrived(start + taken_s * (1.0 + drift), now_s)
        ages.append(now_s - clock.taken_s(start + taken_s * (1.0 + drift), now_s))
    quickest = np.minimum.accumulate(delays)
    assert np.allclose(ages, np.array(delays) - quickest, atol=0.002)


def test_a_picture_that_waited_in_a_queue_is_old():
    clock = ArrivalClock()
    clock.arrived(100.0, 5.0)
    assert clock.taken_s(100.0, 5.0) == 5.0
    clock.arrived(100.5, 6.0)
    assert clock.taken_s(100.5, 6.0) == pytest.approx(5.5, abs=1e-3)


def test_a_device_that_one_process_has_open_is_shared_with_others() -> None:
    source = CameraSource("front", "/dev/latentarm-test")  # nothing is there to open
    planes = np.full((MOST_HIGH * 3 // 2, MOST_WIDE), 7, np.uint8)
    closing = threading.Event()
    shared = SharedPictures(source, lambda: Picture(planes, 12.5))
    try:
        for name in ("front", "another name"):
            pictures = open_pictures(CameraSource(name, source.address), closing)
            taken = next(pictures)
            assert taken.captured_s == 12.5
            assert np.array_equal(taken.planes, planes)
        assert np.array_equal(NewestPicture(source, closing).first().planes, planes)
    finally:
        shared.end()
    # The device itself is tried once nobody serves it.
    with pytest.raises(CameraError, match="cannot be opened"):
        list(pictures)
    closing.set()
