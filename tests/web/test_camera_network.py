"""A camera on the network: its password is used and never shown; it is shown again when it comes back."""

import asyncio
import logging
import threading
from collections import deque

import pytest

from latentarm.cameras.decoding import CameraError, open_pictures
from latentarm.cameras.sources import CameraSource
from latentarm.web.cameras.camera import Camera, check_camera

from .rtsp_server import RtspCamera, until

PASSWORD = "hunter2"  # noqa: S105 - it must not be shown

pytestmark = pytest.mark.slow


def source(port, password=PASSWORD):
    return CameraSource("side", f"rtsp://ada:{password}@127.0.0.1:{port}/live")


def test_a_camera_with_a_password_gives_pictures_of_now(capfd, caplog):
    caplog.set_level(logging.DEBUG)
    with RtspCamera("ada", PASSWORD) as there:
        closing = threading.Event()
        pictures = open_pictures(source(there.port), closing)
        seen = [next(pictures) for _ in range(10)]
        pictures.close()
        assert all(one.planes.shape == (360, 320) for one in seen)
        assert "PLAY" in there.asked
        said = check_camera(source(there.port, "hunter3"), open_pictures)
    assert said is not None
    assert "401 Unauthorized" in said
    captured = capfd.readouterr()
    shown = said + captured.out + captured.err + caplog.text
    assert "hunter" not in shown
    assert "rtsp://" not in shown


def test_pictures_that_have_queued_up_are_dropped_with_their_connection():
    with RtspCamera("ada", PASSWORD, stalls=True) as there:
        pictures = open_pictures(source(there.port), threading.Event())
        with pytest.raises(CameraError, match="Camera side is too far behind"):
            deque(pictures, maxlen=0)
        assert next(open_pictures(source(there.port), threading.Event())).planes.shape == (360, 320)


def test_a_camera_that_is_switched_off_is_lost_and_comes_back():
    async def look():
        with RtspCamera("ada", PASSWORD) as there:
            camera = Camera(source(there.port), open_pictures, asyncio.get_running_loop())
            camera.look()
            number, _ = await camera.after(-1)
            assert camera.state == "live"
        await asyncio.to_thread(until, lambda: camera.state == "lost")
        with RtspCamera("ada", PASSWORD, there.port):
            while camera.state != "live":
                number, _ = await camera.after(number)
            camera.look_away()
            camera.end()

    asyncio.run(asyncio.wait_for(look(), 60.0))
