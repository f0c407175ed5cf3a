"""How often the arm stops by itself on a busy computer with many pages open, and why.

A real `latentarm teleop`, one page without a browser that drives, others that watch, and processes that do
nothing but compute. For example:

    python scripts/teleop_crowd.py --watchers 15 --busy 15 --seconds 60
"""

import argparse
import json
import multiprocessing
import os
import tempfile
import time
from contextlib import ExitStack
from pathlib import Path

from teleop_flood import drive, serving
from teleop_latency import Page


def compute() -> None:
    """Keep one core busy until killed."""
    while True:
        sum(range(100_000))


def watch(port: int, pages: int) -> None:
    """Keep pages open that only watch, until killed."""
    with ExitStack() as opened:
        for _ in range(pages):
            opened.enter_context(Page(port))
        while True:
            time.sleep(1.0)


def main() -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--watchers", type=int, default=15)
    parser.add_argument("--busy", type=int, default=15, help="processes that compute")
    parser.add_argument("--seconds", type=float, default=60.0)
    chosen = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder, serving(Path(folder)) as server, Page(server.port) as page:
        # Watchers have a process of their own, so that they do not hold up the page that drives.
        others = [multiprocessing.Process(target=watch, args=(server.port, chosen.watchers), daemon=True)]
        others += [multiprocessing.Process(target=compute, daemon=True) for _ in range(chosen.busy)]
        for process in others:
            process.start()
        try:
            found = drive(page, chosen.seconds)
        finally:
            for process in others:
                process.kill()
    print(json.dumps({"load": os.getloadavg(), **found}, indent=2))


if __name__ == "__main__":
    main()
