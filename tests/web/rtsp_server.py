"""A camera on the network for tests: a small RTSP server that wants a password and sends H.264 over TCP."""

import base64
import socket
import struct
import threading
import time
from contextlib import suppress
from fractions import Fraction

import numpy as np
from aiortc.codecs.h264 import H264Encoder
from av import VideoFrame

RATE = 20
TYPE = 96


class RtspCamera:
    """One camera; a grey that gets lighter. Leave the block to switch it off.

    Args:
        user: who may see it.
        password: theirs.
        port: to listen on; 0 takes any free one.
        stalls: whether the network holds the pictures up for a while after two seconds, and loses none.
    """

    def __init__(self, user: str, password: str, port: int = 0, *, stalls: bool = False) -> None:
        self._stalls = stalls
        self._allowed = "Basic " + base64.b64encode(f"{user}:{password}".encode()).decode()
        self._listening = socket.create_server(("127.0.0.1", port), reuse_port=False)
        self.port = self._listening.getsockname()[1]
        self._off = threading.Event()
        self._peers: list[socket.socket] = []
        self.asked: list[str] = []

    def __enter__(self) -> "RtspCamera":
        threading.Thread(target=self._accept, daemon=True).start()
        return self

    def __exit__(self, *exception: object) -> None:
        self._off.set()
        for one in (self._listening, *self._peers):
            with suppress(OSError):
                one.shutdown(socket.SHUT_RDWR)
            one.close()

    def _accept(self) -> None:
        with suppress(OSError):
            while not self._off.is_set():
                peer, _ = self._listening.accept()
                self._peers.append(peer)
                threading.Thread(target=self._serve, args=[peer], daemon=True).start()

    def _serve(self, peer: socket.socket) -> None:
        with suppress(OSError, ValueError), peer.makefile("rb") as requests:
            while line := requests.readline().decode().strip():
                method, url, _ = line.split()
                headers = dict(iter(lambda: self._header(requests), ("", "")))
                self.asked.append(method)
                answer = {"CSeq": headers["cseq"], "Session": "1"}
                body = ""
                status = "200 OK"
                if method != "OPTIONS" and headers.get("authorization") != self._allowed:
                    status, answer["WWW-Authenticate"] = "401 Unauthorized", 'Basic realm="camera"'
                elif method == "OPTIONS":
                    answer["Public"] = "OPTIONS, DESCRIBE, SETUP, PLAY, TEARDOWN"
                elif method == "DESCRIBE":
                    body = (
                        "v=0\r\no=- 0 0 IN IP4 127.0.0.1\r\ns=camera\r\nt=0 0\r\n"
                        f"m=video 0 RTP/AVP {TYPE}\r\nc=IN IP4 0.0.0.0\r\na=rtpmap:{TYPE} H264/90000\r\n"
                        f"a=fmtp:{TYPE} packetization-mode=1\r\na=control:track\r\n"
                    )
                    answer |= {"Content-Type": "application/sdp", "Content-Base": f"{url}/"}
                elif method == "SETUP":
                    answer["Transport"] = "RTP/AVP/TCP;unicast;interleaved=0-1"
                answer["Content-Length"] = str(len(body))
                head = "".join(f"{name}: {value}\r\n" for name, value in answer.items())
                peer.sendall(f"RTSP/1.0 {status}\r\n{head}\r\n{body}".encode())
                if method == "PLAY" and status.startswith("200"):
                    threading.Thread(target=self._play, args=[peer], daemon=True).start()

    def _header(self, requests) -> tuple[str, str]:
        name, _, value = requests.readline().decode().strip().partition(": ")
        return name.lower(), value

    def _play(self, peer: socket.socket) -> None:
        encoder = H264Encoder()
        number = sequence = 0
        with suppress(OSError):
            while not self._off.wait(1.0 / RATE):
                grey = np.full((240, 320, 3), 60 + number % 100, np.uint8)
                frame = VideoFrame.from_ndarray(grey, format="rgb24")
                frame.pts, frame.time_base = number * 90_000 // RATE, Fraction(1, 90_000)
                payloads, stamp = encoder.encode(frame, force_keyframe=number % RATE == 0)
                for at, payload in enumerate(payloads):
                    last = at == len(payloads) - 1
                    head = struct.pack("!BBHII", 0x80, TYPE | (last << 7), sequence % (1 << 16), stamp, 1)
                    packet = head + payload
                    peer.sendall(struct.pack("!cBH", b"$", 0, len(packet)) + packet)
                    sequence += 1
                number += 1
                if self._stalls and number == 2 * RATE:
                    self._off.wait(2.5)


def until(what, within_s: float = 15.0) -> None:
    """Wait until something holds."""
    end_s = time.monotonic() + within_s
    while not what():
        assert time.monotonic() < end_s
        time.sleep(0.02)
