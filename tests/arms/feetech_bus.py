"""A bus of Feetech STS3215 servos behind a pseudo-terminal, as a serial port has it.

It speaks the servos' protocol 0 (ping, read, write, synchronous read and write) with their registers, so
that LeRobot's own classes and the manufacturer's SDK talk to it as to hardware. A servo with torque follows
its goal with a lag; without torque it stays where it is, and switching torque on sends it to its goal.

Run as a process, it is told what to do over standard input, a JSON object a line, and answers the same way;
see `FeetechBus`.
"""

import json
import math
import os
import select
import signal
import subprocess
import sys
import time
import tty
from collections import deque
from contextlib import suppress
from typing import Any, Final, Self

MODEL: Final = 777
PING, READ, WRITE, SYNC_READ, SYNC_WRITE = 1, 2, 3, 0x82, 0x83
MIN_POSITION, MAX_POSITION, OFFSET, TORQUE, ACCELERATION = 9, 11, 31, 40, 41
GOAL, PRESENT, VOLTS, CELSIUS = 42, 56, 62, 63

LAG_S: Final = 0.05
FASTEST: Final = 3000.0
"""Encoder steps in a second."""


class Servo:
    """One servo: its registers, and where it is."""

    def __init__(self, number: int, low: int = 1000, high: int = 3000, at: float = 2000.0) -> None:
        self.registers = bytearray(128)
        self.at = at
        self.put(3, MODEL)
        self.registers[0], self.registers[1], self.registers[5] = 3, 10, number
        self.put(MIN_POSITION, low)
        self.put(MAX_POSITION, high)
        self.put(GOAL, 2048)  # some old goal, far from where the servo is
        self.registers[VOLTS], self.registers[CELSIUS] = 74, 30

    def put(self, address: int, value: int) -> None:
        self.registers[address : address + 2] = value.to_bytes(2, "little")

    def get(self, address: int) -> int:
        return int.from_bytes(self.registers[address : address + 2], "little")

    def elapse(self, span_s: float) -> None:
        if self.registers[TORQUE]:
            most = FASTEST * span_s
            way = (self.get(GOAL) - self.at) * -math.expm1(-span_s / LAG_S)
            self.at += min(max(way, -most), most)
        self.put(PRESENT, round(self.at))


class _Bus:
    """The servos, their wire and their time."""

    def __init__(self) -> None:
        self.servos = {number: Servo(number) for number in range(1, 7)}
        self.written: deque[tuple[float, int, int, list[int]]] = deque(maxlen=10_000)
        self.silent = False
        self.late = 0
        self.powerless: set[int] = set()
        self._master, self._slave = os.openpty()
        tty.setraw(self._slave)
        self.port = os.ttyname(self._slave)

    def serve(self) -> None:
        """Serve the wire, and the orders of the test, until there are no more."""
        _tell(self.port)
        waiting, orders, before_s = b"", b"", time.monotonic()
        orders_from = sys.stdin.fileno()
        while True:
            ready = select.select([self._master, orders_from], [], [], 0.002)[0]
            now_s = time.monotonic()
            for servo in self.servos.values():
                servo.elapse(now_s - before_s)
            before_s = now_s
            if self._master in ready:
                waiting = self._answer(waiting + os.read(self._master, 4096))
            if orders_from in ready:
                if not (more := os.read(orders_from, 1 << 16)):
                    return
                *lines, orders = (orders + more).split(b"\n")
                for line in lines:
                    _tell(self._do(json.loads(line)))

    def _do(self, order: dict[str, Any]) -> Any:
        match order["do"]:
            case "state":
                rows = self.servos.items()
                return [(number, servo.at, servo.registers[TORQUE]) for number, servo in rows]
            case "place":
                for servo in self.servos.values():
                    servo.at = order["at"]
            case "push":
                for servo, by in zip(self.servos.values(), order["by"], strict=True):
                    servo.at += 0.0 if servo.registers[TORQUE] else by
            case "put":
                register = order["address"], order["address"] + len(order["data"])
                self.servos[order["number"]].registers[slice(*register)] = bytes(order["data"])
            case "remove":
                del self.servos[order["number"]]
            case "powerless":
                self.powerless.add(order["number"])
            case "silent":
                self.silent = order["silent"]
            case "late":
                self.late = order["times"]
            case "written":
                return list(self.written)
            case _:
                raise ValueError(order)
        return None

    def _answer(self, waiting: bytes) -> bytes:
        while (start := waiting.find(b"\xff\xff")) >= 0 and len(waiting) >= start + 4:
            number, length = waiting[start + 2], waiting[start + 3]
            if len(waiting) < start + 4 + length:
                return waiting[start:]
            body = waiting[start + 4 : start + 3 + length]
            waiting = waiting[start + 4 + length :]
            if not self.silent:
                self._execute(number, body[0], body[1:])
        return waiting

    def _execute(self, number: int, instruction: int, data: bytes) -> None:
        if instruction == SYNC_WRITE:
            address, size = data[0], data[1]
            for index in range(2, len(data), size + 1):
                self._write(data[index], address, data[index + 1 : index + 1 + size])
        elif instruction == SYNC_READ:
            if self.late and data[0] == PRESENT:
                self.late -= 1
                for one in data[2:]:
                    self._status(one, bytes([self.servos[one].registers[TORQUE]]))
            for one in data[2:]:
                self._status(one, bytes(self.servos[one].registers[data[0] : data[0] + data[1]]))
        elif number in self.servos:
            if instruction == READ:
                self._status(number, bytes(self.servos[number].registers[data[0] : data[0] + data[1]]))
            elif instruction == WRITE:
                self._write(number, data[0], data[1:])
                self._status(number, b"")
            elif instruction == PING:
                self._status(number, b"")

    def _write(self, number: int, address: int, data: bytes) -> None:
        self.servos[number].registers[address : address + len(data)] = data
        if number in self.powerless:
            self.servos[number].registers[TORQUE] = 0
        self.written.append((time.monotonic(), number, address, list(data)))

    def _status(self, number: int, data: bytes) -> None:
        body = bytes([number, len(data) + 2, 0]) + data
        os.write(self._master, b"\xff\xff" + body + bytes([~sum(body) & 0xFF]))


def _tell(what: object) -> None:
    sys.stdout.write(json.dumps(what) + "\n")
    sys.stdout.flush()


class FeetechBus:
    """Servos 1 to 6 behind ``port``, in a process of their own, so that they keep time whatever a test does.

    As a context manager it is switched off at the end.

    Attributes:
        port: path of the serial port.
    """

    def __init__(self) -> None:
        self._process = subprocess.Popen(
            [sys.executable, __file__], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True
        )
        self.port: str = json.loads(self._line())

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self._process.communicate("")

    def places(self) -> list[float]:
        """Where each servo is, encoder steps."""
        return [at for _, at, _ in self._do("state")]

    def powered(self) -> list[bool]:
        """Whether each servo's torque is on."""
        return [bool(torque) for _, _, torque in self._do("state")]

    def place(self, at: float) -> None:
        """Turn all servos by hand to an encoder step."""
        self._do("place", at=at)

    def push(self, by: list[float]) -> None:
        """Turn the servos without torque by hand, by so many encoder steps each."""
        self._do("push", by=by)

    def put(self, number: int, address: int, value: int, size: int = 1) -> None:
        """Set a register of a servo."""
        self._do("put", number=number, address=address, data=list(value.to_bytes(size, "little")))

    def remove(self, number: int) -> None:
        """Pull a servo off the bus."""
        self._do("remove", number=number)

    def cut_power(self, number: int) -> None:
        """From now on a servo answers, and takes no torque."""
        self._do("powerless", number=number)

    def silence(self, silent: bool) -> None:
        """Let the bus answer nothing any more, or answer again."""
        self._do("silent", silent=silent)

    def stand_still(self, for_s: float) -> None:
        """Let the bus do nothing for some time, and then answer all that it was asked meanwhile."""
        self._process.send_signal(signal.SIGSTOP)
        time.sleep(for_s)
        self._process.send_signal(signal.SIGCONT)

    def answer_late(self, times: int) -> None:
        """Before the next positions come answers to an earlier question, of one byte each, so many times."""
        self._do("late", times=times)

    def written(self) -> list[tuple[float, int, int, bytes]]:
        """The newest writes as time (monotonic, s), servo, address and data."""
        return [(at_s, number, address, bytes(data)) for at_s, number, address, data in self._do("written")]

    def _do(self, what: str, **order: object) -> Any:
        assert self._process.stdin is not None
        self._process.stdin.write(json.dumps({"do": what, **order}) + "\n")
        self._process.stdin.flush()
        return json.loads(self._line())

    def _line(self) -> str:
        assert self._process.stdout is not None
        if not (line := self._process.stdout.readline()):
            raise RuntimeError("the bus has ended")
        return line


if __name__ == "__main__":
    with suppress(OSError):  # where the system allows it: hardware is not late on a busy computer
        os.sched_setscheduler(0, os.SCHED_RR, os.sched_param(11))
    _Bus().serve()
