"""Serve the page as `latentarm teleop --task` does, with a calendar that is some days behind.

Records are dated by that calendar, so that a week of drives can be made in an afternoon. All else runs by the
computer's clocks. For example:

    python scripts/teleop_on_day.py --days-ago 3 --task marshmallows --port 8460 --out teleop
"""

import argparse
from datetime import UTC, datetime, timedelta
from functools import partial
from pathlib import Path

from latentarm.tasks.catalogue import SCENE_TASKS, TASKS
from latentarm.web.arm_process.drive_setup import Spec
from latentarm.web.records.calendar import Calendar
from latentarm.web.server.addresses import TeleopConfig
from latentarm.web.server.app import serve


def main() -> None:
    """Serve until Ctrl-C."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("--days-ago", type=int, required=True)
    parser.add_argument("--task", choices=[*TASKS, *SCENE_TASKS], required=True)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--port", type=int, default=0)
    parser.add_argument("--out", type=Path, required=True, help="folder for what is recorded")
    given = parser.parse_args()
    behind = timedelta(days=given.days_ago)
    config = TeleopConfig(Spec(seed=given.seed, out=given.out, task=given.task), port=given.port)
    serve(config, partial(print, flush=True), calendar=Calendar(lambda: datetime.now(UTC) - behind))


if __name__ == "__main__":
    main()
