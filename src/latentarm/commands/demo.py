"""`latentarm demo`: the main job on embedded defaults."""

import sys
from pathlib import Path
from typing import Annotated

from tyro.conf import arg

from latentarm.commands.configuration import write_options
from latentarm.commands.options import Json, Seed
from latentarm.commands.output import say, show
from latentarm.commands.teleop import teleop


def demo(
    out: Annotated[Path, arg(metavar="DIR", help="Folder for datasets, runs, table and figures.")] = Path(
        "demo"
    ),
    drives: Annotated[int, arg(help="Simulated drives for each goal and condition.")] = 20,
    seed: Seed = 0,
    jobs: Annotated[int, arg(help="Processes that drive side by side; -1 is one per core.")] = -1,
    json: Json = False,
) -> int:
    """Learn latent actions and drive a 7-DoF Panda to three goals, against mode switching.

    In a terminal it ends with the page of `latentarm teleop`. For example: latentarm demo --out demo
    """
    from latentarm.commands.demo_body import DemoConfig, run_demo

    bars = not json and sys.stderr.isatty()
    rows = run_demo(DemoConfig(out, drives, seed, jobs, quiet=json, bars=bars))
    write_options(out, "demo")
    show(rows, json)
    say(f"Table, figures, datasets and runs are in {out}/ (begin with {out}/results.md).", json)
    run = out / "runs" / "cvae"
    if json or not (sys.stdin.isatty() and sys.stdout.isatty()):
        say(f"To drive the arm yourself: latentarm teleop {run}", json)
        return 0
    return teleop(run, port=0, out=out / "teleop")
