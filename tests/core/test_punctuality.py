"""Processes that answer in time leave alone what is loaded, and look for garbage only in what came since."""

import json
import subprocess
import sys

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
