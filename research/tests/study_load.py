"""How many people a machine serves: each drives an arm in physics, and skipped ticks of loops are counted.

As a command, on an idle machine: ``python research/tests/study_load.py 1 2 3 4``.
"""

import json
import sys
import tempfile
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numpy as np

from latentarm_research.user_studies.drive_steps import read_steps
from latentarm_research.user_studies.serving.study_files import STEPS
from study_participant import MODES, TWIST, definition, next_link, participant, serving

PERIOD_S = 0.01
DRIVES_S = 20.0
SETTLED_S = 1.0
"""After the beginning of a drive, in which pages load."""


def missed(path: Path) -> tuple[int, int]:
    """The ticks that were skipped in a drive, and all that were due."""
    times_s = np.array([record.time_s for _, record, _ in read_steps(path)[1]])
    gaps = np.rint(np.diff(times_s[times_s > times_s[0] + SETTLED_S]) / PERIOD_S)
    return int((gaps - 1.0).clip(0.0).sum()), int(gaps.sum())


def load(people: int) -> dict[str, float]:
    """So many people drive at once."""
    folder = Path(tempfile.mkdtemp())
    study, out = folder / "load.json", folder / "people"
    given = definition(MODES, TWIST)
    task = {**given["tasks"][0], "trials": 1, "trial_s": DRIVES_S}
    study.write_text(json.dumps({**given, "name": "load", "people": max(people, 2), "tasks": [task]}))
    options = ("--out", str(out), "--preset", "paper", "--at-once", str(people))
    with serving(str(study), *options) as (link, _):

        def drives(number: int) -> None:
            with participant(link, next_link(out, number)) as person:
                person.consent()
                person.ready()
                person.drive()

        with ThreadPoolExecutor(people) as pool:
            list(pool.map(drives, range(people)))
    found = [missed(path) for path in (out / STEPS).rglob("*.safetensors")]
    assert len(found) == people
    shares = [skipped / due for skipped, due in found]
    return {"people": people, "missed, mean": sum(shares) / people, "missed, worst": max(shares)}


if __name__ == "__main__":
    for count in map(int, sys.argv[1:]):
        sys.stdout.write(json.dumps(load(count)) + "\n")
        sys.stdout.flush()
