"""A stand-in for an xArm's controller: the manufacturer's private protocol and its report sockets.

Frames and registers are those of the manufacturer's documentation and library. Run as a process, it is told
what to do over standard input, a JSON object a line, and answers the same way; see `XArmServer`.
"""

import asyncio
import contextlib
import json
import math
import socket
import struct
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

sys.path.insert(0, str(Path(__file__).parent))
from xarm_model import XArmModel

CONTROL, GRIPPER, TIMED, STATUS, PLAIN = 502, 503, 30000, 30002, 30003
_CLOSED = 7  # of TCP_INFO's first byte
_GRIPPER_ID = 8


class _Server:
    """The controller's sockets."""

    def __init__(self, config: dict[str, Any]) -> None:
        ports = config.pop("ports", {})
        self.host = config.pop("host", "127.0.0.1")
        self.ports = {port: ports.get(str(port), 0) for port in (CONTROL, GRIPPER, TIMED, STATUS, PLAIN)}
        self.has_gripper = config.pop("gripper", True)
        self.model = XArmModel(**{key: tuple(v) if key == "firmware" else v for key, v in config.items()})
        self.up = asyncio.Event()
        self.up.set()
        self.silent = self.frozen = self.nan = False
        self.clock_s = 0.0
        self.answer_s = 0.0
        self.shown = list(self.model.q)
        self.writers: set[asyncio.StreamWriter] = set()
        self.requests: list[int] = []

    async def start(self) -> None:
        handlers: dict[int, Callable[..., Any]] = {
            CONTROL: self._control,
            GRIPPER: self._control,
            TIMED: lambda r, w: self._reports(r, w, 0.005, self._timed),
            STATUS: lambda r, w: self._reports(r, w, 0.2, self._status),
            PLAIN: lambda r, w: self._reports(r, w, 0.01, self._plain),
        }
        for port, handler in handlers.items():
            server = await asyncio.start_server(handler, self.host, self.ports[port])
            self.ports[port] = server.sockets[0].getsockname()[1]

    async def _control(self, reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        self.writers.add(writer)
        with contextlib.suppress(OSError, asyncio.IncompleteReadError):
            while True:
                head = await reader.readexactly(7)
                data = await reader.readexactly(int.from_bytes(head[4:6], "big") - 1)
                while not self.up.is_set():
                    await self.up.wait()
                    # What the other side gave up was never delivered.
                    if _reset(writer):
                        return
                if self.answer_s:
                    await asyncio.sleep(self.answer_s)
                self.model.advance()
                body = self._answer(head[6], data)
                flags = (0x40 if self.model.error else 0) | (0x20 if self.model.warning else 0)
                flags |= 0x10 if self.model.state >= 3 else 0
                answer = bytes([head[6], flags]) + body
                writer.write(head[:4] + len(answer).to_bytes(2, "big") + answer)
                await writer.drain()
        self.writers.discard(writer)
        writer.close()

    def _answer(self, register: int, data: bytes) -> bytes:
        model = self.model
        self.requests.append(register)
        match register:
            case 1:
                firmware = "v" + ".".join(map(str, model.firmware))
                text = f"{model.axes},{model.kind},XI130000000000,AC130000000000,{firmware}"
                return text.encode().ljust(64, b"\0")
            case 11:
                model.motors = bool(data[1]) and not model.pressed and not model.error
            case 12:
                model.set_state(data[0])
            case 13:
                return bytes([model.state])
            case 14:
                return bytes(2)
            case 15:
                return bytes([model.error, model.warning])
            case 16:
                model.clear()
            case 17:
                model.warning = 0
            case 19:
                model.set_mode(data[0])
            case 41:
                return struct.pack("<6f", *model.tool(model.q))
            case 44:
                return struct.pack("<6f", *model.tool(list(struct.unpack("<7f", data[:28]))))
            case 42:
                return struct.pack("<7f", *model.q)
            case 81:
                speeds = list(struct.unpack("<7f", data[:28]))
                model.move(speeds, struct.unpack("<f", data[29:33])[0] if len(data) >= 33 else None)
            case 124:
                return bytes([data[0]]) + self._modbus(data[1:])
            case _:
                pass
        return b""

    def _modbus(self, data: bytes) -> bytes:
        """The xArm gripper's registers."""
        model = self.model
        if not self.has_gripper or data[0] != _GRIPPER_ID:
            return b""
        function, address = data[1], int.from_bytes(data[2:4], "big")
        if function == 0x10:
            value = int.from_bytes(data[7:], "big", signed=len(data) == 11)
            if address == 0x0700:
                model.gripper_target = float(min(max(value, -10), 850))
            elif address == 0x0303:
                model.gripper_speed = float(value)
            elif address == 0x0100:
                model.gripper_on = bool(value)
            return data[:6]
        position = round(model.gripper)
        registers = {
            0x0000: (2 if model.holding() else 0).to_bytes(2, "big"),
            0x000F: bytes(2),
            0x0702: position.to_bytes(4, "big", signed=True),
            0x0801: (3).to_bytes(2, "big"),
            0x0802: (4).to_bytes(2, "big"),
            0x0803: (3).to_bytes(2, "big"),
        }
        value = registers.get(address, bytes(2))
        return bytes([_GRIPPER_ID, function, len(value)]) + value

    async def _reports(
        self,
        reader: asyncio.StreamReader,
        writer: asyncio.StreamWriter,
        period_s: float,
        make: Callable[[], bytes],
    ) -> None:
        self.writers.add(writer)
        due_s = time.monotonic()
        with contextlib.suppress(OSError):
            while not writer.is_closing() and not reader.at_eof():
                self.model.advance()
                if self.up.is_set() and not self.silent:
                    body = make()
                    writer.write((len(body) + 4).to_bytes(4, "big") + body)
                    await writer.drain()
                due_s = max(due_s + period_s, time.monotonic() - period_s)
                await asyncio.sleep(max(0.0, due_s - time.monotonic()))
        self.writers.discard(writer)
        writer.close()

    def _angles(self) -> list[float]:
        if self.nan:
            return [math.nan] * 7
        if not self.frozen:
            self.shown = [*self.model.q[: self.model.axes], *[0.0] * (7 - self.model.axes)]
        return self.shown

    def _head(self) -> bytes:
        return bytes([self.model.state | self.model.mode << 4]) + bytes(2)

    def _timed(self) -> bytes:
        microseconds = round(1e6 * (self.model.now_s + self.clock_s))
        speeds = [0.0] * 7 if self.frozen else self.model.v
        joints = [*[0.0] * 21, *self._angles(), *speeds, *[0.0] * 7]
        body = microseconds.to_bytes(8, "big") + self._head() + bytes(17) + struct.pack("<42f", *joints)
        return body + bytes(600)

    def _plain(self) -> bytes:
        return self._head() + struct.pack("<7f", *self._angles()) + bytes(24 + 28) + bytes(48)

    def _status(self) -> bytes:
        model = self.model
        motors = 0xFF if model.motors else 0
        angles = self._angles()
        body = (
            self._head() + struct.pack("<7f", *angles) + struct.pack("<6f", *model.tool(angles)) + bytes(28)
        )
        body += bytes([motors, motors, model.error, model.warning]) + struct.pack("<6f", *model.tool_offset)
        body += struct.pack("<4f", model.load_kg, 0.0, 0.0, 48.0)
        body += bytes([model.collision_sensitivity, 3]) + struct.pack("<3f", 0.0, 0.0, -1.0)
        body += bytes([model.kind, model.axes, 2, 2, 43, 0])
        body += ("v" + ".".join(map(str, model.firmware))).encode().ljust(30, b"\0")
        body += struct.pack("<5f", 1000.0, 1.0, 50000.0, 0.1, 1000.0)
        body += struct.pack("<5f", 500.0, 0.01, model.acceleration, 0.0001, model.speed)
        body += struct.pack("<2f", 2.3, 2.7) + bytes(16) + bytes([30] * 7) + struct.pack("<8f", *[0.0] * 8)
        body += (
            bytes(4)
            + struct.pack("<6f", *model.base_offset)
            + bytes(2)
            + bytes([model.simulated, 1, 0])
            + bytes(24)
        )
        return body.ljust(583, b"\0")

    def do(self, order: dict[str, Any]) -> Any:
        """One order of the test."""
        model = self.model
        model.advance()
        what = order.pop("do")
        match what:
            case "press":
                model.press()
            case "release":
                model.pressed = False
            case "fail":
                model.fail(order["error"])
            case "push":
                model.push(order["by"])
            case "cut":
                self.up.clear()
            case "reconnect":
                self.up.set()
            case "restart":
                for writer in list(self.writers):
                    writer.transport.abort()
                model.boot()
            case "client":  # another program does something
                if "mode" in order:
                    model.set_mode(order["mode"])
                if "state" in order:
                    model.set_state(order["state"])
                if "velocity" in order:
                    model.move(order["velocity"], None)
            case "set":  # faults of the reports: silent, frozen, nan, clock_s, answer_s
                for name, value in order.items():
                    fitting = tuple(value) if name == "firmware" else value
                    setattr(self if hasattr(self, name) else model, name, fitting)
            case "requests":
                told, self.requests = self.requests, []
                return told
            case "state":
                keys = ("q", "v", "mode", "state", "error", "motors", "commands", "gripper", "now_s")
                return {key: getattr(model, key) for key in keys}
            case _:
                raise ValueError(what)
        return model.now_s


def _reset(writer: asyncio.StreamWriter) -> bool:
    """Whether the other side has reset the connection."""
    made = writer.get_extra_info("socket")
    try:
        info = made.getsockopt(socket.IPPROTO_TCP, socket.TCP_INFO, 1)
    except OSError:
        return True
    return writer.is_closing() or info[0] == _CLOSED


async def _serve() -> None:
    server = _Server(json.loads(sys.argv[1]))
    await server.start()
    _tell(server.ports)
    loop = asyncio.get_running_loop()
    orders = asyncio.StreamReader(limit=1 << 20)
    await loop.connect_read_pipe(lambda: asyncio.StreamReaderProtocol(orders), sys.stdin)
    while line := await orders.readline():
        _tell(server.do(json.loads(line)))


def _tell(what: object) -> None:
    sys.stdout.write(json.dumps(what) + "\n")
    sys.stdout.flush()


class XArmServer:
    """The server as a process of its own, so that it keeps time whatever the test does.

    Args:
        config: fields of `xarm_model.XArmModel`; ``gripper``: whether one is mounted; ``ports`` by the
            manufacturer's numbers, ``host``.
    """

    def __init__(self, **config: Any) -> None:
        self.config = config
        self._process = subprocess.Popen(
            [sys.executable, __file__, json.dumps(config)],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            text=True,
        )
        self.ports = {int(port): at for port, at in json.loads(self._line()).items()}

    def address(self, **options: object) -> str:
        """For ``--arm``."""
        timed = tuple(self.config.get("firmware", (2, 3, 0))) >= (2, 1, 0)
        given = {
            "gripper_port": self.ports[GRIPPER],
            "joints_port": self.ports[TIMED if timed else PLAIN],
            "status_port": self.ports[STATUS],
            **options,
        }
        return f"xarm://127.0.0.1:{self.ports[CONTROL]}?" + "&".join(f"{k}={v}" for k, v in given.items())

    def do(self, what: str, **order: Any) -> Any:
        """Give an order; the server's time, s, or what was asked for."""
        assert self._process.stdin is not None
        self._process.stdin.write(json.dumps({"do": what, **order}) + "\n")
        self._process.stdin.flush()
        return json.loads(self._line())

    def close(self) -> None:
        """End the process."""
        self._process.kill()
        self._process.communicate()

    def _line(self) -> str:
        assert self._process.stdout is not None
        line = self._process.stdout.readline()
        if not line:
            raise RuntimeError("the server has ended")
        return line


@contextlib.contextmanager
def serving(**config: Any) -> Iterator[XArmServer]:
    """A running server."""
    server = XArmServer(**config)
    try:
        yield server
    finally:
        server.close()


if __name__ == "__main__":
    asyncio.run(_serve())
