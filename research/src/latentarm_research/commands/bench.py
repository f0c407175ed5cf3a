"""`latentarm bench`: timings as ratios within one run."""

import sys
from typing import Annotated

from tyro.conf import arg

from latentarm.commands.output import show
from latentarm.runs.options import Json, Seed


def bench(
    repeats: Annotated[int, arg(help="Timed online steps.")] = 20_000,
    seed: Seed = 0,
    json: Json = False,
) -> int:
    """Time the online step, and training ten seeds in one fit and one after the other.

    For example: latentarm bench --json
    """
    from latentarm_research.commands.bench_step import run_bench

    rows = run_bench(repeats=repeats, seed=seed, progress=not json and sys.stderr.isatty())
    show(rows, json)
    return 0
