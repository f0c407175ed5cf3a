"""Detects when the computer is too busy for tests in real time.

A page has 120 ms for its next input. A test in real time that failed while the computer kept everything
waiting shows nothing, so it is run again, and the summary names it. One that fails while the computer gave it
its time has failed.
"""

import subprocess
import sys
import tempfile
import time
from pathlib import Path

LATE_S = 0.04
"""A sleep that ends so much too late, s, is written down. A page sends every 20 ms what counts for 50."""

_SLEEPER = f"""
import time
while True:
    due_s = time.monotonic() + 0.005
    time.sleep(0.005)
    if time.monotonic() - due_s > {LATE_S}:
        print(time.monotonic(), flush=True)
"""


class Canary:
    """A process that sleeps 5 ms at a time and writes down when it was woken late."""

    def __init__(self) -> None:
        self._folder = tempfile.TemporaryDirectory()
        self._file = Path(self._folder.name, "late")
        with self._file.open("w") as out:
            self._process = subprocess.Popen([sys.executable, "-S", "-c", _SLEEPER], stdout=out)
        self._began_s = 0.0

    def begin(self) -> None:
        """From now on it counts."""
        self._began_s = time.monotonic()

    def was_late(self) -> bool:
        """Whether it has woken up late since `begin`."""
        time.sleep(0.02)  # it too was kept waiting
        return any(float(line) >= self._began_s for line in self._file.read_text().splitlines())

    def end(self) -> None:
        """End the process."""
        self._process.kill()
        self._process.wait()
        self._folder.cleanup()
