"""`latentarm compare`: all models on recorded demonstrations."""

import sys
from pathlib import Path
from typing import Annotated, Literal

from tyro.conf import arg

from latentarm.commands.configuration import write_options
from latentarm.commands.output import say, show
from latentarm.runs.options import Jobs, Json, Seed
from latentarm_research.commands.study_options import Backend


def compare(
    demonstrations: Annotated[
        tuple[Path, ...], arg(metavar="DST ...", help="Folders of native datasets, all of one robot.")
    ],
    models: Annotated[
        tuple[str, ...] | None, arg(metavar="MODEL ...", help="Names of models; all by default.")
    ] = None,
    noise: Annotated[
        tuple[float, ...] | None,
        arg(metavar="RAD ...", help="SDs of noise on the states, rad; 0.01 and 0.1 by default."),
    ] = None,
    seeds: Annotated[int | None, arg(help="Seeds of each model in each fold; 5 by default.")] = None,
    folds: Annotated[int | None, arg(help="Parts of each dataset, each held out once; 5 by default.")] = None,
    reach_pairs: Annotated[
        int | None, arg(help="Starts and goals per fold for the greedy operator; 40 by default.")
    ] = None,
    ours: Annotated[
        str | None, arg(metavar="MODEL", help="The model that is compared with the targets and driven.")
    ] = None,
    preset: Annotated[
        Literal["paper", "smoke"], arg(help="Whole sizes, or small ones that only show that it runs.")
    ] = "paper",
    out: Annotated[Path, arg(metavar="DIR", help="Folder for page, figures and results.json.")] = Path(
        "compared"
    ),
    seed: Seed = 0,
    jobs: Jobs = -1,
    backend: Backend = "joblib",
    json: Json = False,
) -> int:
    """Compare all models on recorded demonstrations, with every episode held out once.

    For example: latentarm compare --demonstrations pour pick --noise 0.01 0.1
    """
    from dataclasses import replace

    from latentarm_research.studies.compare.preset import OURS, PRESETS
    from latentarm_research.studies.compare.study import compare_study
    from latentarm_research.studies.study import Request, run_study

    usual = PRESETS[preset]
    sizes = replace(
        usual,
        models=usual.models if models is None else models,
        noises_rad=usual.noises_rad if noise is None else noise,
        seeds=usual.seeds if seeds is None else seeds,
        folds=usual.folds if folds is None else folds,
        reach_pairs=usual.reach_pairs if reach_pairs is None else reach_pairs,
    )
    bars = not json and sys.stderr.isatty()
    request = Request(out, sizes, seed=seed, jobs=jobs, backend=backend, quiet=json, bars=bars)
    report = run_study(compare_study(demonstrations, sizes, ours or OURS, seed), request)
    write_options(out, "compare")
    show(report.rows, json, *report.tables)
    say(f"Page, figures and results.json are in {out}/ (begin with {out}/results.md).", json)
    return 0
