"""Options of the commands that run studies, and what each of these commands does with its study."""

import sys
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal, TypeVar

from tyro.conf import arg

from latentarm.commands.configuration import write_options
from latentarm.commands.output import say, show
from latentarm.runs.options import Jobs, Json, Seed
from latentarm_research.user_studies.catalogue import NAMES

if TYPE_CHECKING:
    from latentarm_research.studies.study import Request, Sizes, Study

Preset = TypeVar("Preset", bound="Sizes")

Backend = Annotated[
    Literal["joblib", "ray", "dask"],
    arg(
        help="Processes of this machine, or a cluster: that of RAY_ADDRESS or DASK_SCHEDULER_ADDRESS,"
        " or else a new one here."
    ),
]

StudyName = Annotated[
    str,
    arg(
        metavar="{" + ",".join(NAMES) + ",FILE.json}",
        help="The study, or a JSON file with the definition of one of your own.",
    ),
]

Database = Annotated[
    str | None,
    arg(
        metavar="URL",
        help="postgresql://USER@HOST/NAME of the study's database; without it, a file in its folder. The"
        " password belongs in ~/.pgpass.",
    ),
]


def beside(folder: Path, kind: str) -> Path:
    """The folder for what is made of a folder: its name, and the kind."""
    named = folder if folder.name.strip(".") else folder.resolve()
    return named.with_name(f"{named.name}-{kind}")


@dataclass(frozen=True)
class StudyOptions:
    """Options of every study."""

    seed: Seed = 0
    jobs: Jobs = -1
    backend: Backend = "joblib"
    json: Json = False

    def request(self, out: Path, preset: Preset, tasks: tuple[str, ...] = ()) -> "Request[Preset]":
        """Build the request. Raises a `UserError` where an option is out of its range."""
        from latentarm_research.studies.study import Request

        return Request(
            out,
            preset,
            tasks,
            seed=self.seed,
            jobs=self.jobs,
            backend=self.backend,
            quiet=self.json,
            bars=not self.json and sys.stderr.isatty(),
        )


def run_and_show(
    study: "Study[Preset, Any]",
    request: "Request[Preset]",
    command: str,  # the words after `latentarm` that its options are kept under
    page: str = "results.md",
) -> None:
    """Run a study, keep the options, and print it at a glance."""
    from latentarm_research.studies.page import SMOKE
    from latentarm_research.studies.study import run_study

    report = run_study(study, request)
    out, json = request.out, request.quiet
    write_options(out, command)
    show(report.rows, json, *report.tables)
    if request.preset.name == SMOKE:
        say(f"The preset {SMOKE} only shows that the study runs: nothing is judged.", json)
    say(f"Page, figures and results.json are in {out}/ (begin with {out}/{page}).", json)
