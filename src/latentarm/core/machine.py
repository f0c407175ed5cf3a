"""This computer, in so far as a control loop depends on it: priority, cores, pauses, clock, disk."""

import ctypes
import os
import shutil
import sys
import tempfile
import time
from collections.abc import Iterator
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Final, Literal, final

import numpy as np

from latentarm.core.punctuality import ask_for_priority

SLEEP_S: Final = 0.001
PAUSE_S: Final = 0.040  # a loop that is held up for longer stops the arm
_LATE_S: Final = 0.005  # half a period of the page's loop
_FEW: Final = 2
_STEP_S: Final = 0.05
_TIME_ERROR: Final = 5  # of adjtimex(2): nothing keeps the clock right
_TIMEX_BYTES: Final = 256

Level = Literal["good", "warning", "fault"]
"""*warning*: matters for a real arm. *fault*: nothing works before the person has changed something."""


@final
@dataclass(frozen=True)
class Finding:
    """One thing about this computer."""

    name: str
    found: str
    level: Level = "good"
    means: str = ""  # what it means and what to do; "" where all is well


def examine_machine(folder: Path, least_free_bytes: int, for_s: float) -> Iterator[Finding]:
    """Look at this computer; ``folder`` is for records, pauses are measured ``for_s`` seconds."""
    yield _priority()
    yield _cores()
    if hasattr(os, "getloadavg"):
        yield _load(os.getloadavg()[0], os.cpu_count() or 1)
    yield from _pauses_and_clock(for_s)
    yield _disk(folder, least_free_bytes)


def _priority() -> Finding:
    if not hasattr(os, "sched_setscheduler"):
        return Finding(
            "priority", "this system has none", "warning", "Other programs may hold up the arm: use Linux."
        )
    before = os.sched_getscheduler(0), os.sched_getparam(0)
    if ask_for_priority():
        os.sched_setscheduler(0, *before)
        return Finding("priority", "real-time priority is allowed")
    return Finding(
        "priority",
        "real-time priority is refused",
        "warning",
        "Other programs may hold up the arm, which then stops. Write `USER - rtprio 10` to a file in"
        " /etc/security/limits.d and log in again (systemd: LimitRTPRIO=10; containers: --ulimit rtprio=10).",
    )


def _cores() -> Finding:
    cores = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
    governors: set[str] = set()
    for file in Path("/sys/devices/system/cpu").glob("cpu[0-9]*/cpufreq/scaling_governor"):
        with suppress(OSError):
            governors.add(file.read_text().strip())
    found = f"{cores}, governor {'/'.join(sorted(governors)) or 'not known'}"
    if cores < _FEW:
        return Finding("cores", found, "warning", "The page and the arm share one core: use two or more.")
    if "powersave" in governors:
        means = "Cores may wake up late: `cpupower frequency-set -g performance`."
        return Finding("cores", found, "warning", means)
    return Finding("cores", found)


def _load(running: float, cores: int) -> Finding:
    """Finding about how many programs ran at once over the last minute."""
    found = f"{running:.1f} programs at once over the last minute"
    if running <= cores:
        return Finding("load", found)
    means = f"There are {cores} cores: page and arm may come too late, which stops it. End other programs."
    return Finding("load", found, "warning", means)


def _pauses_and_clock(for_s: float) -> Iterator[Finding]:
    """Sleeps of 1 ms, as the arm's process would: with priority where it is allowed."""
    before = (os.sched_getscheduler(0), os.sched_getparam(0)) if hasattr(os, "sched_getparam") else None
    with_priority = ask_for_priority()
    began_s, wall_s = time.monotonic(), time.time()
    late_s: list[float] = []
    try:
        while time.monotonic() - began_s < for_s:
            start_s = time.perf_counter()
            time.sleep(SLEEP_S)
            late_s.append(time.perf_counter() - start_s - SLEEP_S)
    finally:
        if before is not None and with_priority:
            os.sched_setscheduler(0, *before)
    stepped_s = abs((time.time() - wall_s) - (time.monotonic() - began_s))
    worst_s, p99_s = max(late_s), float(np.percentile(late_s, 99))
    found = f"{1e3 * worst_s:.1f} ms at worst, {1e3 * p99_s:.1f} ms at the 99th percentile, in {for_s:g} s"
    if worst_s > PAUSE_S or p99_s > _LATE_S:
        means = (
            f"Over {1e3 * PAUSE_S:.0f} ms the arm stops: end other programs, allow real-time priority, use"
            " more cores, or no virtual machine."
        )
        yield Finding("pauses", found, "warning", means)
    else:
        yield Finding("pauses", found)
    yield _clock(stepped_s)


def _clock(stepped_s: float) -> Finding:
    if stepped_s > _STEP_S:
        means = "Records are dated wrongly. The arm is not affected: its loop has a clock of its own."
        return Finding("clock", f"the time of day jumped by {stepped_s:.2f} s", "warning", means)
    state = None
    if sys.platform == "linux":
        with suppress(OSError, AttributeError):
            state = ctypes.CDLL(None).adjtimex(ctypes.create_string_buffer(_TIMEX_BYTES))
    if state == _TIME_ERROR:
        means = (
            "Arms that stamp readings with the time of day (ROS 2) are refused when the clocks part, and"
            " records are dated wrongly: `timedatectl set-ntp true`, or ask who runs this machine."
        )
        return Finding("clock", "steady, and not synchronised by NTP", "warning", means)
    return Finding("clock", "steady" + ("" if state is None or state < 0 else ", synchronised"))


def _disk(folder: Path, least_free_bytes: int) -> Finding:
    there = folder.absolute()
    while not there.exists():
        there = there.parent
    try:
        with tempfile.TemporaryFile(dir=there) as file:
            file.write(bytes(1 << 16))
            file.flush()
            os.fsync(file.fileno())
        free = shutil.disk_usage(there).free
    except OSError as error:
        means = "Nothing is recorded there: choose another folder with --out, or make room."
        return Finding("disk", f"{folder} cannot be written ({error.strerror or error})", "fault", means)
    found = f"{free / 1e9:.1f} GB are free for {folder}"
    if free < least_free_bytes:
        means = f"Recordings end below {least_free_bytes / 1e9:g} GB: make room, or see --keep-free-gb."
        return Finding("disk", found, "warning", means)
    return Finding("disk", found)
