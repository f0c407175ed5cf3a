"""A bus of Feetech STS3215 servos behind a pseudo-terminal, as a serial port has it.

It speaks the servos' protocol 0 (ping, read, write, synchronous read and write) with their registers, so
that LeRobot's own classes and the manufacturer's SDK talk to it as to hardware. A servo with torque follows
its goal with a lag; without torque it stays where it is, and switching torque on sends it to its goal.
"""

import os
import select
import threading
import time
import tty
from contextlib import suppress
from typing import Final

MODEL: Final = 777
PING, READ, WRITE, SYNC_READ, SYNC_WRITE = 1, 2, 3, 0x82, 0x83
MIN_POSITION, MAX_POSITION, OFFSET, TORQUE, GOAL, PRESENT, VOLTS, CELSIUS = 9, 11, 31, 40, 42, 56, 62, 63

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
            way = (self.get(GOAL) - self.at) * min(span_s / LAG_S, 1.0)
            self.at += min(max(way, -most), most)
        self.put(PRESENT, round(self.at))


class FeetechBus:
    """Servos 1 to 6 behind ``port``; as a context manager it is switched off at the end.

    Attributes:
        servos: by their numbers.
        port: path of the serial port.
        written: every write as time (monotonic), servo, address and data.
        silent: whether the bus answers nothing any more.
    """

    def __init__(self) -> None:
        self.servos = {number: Servo(number) for number in range(1, 7)}
        self.written: list[tuple[float, int, int, bytes]] = []
        self.silent = False
        self._master, self._slave = os.openpty()
        tty.setraw(self._slave)
        self.port = os.ttyname(self._slave)
        self._ended = threading.Event()
        self._thread = threading.Thread(target=self._serve)

    def __enter__(self) -> "FeetechBus":
        self._thread.start()
        return self

    def __exit__(self, *_: object) -> None:
        self._ended.set()
        self._thread.join()
        os.close(self._master)
        os.close(self._slave)

    def _serve(self) -> None:
        with suppress(OSError):  # where the system allows it: hardware is not late on a busy computer
            os.sched_setscheduler(threading.get_native_id(), os.SCHED_RR, os.sched_param(11))
        waiting, before_s = b"", time.monotonic()
        while not self._ended.is_set():
            if select.select([self._master], [], [], 0.002)[0]:
                waiting += os.read(self._master, 4096)
            now_s = time.monotonic()
            for servo in self.servos.values():
                servo.elapse(now_s - before_s)
            before_s = now_s
            waiting = self._answer(waiting)

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
        self.written.append((time.monotonic(), number, address, data))

    def _status(self, number: int, data: bytes) -> None:
        body = bytes([number, len(data) + 2, 0]) + data
        os.write(self._master, b"\xff\xff" + body + bytes([~sum(body) & 0xFF]))
