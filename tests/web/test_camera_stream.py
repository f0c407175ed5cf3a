"""What a page receives: pictures whose timestamps mean the moment when they were taken."""

import asyncio
import json
import time
from contextlib import suppress

import pytest
from aiortc import RTCConfiguration, RTCPeerConnection, RTCRtpReceiver, RTCSessionDescription

from latentarm.cameras.clock_pattern import BITS, ROWS
from latentarm.cameras.decoding import open_pictures
from latentarm.cameras.sources import CameraSource
from latentarm.core.errors import UserError
from latentarm.web.cameras.camera import Camera
from latentarm.web.cameras.process import CameraProcess
from latentarm.web.cameras.viewer import OfferError, Viewer, listen_only_on
from latentarm.web.protocol.notice import NoticeError


@pytest.fixture(autouse=True)
def loopback(monkeypatch):
    import aioice.ice

    monkeypatch.setattr(aioice.ice, "get_host_addresses", aioice.ice.get_host_addresses)
    listen_only_on("127.0.0.1")


def read_clock(frame):
    """The Unix time that a test pattern shows, s; modulo 2^32 ms."""
    row = frame.to_ndarray(format="gray")[ROWS // 2]
    code = 0
    for bar in range(BITS):
        code = (code << 1) | (int(row[(2 * bar + 1) * frame.width // BITS // 2] > 128) ^ (code & 1))
    return code / 1000.0


async def offered(cameras):
    """A page of so many cameras, and its offer."""
    page = RTCPeerConnection(RTCConfiguration(iceServers=[]))
    channel = page.createDataChannel("cameras")
    for _ in range(cameras):
        page.addTransceiver("video", direction="recvonly")
    await page.setLocalDescription(await page.createOffer())
    return page, channel


@pytest.fixture
def received(monkeypatch):
    """The timestamps of what a page receives, as they are on the wire."""
    stamps = []
    handle = RTCRtpReceiver._handle_rtp_packet

    async def note(self, packet, arrival_time_ms):
        stamps.append(packet.timestamp)
        await handle(self, packet, arrival_time_ms)

    monkeypatch.setattr(RTCRtpReceiver, "_handle_rtp_packet", note)
    return stamps


def test_a_timestamp_means_the_moment_that_is_in_the_picture(received):
    async def look():
        camera = Camera(CameraSource("front", "testsrc"), open_pictures, asyncio.get_running_loop())
        viewer = Viewer([camera], lambda: None)
        page, channel = await offered(1)
        told = asyncio.Queue()
        channel.on("message", lambda text: told.put_nowait(json.loads(text)))
        tracks = asyncio.Queue()
        page.on("track", tracks.put_nowait)
        answer = await viewer.answer(page.localDescription.sdp)
        assert all(" 127.0.0.1 " in line for line in answer.splitlines() if "a=candidate" in line)
        await page.setRemoteDescription(RTCSessionDescription(answer, "answer"))
        track = await tracks.get()
        frames = [await track.recv() for _ in range(8)]
        while (found := await told.get())["type"] != "cameras" or found["cameras"][0]["rtp"] is None:
            pass
        (camera_now,) = found["cameras"]
        assert camera_now["state"] == "live"
        ahead_s = time.time() - time.monotonic()
        for frame in frames:
            # aiortc counts from the first one.
            steps = (frame.pts + received[0] - camera_now["rtp"] + (1 << 31)) % (1 << 32) - (1 << 31)
            taken_s = camera_now["at"] / 1000.0 + steps / 90_000.0
            apart_s = (taken_s + ahead_s - read_clock(frame) + 500.0) % ((1 << 32) / 1000.0) - 500.0
            assert abs(apart_s) < 0.005
        channel.send(json.dumps({"type": "time", "sent": 17.5}))
        while (found := await told.get())["type"] != "time":
            pass
        assert found["sent"] == 17.5
        assert abs(found["now"] / 1000.0 - time.monotonic()) < 1.0
        await viewer.close()
        await page.close()
        camera.end()

    asyncio.run(asyncio.wait_for(look(), 30.0))


@pytest.mark.parametrize("wanted", ["no offer", "two cameras", "no channel"])
def test_another_offer_is_refused_and_opens_no_camera(wanted):
    async def look():
        def opened(source, closing):
            raise AssertionError

        camera = Camera(CameraSource("front", "testsrc"), opened, asyncio.get_running_loop())
        viewer = Viewer([camera], lambda: None)
        page, _ = await offered(2 if wanted == "two cameras" else 1)
        offer = page.localDescription.sdp
        if wanted == "no channel":
            offer = offer[: offer.index("m=application")]
        if wanted == "no offer":
            offer = "v=0\r\nm=video\r\n"
        with pytest.raises(OfferError):
            await viewer.answer(offer)
        await viewer.close()
        await page.close()

    asyncio.run(asyncio.wait_for(look(), 30.0))


@pytest.mark.slow
def test_a_page_is_answered_by_a_process_that_is_started_again_when_it_breaks():
    cameras = CameraProcess([CameraSource("front", "testsrc")], "127.0.0.1")

    async def look():
        page, _ = await offered(1)
        offer = page.localDescription.sdp
        answer = await cameras.answer("ada", offer)
        assert "m=video" in answer
        with pytest.raises(NoticeError) as refused:
            await cameras.answer("ada", "hello")
        assert refused.value.notice.code == "request_invalid"
        for number in range(4):
            await cameras.answer(f"page {number}", offer)
        with pytest.raises(NoticeError) as refused:
            await cameras.answer("one more", offer)
        assert refused.value.notice.code == "cameras_full"
        cameras.leave("page 0")
        await cameras.answer("one more", offer)
        cameras._process.kill()
        async with asyncio.timeout(30.0):
            while True:
                with suppress(NoticeError):
                    assert "m=video" in await cameras.answer("ada", offer)
                    break
                await asyncio.sleep(0.2)
        await page.close()

    try:
        asyncio.run(look())
    finally:
        cameras.end()
    assert not cameras._process.is_alive()


@pytest.mark.slow
def test_a_camera_that_cannot_be_opened_leaves_no_process_behind(tmp_path):
    (tmp_path / "no.mp4").write_text("no video")
    with pytest.raises(UserError, match="Camera front cannot be opened: Invalid data"):
        CameraProcess(
            [CameraSource("side", "testsrc"), CameraSource("front", str(tmp_path / "no.mp4"))], "127.0.0.1"
        )
