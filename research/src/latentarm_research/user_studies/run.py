"""A user study with simulated people, as a study that the one runner runs; finished sessions are kept."""

import json
from collections.abc import Mapping
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Final

from latentarm.core.errors import UserError
from latentarm.core.files import write_text
from latentarm.core.untrusted.documents import read_object
from latentarm_research.people.population import draw_people
from latentarm_research.people.traits import Traits
from latentarm_research.studies import fitting, streams
from latentarm_research.studies.results_folder import package_versions, source_digest
from latentarm_research.studies.streams import generator
from latentarm_research.studies.study import Grid, Keep, Report, Request, Study, again
from latentarm_research.user_studies import (
    alignments,
    conditions,
    designs,
    drive_record,
    scenes,
    session,
    training,
)
from latentarm_research.user_studies.definition import Definition
from latentarm_research.user_studies.designs import design_of
from latentarm_research.user_studies.record import read_trials
from latentarm_research.user_studies.recorded import DOCUMENTS, Recorded
from latentarm_research.user_studies.report.figures import figure_names
from latentarm_research.user_studies.report.page import ANALYSIS, report_of
from latentarm_research.user_studies.session import Session, SessionCell, go_through
from latentarm_research.user_studies.sizes import PRESETS, Sizes, Stream, sizes_of
from latentarm_research.user_studies.trace import read_traces
from latentarm_research.user_studies.training import Trained, TrainingCell, train

SESSIONS: Final = "sessions"  # the folder of the sessions


def _session_path(out: Path, cell: SessionCell) -> Path:
    return out / SESSIONS / f"{cell.traits.number}_{cell.order}_{cell.task.name}.json"


def _write_session(path: Path, cell: SessionCell, session: Session) -> None:
    document = {
        "trials": [trial.as_json() for trial in session.trials],
        "traces": [trace.as_json() for trace in session.traces],
    }
    write_text(path, json.dumps(document, separators=(",", ":"), allow_nan=False) + "\n")


def _read_session(path: Path, cell: SessionCell) -> Session:
    document = read_object(path)
    session = Session(read_trials(document, path), read_traces(document, path))
    wanted = (cell.traits.number, cell.condition.name, cell.task.name)
    if any((one.person, one.condition, one.task) != wanted for one in (*session.trials, *session.traces)):
        raise UserError(f"{path} holds another session: remove it, and it is gone through again.")
    return session


KEEP_SESSIONS: Final = Keep(_session_path, _read_session, _write_session)


def study_of(
    definition: Definition,
    named: str = "",  # what the command line was given for it; its own name where empty
) -> Study[Sizes, Recorded]:
    """The study in which simulated people go through a definition."""

    def report(request: Request[Sizes], recorded: Recorded) -> Report:
        found = report_of(recorded, again(study, request))
        return replace(found, documents={**found.documents, **recorded.documents}, records=recorded.records)

    study = Study(
        name=definition.study,
        command=f"study run {named or definition.name}",
        presets={name: sizes_of(name, definition.people) for name in PRESETS},
        tasks=tuple(task.name for task in definition.tasks),
        simulated=("people_are",),
        measure=partial(send_people, definition),
        report=report,
        figures=figure_names(definition),
        documents=(ANALYSIS, *DOCUMENTS),
        depends_on=lambda _: _depends_on(definition),
        kept=(SESSIONS,),
        options=("simulated",),
    )
    return study


def send_people(definition: Definition, request: Request[Sizes], grid: Grid) -> Recorded:
    """Let simulated people go through a study; sessions that are kept are not gone through again."""
    people = draw_people(request.preset.simulated, request.seed)
    cells = _session_cells(definition, request, people)
    missing = {_trained_as(cell) for cell in cells if KEEP_SESSIONS.find(request.out, cell) is None}
    fits = _training_cells(definition, request, people, missing)
    trained: Mapping[str, Trained] = {
        one.task: one
        for one in grid.run(
            "Demonstrations and models", train, fits, lambda cell: f"models of {cell.task.label}"
        )
    }
    cells = [replace(cell, trained=trained.get(_trained_as(cell))) for cell in cells]
    sessions = grid.run("Sessions of simulated people", go_through, cells, _session_label, KEEP_SESSIONS)
    trials = tuple(trial for one in sessions for trial in one.trials)
    traces = tuple(trace for one in sessions for trace in one.traces)
    return Recorded(definition, "simulated", trials, traces, people, request.preset)


def _training_cells(
    definition: Definition, request: Request[Sizes], people: tuple[Traits, ...], names: set[str]
) -> list[TrainingCell]:
    if not any(condition.model for condition in definition.conditions):
        return []
    tasks = [task for task in definition.tasks if task.name in names]
    return [TrainingCell(definition, task, people, request.preset, request.seed) for task in tasks]


def _session_cells(
    definition: Definition, request: Request[Sizes], people: tuple[Traits, ...]
) -> list[SessionCell]:
    """All sessions, without the models."""
    rng = generator(request.seed, definition.name, Stream.ORDER)
    orders = design_of(definition).orders(definition, len(people), rng)
    return [
        SessionCell(
            definition, definition.condition(name), task, one, place, None, request.preset, request.seed
        )
        for one, conditions_met in zip(people, orders, strict=True)
        for place, name in enumerate(conditions_met)
        for task in definition.tasks
        if task.name in request.tasks
    ]


def _trained_as(cell: SessionCell) -> str:
    """The task whose models a session needs."""
    return cell.task.trained_with or cell.task.name


def _depends_on(definition: Definition) -> dict[str, object]:
    """The definition, and the code of a session, so that a study does not go on with other code."""
    used = (alignments, conditions, designs, drive_record, fitting, scenes, session, streams, training)
    code = source_digest([Path(module.__file__ or "") for module in used])
    return {"definition": definition.digest, "code": code, "versions": package_versions()}


def _session_label(cell: SessionCell) -> str:
    return f"simulated person {cell.traits.number + 1}, {cell.condition.name}, {cell.task.label}"
