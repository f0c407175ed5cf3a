"""The folder of a study's run: claimed, written, and read again."""

import json
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final, cast

from latentarm.core.errors import UserError
from latentarm.core.files import write_text
from latentarm.core.types import Row
from latentarm.core.untrusted.documents import read_object
from latentarm.evaluation.results import write_results
from latentarm.evaluation.summary import Subject, summarise
from latentarm.runs.results_folder import CONFIG, ResultsFolder, write_json
from latentarm_research.user_studies.analysis.analysis import Analysis
from latentarm_research.user_studies.analysis.means import person_mean
from latentarm_research.user_studies.answers.scales import Ratings
from latentarm_research.user_studies.catalogue import NAMES, load_definition
from latentarm_research.user_studies.definition import Definition
from latentarm_research.user_studies.folder_name import PREFIX, folder_name
from latentarm_research.user_studies.own.definition_file import read_definition
from latentarm_research.user_studies.power import Power
from latentarm_research.user_studies.record import Trial, read_trial

if TYPE_CHECKING:
    from latentarm_research.user_studies.run import Ran, Request

DEFINITION: Final = "definition.json"
TRIALS: Final = "trials.json"
TRACES: Final = "traces.json"
POWER: Final = "power.json"
ANALYSIS: Final = "analysis.json"
RATINGS: Final = "ratings.json"
RESULTS: Final = "results.json"
DOCUMENTS: Final = (DEFINITION, TRIALS, TRACES, "people.json", ANALYSIS, RESULTS)
"""What follows from definition, sizes, people and seed alone: the same bytes wherever it is computed."""


def claim(request: "Request", further: Sequence[str]) -> None:
    """Make room in the folder, see `latentarm.runs.results_folder.ResultsFolder.claim`.

    Args:
        request: what was asked for.
        further: files that will be written besides `DOCUMENTS` and ``timings.json``.

    Raises:
        UserError: the folder holds something else.
    """
    made = (*DOCUMENTS, "timings.json", *further)
    ResultsFolder(folder_name(request.definition), made).claim(request.out, request.about)


def write_documents(request: "Request", ran: "Ran") -> list[Row]:
    """Write everything but the report.

    Returns:
        The rows of ``results.json``.

    Raises:
        UserError: a file cannot be written.
    """
    out, about = request.out, request.about
    rows = rows_of(ran.definition, ran.analysis.trials)
    write_json(out / DEFINITION, {"digest": ran.definition.digest, **ran.definition.as_json()})
    write_json(out / TRIALS, _dated(about, "trials", [trial.as_json() for trial in ran.trials]))
    traces = _dated(about, "traces", [trace.as_json() for trace in ran.traces])
    write_text(out / TRACES, json.dumps(traces, separators=(",", ":"), allow_nan=False) + "\n")
    write_json(out / "people.json", _dated(about, "people", [dict(one.as_json()) for one in ran.people]))
    write_json(out / ANALYSIS, {**about, **ran.analysis.as_json()})
    timings = {"backend": request.backend, "jobs": request.jobs, "grid_s": ran.grid_s}
    write_json(out / "timings.json", timings)
    write_results(out / RESULTS, rows, about)
    return rows


def claim_power(out: Path, definition: Definition, about: Mapping[str, object]) -> None:
    """Make room for ``power.json``, see `latentarm.runs.results_folder.ResultsFolder.claim`.

    Args:
        out: the folder.
        definition: of the study.
        about: draws, seed, and whom studies are drawn from.

    Raises:
        UserError: the folder holds something else.
    """
    name = f"power of {folder_name(definition)}"
    ResultsFolder(name, (POWER,)).claim(out, {"study": name, "definition": definition.digest, **about})


def write_power(out: Path, power: Power) -> None:
    """Write ``power.json``, whole or not at all.

    Args:
        out: the folder.
        power: as found.

    Raises:
        UserError: the file cannot be written.
    """
    write_json(out / POWER, power.as_json())


def claim_analysis(
    out: Path, definition: Definition, about: Mapping[str, object], further: Sequence[str]
) -> None:
    """Make room for an analysis, see `latentarm.runs.results_folder.ResultsFolder.claim`.

    Args:
        out: the folder.
        definition: of the study.
        about: whose trials and answers are analysed.
        further: files of the report.

    Raises:
        UserError: the folder holds something else.
    """
    name = f"analysis of {folder_name(definition)}"
    made = (ANALYSIS, RATINGS, RESULTS, *further)
    ResultsFolder(name, made).claim(out, {"study": name, "definition": definition.digest, **about})


def write_analysis(
    out: Path, about: Mapping[str, object], analysis: Analysis, rows: list[Row], ratings: Ratings | None
) -> None:
    """Write what an analysis of recorded trials says, without the report.

    Args:
        out: the folder.
        about: whose trials and answers were analysed.
        analysis: of the trials.
        rows: of ``results.json``.
        ratings: of people's answers, if there are any.

    Raises:
        UserError: a file cannot be written.
    """
    write_json(out / ANALYSIS, {**about, **analysis.as_json()})
    if ratings is not None:
        write_json(out / RATINGS, {**about, **ratings.as_json()})
    write_results(out / RESULTS, rows, about)


def rows_of(definition: Definition, trials: Sequence[Trial]) -> list[Row]:
    """Mean and SD over people of their means, for every task, condition and measure that has figures."""
    people = sorted({trial.person for trial in trials})
    rows: list[Row] = []
    for task in definition.tasks:
        for condition in definition.conditions:
            subject = Subject(folder_name(definition), task=task.name, condition=condition.name)
            for measure in definition.measures:
                means = [
                    person_mean(trials, person, measure, (condition.name,), (task.name,)) for person in people
                ]
                row = summarise(subject, measure, means)
                if row.n:
                    rows.append(row)
    return rows


def read_trials(folder: Path) -> tuple[Definition, list[Trial]]:
    """The trials of a run, and the study that they are of.

    Raises:
        UserError: the folder holds no run of a study, or of a definition that has changed since.
    """
    study = str(read_object(folder / CONFIG).get("study", ""))
    name = study.removeprefix(PREFIX)
    if not study.startswith(PREFIX):
        raise UserError(
            f"{folder} holds no run of a user study: name a folder that latentarm study run made."
        )
    definition = load_definition(name) if name in NAMES else read_definition(folder / DEFINITION)
    document = read_object(folder / TRIALS)
    if document.get("definition") != definition.digest:
        raise UserError(
            f"{folder} was made with another definition of the study {name}: run it again, or use the version"
            " of latentarm that made it."
        )
    trials = document.get("trials")
    if not isinstance(trials, list):
        raise UserError(f"{folder / TRIALS} must hold a list of trials.")
    return definition, [
        read_trial(entry, f"{folder / TRIALS}, trial {index}")
        for index, entry in enumerate(cast(list[Any], trials))
    ]


def _dated(about: Mapping[str, object], name: str, entries: list[dict[str, object]]) -> dict[str, object]:
    return {**about, name: entries}
