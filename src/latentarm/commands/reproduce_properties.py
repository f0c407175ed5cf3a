"""`latentarm reproduce properties`: the paper's section 8.1."""

import sys
from pathlib import Path
from typing import Annotated, Literal

from tyro.conf import arg

from latentarm.commands.configuration import write_options
from latentarm.commands.options import Backend, Jobs, Json, PresetName, Seed
from latentarm.commands.output import say, show, tables_by_task


def properties(
    preset: PresetName = "paper",
    task: Annotated[
        Literal["all", "sine", "rotate", "circle", "reach"], arg(help="One of the tasks, or all four.")
    ] = "all",
    out: Annotated[Path, arg(metavar="DIR", help="Folder for page, figures and results.json.")] = Path(
        "reproduced/properties"
    ),
    seed: Seed = 0,
    jobs: Jobs = -1,
    backend: Backend = "joblib",
    json: Json = False,
) -> int:
    """Measure the four properties of all models on the paper's planar tasks (section 8.1), simulated.

    For example: latentarm reproduce properties --preset smoke --task sine
    """
    from latentarm.studies.properties.preset import PRESETS
    from latentarm.studies.properties.run import PropertiesConfig, run_properties
    from latentarm.tasks.planar.catalogue import MOTIONS

    tasks = tuple(MOTIONS) if task == "all" else (task,)
    bars = not json and sys.stderr.isatty()
    config = PropertiesConfig(out, PRESETS[preset], tasks, seed, jobs, backend, quiet=json, bars=bars)
    rows = run_properties(config)
    write_options(out, "reproduce properties")
    show(rows, json, *tables_by_task(rows))
    say(f"Page, figures and results.json are in {out}/ (begin with {out}/results.md).", json)
    return 0
