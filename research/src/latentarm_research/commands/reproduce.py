"""`latentarm reproduce`: the paper's simulations, a command for each study of the catalogue."""

import inspect
from pathlib import Path
from typing import Annotated

from tyro.conf import UseAppendAction, arg

from latentarm.commands.configuration import Command
from latentarm.core.errors import UserError
from latentarm_research.commands.study_options import StudyOptions, run_and_show
from latentarm_research.studies.catalogue import STUDIES, load_study

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
        study = load_study(name)
        if preset not in study.presets:
            raise UserError(f"There is no preset {preset!r}: choose from {', '.join(study.presets)}.")
        sizes = study.presets[preset]
        if people or runs is not None:
            sizes = sizes.asked(people, runs)
        request = options.request(out, sizes, () if ALL in task else task)
        run_and_show(study, request, study.command)
        return 0

    if not entry.people:
        signature = inspect.signature(reproduce)
        asked = [one for key, one in signature.parameters.items() if key not in ("people", "runs")]
        reproduce.__signature__ = signature.replace(parameters=asked)  # pyright: ignore[reportFunctionMemberAccess]
    reproduce.__doc__ = (
        f"{entry.summary}\n\nFor example: latentarm reproduce {name} --preset smoke --task {entry.tasks[0]}"
    )
    return reproduce


def __getattr__(name: str) -> Command:
    """The command of a study, by its name with underscores."""
    words = name.replace("_", "-")
    if words not in STUDIES:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return command_of(words)
