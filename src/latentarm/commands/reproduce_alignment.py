"""`latentarm reproduce alignment`: the paper's section 8.3."""

import sys
from pathlib import Path
from typing import Annotated, Literal

from tyro.conf import arg

from latentarm.commands.configuration import write_options
from latentarm.commands.options import Backend, Jobs, Json, PresetName, Seed
from latentarm.commands.output import say, show


def alignment(
    preset: PresetName = "paper",
    task: Annotated[
        Literal["all", "plane", "pour", "reach_and_pour", "table_top"],
        arg(help="One of the paper's tasks, drives at the demo's table, or all of it."),
    ] = "all",
    out: Annotated[Path, arg(metavar="DIR", help="Folder for page, figures and results.json.")] = Path(
        "reproduced/alignment"
    ),
    seed: Seed = 0,
    jobs: Jobs = -1,
    backend: Backend = "joblib",
    json: Json = False,
) -> int:
    """Learn from few answers what simulated people mean by their stick (section 8.3).

    For example: latentarm reproduce alignment --preset smoke --task plane
    """
    from latentarm.studies.alignment.preset import PRESETS
    from latentarm.studies.alignment.run import TASKS, AlignmentConfig, run_alignment
    from latentarm.studies.alignment.summary import summary_tables

    tasks = TASKS if task == "all" else (task,)
    bars = not json and sys.stderr.isatty()
    config = AlignmentConfig(out, PRESETS[preset], tasks, seed, jobs, backend, quiet=json, bars=bars)
    rows = run_alignment(config)
    write_options(out, "reproduce alignment")
    show(rows, json, *summary_tables(rows, config.preset))
    say(f"Page, figures and results.json are in {out}/ (begin with {out}/results.md).", json)
    return 0
