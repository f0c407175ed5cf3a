"""`latentarm measure`: what is behind figures of the documentation, a command for each measurement."""

import sys
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Annotated, Any

from tyro.conf import arg

from latentarm.commands.configuration import Command, write_options
from latentarm.commands.output import note, say, show
from latentarm.runs.options import Jobs, Json, Seed
from latentarm_research.measurements.catalogue import MEASUREMENTS, load_measurement


@dataclass(frozen=True)
class Common:
    """Options of every measurement; the command line describes each."""

    seed: Seed = 0  # of everything random
    jobs: Jobs = 1  # processes side by side
    json: Json = False  # print one JSON document
    # smallest sizes
    smoke: Annotated[bool, arg(help="Smallest sizes, which only show that it runs.")] = False


def command_of(
    name: str,  # a name in `MEASUREMENTS`
) -> Command:
    """The command that runs a measurement."""
    entry = MEASUREMENTS[name]

    def measure(
        own: Any,
        common: Common,
        out: Annotated[Path, arg(metavar="DIR", help="Folder for results.md and results.json.")] = Path(
            "measured", name
        ),
    ) -> int:
        return _measure(name, replace(own, **entry.smoke) if common.smoke else own, common, out)

    measure.__annotations__["own"] = entry.options
    measure.__doc__ = f"{entry.summary}\n\nFor example: latentarm measure {name} --seed 1"
    return measure


def _measure(name: str, own: Any, common: Common, out: Path) -> int:
    """Measure, write and print; 1 where a limit is broken."""
    from latentarm.core.files import write_text
    from latentarm.core.parallel import check_jobs
    from latentarm.evaluation.results import as_document
    from latentarm.runs.checks import check_seed
    from latentarm.runs.folder import git_commit
    from latentarm.runs.results_folder import write_json
    from latentarm_research.measurements.measurement import Work
    from latentarm_research.measurements.page import page_of, repeated_by
    from latentarm_research.studies.results_folder import ResultsFolder

    check_seed(common.seed)
    check_jobs(common.jobs)
    words = f"measure {name}"
    command = repeated_by(name, own, common.seed)
    about: dict[str, object] = {"study": words, "command": command}
    kept: tuple[str, ...] = ()
    if MEASUREMENTS[name].resumes:
        kept, grown = ("runs", "models"), replace(own, runs=1)
        about |= {"command": repeated_by(name, grown, common.seed), "code": git_commit()}
    ResultsFolder(words, ("results.json", "results.md"), kept).claim(out, about)
    work = Work(common.seed, common.jobs, not common.json and sys.stderr.isatty(), out)
    outcome = load_measurement(name)(own, work)
    page = page_of(MEASUREMENTS[name].summary, outcome, command)
    write_text(out / "results.md", page)
    for file, document in outcome.documents.items():
        write_json(out / file, document)
    said = {"study": words, "command": command, "broken": list(outcome.broken)}
    write_json(out / "results.json", as_document(outcome.rows, said))
    write_options(out, words)
    if common.json:
        show(outcome.rows, json=True)
    else:
        print(page)
    note([f"a limit is broken: {sentence}" for sentence in outcome.broken])
    say(f"Page and results.json are in {out}/ (begin with {out}/results.md).", common.json)
    return 1 if outcome.broken else 0


def __getattr__(name: str) -> Command:
    """The command of a measurement, by its name with underscores."""
    words = name.replace("_", "-")
    if words not in MEASUREMENTS:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return command_of(words)
