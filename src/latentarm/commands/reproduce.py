"""`latentarm reproduce`: the paper's three simulations."""

import sys
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal

from tyro.conf import arg

from latentarm.commands.configuration import write_options
from latentarm.commands.options import StudyOptions
from latentarm.commands.output import say, show, tables_by_task

if TYPE_CHECKING:
    from latentarm.studies.study import Study

Out = Annotated[Path, arg(metavar="DIR", help="Folder for page, figures and results.json.")]


def properties(
    options: StudyOptions,
    task: Annotated[
        Literal["all", "sine", "rotate", "circle", "reach"], arg(help="One of the tasks, or all four.")
    ] = "all",
    out: Out = Path("reproduced/properties"),
) -> int:
    """Measure the four properties of all models on the paper's planar tasks (section 8.1), simulated.

    For example: latentarm reproduce properties --preset smoke --task sine
    """
    from latentarm.studies.properties.study import STUDY

    return _reproduce(STUDY, task, out, options)


def shared_autonomy(
    options: StudyOptions,
    task: Annotated[
        Literal["all", "planar_two_cups", "panda_two_cups"],
        arg(help="Two cups before one of the arms, or before both."),
    ] = "all",
    out: Out = Path("reproduced/shared-autonomy"),
) -> int:
    """Let simulated people reach and change goals with help and without (section 8.2).

    For example: latentarm reproduce shared-autonomy --preset smoke
    """
    from latentarm.studies.shared_autonomy.study import STUDY

    return _reproduce(STUDY, task, out, options)


def alignment(
    options: StudyOptions,
    task: Annotated[
        Literal["all", "plane", "pour", "reach_and_pour", "table_top"],
        arg(help="One of the paper's tasks, drives at the demo's table, or all of it."),
    ] = "all",
    out: Out = Path("reproduced/alignment"),
) -> int:
    """Learn from few answers what simulated people mean by their stick (section 8.3).

    For example: latentarm reproduce alignment --preset smoke --task plane
    """
    from latentarm.studies.alignment.study import STUDY

    return _reproduce(STUDY, task, out, options)


def _reproduce(study: "Study[Any, Any]", task: str, out: Path, options: StudyOptions) -> int:
    """Run a study and print it at a glance."""
    from latentarm.studies.study import Request, run_study

    request = Request(
        out=out,
        preset=study.presets[options.preset],
        tasks=() if task == "all" else (task,),
        seed=options.seed,
        jobs=options.jobs,
        backend=options.backend,
        quiet=options.json,
        bars=not options.json and sys.stderr.isatty(),
    )
    report = run_study(study, request)
    write_options(out, study.command)
    show(report.rows, options.json, *(report.tables or tables_by_task(report.rows)))
    say(f"Page, figures and results.json are in {out}/ (begin with {out}/results.md).", options.json)
    return 0
