"""`latentarm compare`: all models on recorded demonstrations."""

from dataclasses import replace
from pathlib import Path
from typing import Annotated, Literal

from tyro.conf import arg

from latentarm_research.commands.study_options import StudyOptions, run_and_show


def compare(
    demonstrations: Annotated[
        tuple[Path, ...], arg(metavar="DST ...", help="Folders of native datasets, all of one robot.")
    ],
    options: StudyOptions,
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
        str | None, arg(metavar="MODEL", help="The model that is driven, beside mode switching and the cVAE.")
    ] = None,
    preset: Annotated[
        Literal["paper", "smoke"], arg(help="Whole sizes, or small ones that only show that it runs.")
    ] = "paper",
    out: Annotated[Path, arg(metavar="DIR", help="Folder for page, figures and results.json.")] = Path(
        "compared"
    ),
) -> int:
    """Compare all models on recorded demonstrations, with every episode held out once.

    For example: latentarm compare --demonstrations pour pick --noise 0.01 0.1
    """
    from latentarm_research.studies.compare.preset import PRESETS
    from latentarm_research.studies.compare.study import compare_study

    asked = {
        "models": models,
        "noises_rad": noise,
        "seeds": seeds,
        "folds": folds,
        "reach_pairs": reach_pairs,
        "ours": ours,
    }
    sizes = replace(PRESETS[preset], **{name: value for name, value in asked.items() if value is not None})
    study = compare_study(demonstrations, sizes, options.seed)
    run_and_show(study, options.request(out, sizes), "compare")
    return 0
