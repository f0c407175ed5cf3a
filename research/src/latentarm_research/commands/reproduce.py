"""`latentarm reproduce`: the paper's simulations, a command for each study of the catalogue."""

import inspect
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

from tyro.conf import UseAppendAction, arg

from latentarm.commands.configuration import Command, write_options
from latentarm.commands.output import say, show
from latentarm.core.errors import UserError
from latentarm_research.commands.study_options import StudyOptions
from latentarm_research.studies.catalogue import STUDIES, load_study

if TYPE_CHECKING:
    from rich.console import RenderableType

    from latentarm.core.types import Row

ALL = "all"


def command_of(
    name: str,  # a name in `STUDIES`
) -> Command:
    """The command that runs a study."""
    entry = STUDIES[name]
    choices, presets = ("{" + ",".join(names) + "}" for names in ((ALL, *entry.tasks), entry.presets))
    about_presets = "; ".join(f"{name}: {about}" for name, about in entry.presets.items()) + "."

    def reproduce(
        options: StudyOptions,
        preset: Annotated[str, arg(metavar=presets, help=about_presets)] = "paper",
        task: Annotated[
            UseAppendAction[tuple[str, ...]],
            arg(metavar=choices, help=f"{entry.about_tasks} May be given several times; by default all."),
        ] = (),
        out: Annotated[Path, arg(metavar="DIR", help="Folder for page, figures and results.json.")] = Path(
            "reproduced", name
        ),
        people: Annotated[
            UseAppendAction[tuple[str, ...]],
            arg(metavar="NAME", help="Simulated person who drives, also several; by default the preset's."),
        ] = (),
        runs: Annotated[
            int | None, arg(metavar="N", help="Runs in each condition; by default the preset's.")
        ] = None,
    ) -> int:
        return _reproduce(name, preset, task, out, options, people, runs)

    if not entry.people:
        signature = inspect.signature(reproduce)
        asked = [one for key, one in signature.parameters.items() if key not in ("people", "runs")]
        reproduce.__signature__ = signature.replace(parameters=asked)  # pyright: ignore[reportFunctionMemberAccess]
    reproduce.__doc__ = (
        f"{entry.summary}\n\nFor example: latentarm reproduce {name} --preset smoke --task {entry.tasks[0]}"
    )
    return reproduce


def _reproduce(
    name: str,
    preset: str,
    task: tuple[str, ...],
    out: Path,
    options: StudyOptions,
    people: tuple[str, ...],
    runs: int | None,
) -> int:
    """Run a study and print it at a glance."""
    from latentarm_research.studies.page import SMOKE
    from latentarm_research.studies.study import Request, run_study

    study = load_study(name)
    if preset not in study.presets:
        raise UserError(f"There is no preset {preset!r}: choose from {', '.join(study.presets)}.")
    sizes = study.presets[preset]
    request = Request(
        out=out,
        preset=sizes.asked(people, runs) if people or runs is not None else sizes,
        tasks=() if ALL in task else task,
        seed=options.seed,
        jobs=options.jobs,
        backend=options.backend,
        quiet=options.json,
        bars=not options.json and sys.stderr.isatty(),
    )
    report = run_study(study, request)
    write_options(out, study.command)
    show(report.rows, options.json, *(report.tables or _tables_by_task(report.rows)))
    if preset == SMOKE:
        say(f"The preset {preset} only shows that the study runs: nothing is judged.", options.json)
    say(f"Page, figures and results.json are in {out}/ (begin with {out}/results.md).", options.json)
    return 0


def __getattr__(name: str) -> Command:
    """The command of a study, by its name with underscores."""
    words = name.replace("_", "-")
    if words not in STUDIES:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return command_of(words)


def _tables_by_task(rows: "Sequence[Row]") -> "list[RenderableType]":
    """One table per task, of the rows without a condition."""
    from latentarm.core.untrusted.console import VisibleConsole
    from latentarm.evaluation.table import rich_tables

    width = VisibleConsole().width
    main_rows = [row for row in rows if row.condition is None]
    return [
        rich_tables([row for row in main_rows if row.task == task], title=f"{task}, simulated", width=width)
        for task in dict.fromkeys(row.task for row in main_rows)
    ]
