"""`latentarm reproduce shared-autonomy`: the paper's section 8.2."""

import sys
from pathlib import Path
from typing import Annotated, Literal

from tyro.conf import arg

from latentarm.commands.configuration import write_options
from latentarm.commands.options import Backend, Jobs, Json, PresetName, Seed
from latentarm.commands.output import say, show


def shared_autonomy(
    preset: PresetName = "paper",
    task: Annotated[
        Literal["all", "planar_two_cups", "panda_two_cups"],
        arg(help="Two cups before one of the arms, or before both."),
    ] = "all",
    out: Annotated[Path, arg(metavar="DIR", help="Folder for page, figures and results.json.")] = Path(
        "reproduced/shared-autonomy"
    ),
    seed: Seed = 0,
    jobs: Jobs = -1,
    backend: Backend = "joblib",
    json: Json = False,
) -> int:
    """Let simulated people reach and change goals with help and without (section 8.2).

    For example: latentarm reproduce shared-autonomy --preset smoke
    """
    from latentarm.studies.shared_autonomy.cell import TASKS
    from latentarm.studies.shared_autonomy.preset import PRESETS
    from latentarm.studies.shared_autonomy.run import SharedAutonomyConfig, run_shared_autonomy
    from latentarm.studies.shared_autonomy.summary import summary_tables

    tasks = tuple(TASKS) if task == "all" else (task,)
    bars = not json and sys.stderr.isatty()
    config = SharedAutonomyConfig(out, PRESETS[preset], tasks, seed, jobs, backend, quiet=json, bars=bars)
    rows = run_shared_autonomy(config)
    write_options(out, "reproduce shared-autonomy")
    show(rows, json, *summary_tables(rows))
    say(f"Page, figures and results.json are in {out}/ (begin with {out}/results.md).", json)
    return 0
