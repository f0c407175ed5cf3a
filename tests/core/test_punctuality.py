"""Processes that answer in time leave alone what is loaded, and look for garbage only in what came since."""

import json
import subprocess
import sys
import threading
import time

from latentarm.core.punctuality import OwnPauses

BLOCK = """
import gc, json
import numpy
from latentarm.core.punctuality import short_collections
found = [len(gc.get_objects())]
with short_collections():
    found.append(len(gc.get_objects()))
found.append(len(gc.get_objects()))
print(json.dumps(found))
"""

SERVED = """
import gc, json, sys
from pathlib import Path
from latentarm.web.arm_process.drive_setup import Spec
from latentarm.web.server import app
from latentarm.web.server.config import TeleopConfig

async def count(*_):
    found.append(len(gc.get_objects()))

if __name__ == "__main__":
    found = [len(gc.get_objects())]
    app.serve_on = count
    app.serve(TeleopConfig(Spec(out=Path(sys.argv[1])), port=0), lambda sentence: None)
    print(json.dumps(found))
"""


def counted(*command: str) -> list[int]:
    done = subprocess.run([sys.executable, *command], capture_output=True, text=True, check=True)
    return json.loads(done.stdout.splitlines()[-1])


def test_a_collection_skips_what_was_loaded_before_it_as_long_as_the_block_lasts():
    before, inside, after = counted("-c", BLOCK)
    assert inside < before / 10
    assert after > before / 2


def test_the_web_server_collects_only_what_came_since_it_began_to_serve(tmp_path):
    script = tmp_path / "served.py"
    script.write_text(SERVED)
    before, serving = counted(str(script), str(tmp_path))
    assert serving < before / 10


class Clock(threading.Event):
    """Time passes by waiting, and a wait ends later by ``late_s``."""

    now_s = late_s = 0.0

    def wait(self, timeout=None):
        self.now_s += timeout + self.late_s
        return False


def test_a_program_that_was_held_up_itself_does_not_blame_the_cable(monkeypatch):
    clock, pauses = Clock(), OwnPauses()
    monkeypatch.setattr(time, "monotonic", lambda: clock.now_s)
    clock.late_s = 0.02
    pauses.wait(clock, 0.01)
    assert pauses.or_else("check the cable") == "check the cable"
    clock.late_s = 0.25
    pauses.wait(clock, 0.01)
    clock.late_s = 0.0
    pauses.wait(clock, 0.01)
    said = pauses.or_else("check the cable")
    assert said.startswith("this computer held up this program itself for 250 ms")
    clock.now_s += 3.0
    assert pauses.or_else("check the cable") == "check the cable"
