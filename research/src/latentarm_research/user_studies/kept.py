"""Finished sessions in the study's folder as JSON, so that it goes on where it was stopped."""

import json
from pathlib import Path
from typing import Final

from latentarm.core.errors import UserError
from latentarm.core.files import write_text
from latentarm.core.untrusted.documents import read_object
from latentarm_research.studies.study import Keep
from latentarm_research.user_studies.record import read_trials
from latentarm_research.user_studies.session import Session, SessionCell
from latentarm_research.user_studies.trace import read_traces

SESSIONS: Final = "sessions"
"""The folder of the sessions."""


def _path(out: Path, cell: SessionCell) -> Path:
    return out / SESSIONS / f"{cell.traits.number}_{cell.order}_{cell.task.name}.json"


def _write(out: Path, cell: SessionCell, session: Session) -> None:
    document = {
        "trials": [trial.as_json() for trial in session.trials],
        "traces": [trace.as_json() for trace in session.traces],
    }
    write_text(_path(out, cell), json.dumps(document, separators=(",", ":"), allow_nan=False) + "\n")


def _read(out: Path, cell: SessionCell) -> Session | None:
    path = _path(out, cell)
    if not path.exists():
        return None
    document = read_object(path)
    session = Session(read_trials(document, path), read_traces(document, path))
    wanted = (cell.traits.number, cell.condition.name, cell.task.name)
    if any((one.person, one.condition, one.task) != wanted for one in (*session.trials, *session.traces)):
        raise UserError(f"{path} holds another session: remove it, and it is gone through again.")
    return session


KEEP_SESSIONS: Final = Keep(_read, _write)
