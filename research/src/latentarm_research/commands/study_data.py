"""`latentarm study delete` and `latentarm study export`: what is kept of people."""

import json as json_format
from datetime import UTC, datetime
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

from tyro.conf import Positional, arg

from latentarm.commands.output import say
from latentarm.core.errors import UserError
from latentarm.runs.options import Json
from latentarm_research.commands.study_answers import AnswersFile
from latentarm_research.commands.study_options import Database, beside

if TYPE_CHECKING:
    from latentarm_research.user_studies.drive_record import DriveRecord

ServedFolder = Annotated[Path, arg(metavar="DIR", help="Folder of a served study.")]


def delete_people(
    folder: Positional[ServedFolder],
    code: Annotated[
        str | None,
        arg(
            metavar="CODE",
            help="Delete the person with this code: of the link, of the end, or of the recruiting site.",
        ),
    ] = None,
    before: Annotated[
        str | None, arg(metavar="YYYY-MM-DD", help="Delete everybody who was last there before this day.")
    ] = None,
    database: Database = None,
    json: Json = False,
) -> int:
    """Delete people from a served study with all that is kept of them.

    For example: latentarm study delete studies/eating-people --before 2026-01-31
    """
    from latentarm_research.user_studies.serving.served_store import served_store
    from latentarm_research.user_studies.serving.study_files import forget

    if (code is None) == (before is None):
        raise UserError("Name either --code or --before.")
    try:
        day = None if before is None else datetime.fromisoformat(before).replace(tzinfo=UTC)
    except ValueError as error:
        raise UserError(f"--before must be a day, such as 2026-01-31, not {before!r}.") from error
    with served_store(folder, database) as store:
        if day is None:
            gone = store.withdraw_by_code(code or "")
        else:
            gone = store.withdraw_unseen_since(day.timestamp())
    if code is not None and not gone:
        raise UserError(f"Nobody in {folder} has the code {code}.")
    forget(folder, gone)
    say(f"People who were deleted: {len(gone)}. Exports and copies made before still hold them.", json)
    if json:
        print(json_format.dumps({"deleted": len(gone)}))
    return 0


def replay_study(folder: Positional[ServedFolder], database: Database = None, json: Json = False) -> int:
    """Measure all drives of a served study again, from the steps that were kept of them.

    Exit code 1 where one comes out differently. For example: latentarm study replay studies/eating-people
    """
    from latentarm_research.user_studies.drive_steps import measured_again
    from latentarm_research.user_studies.recorded import read_definition_of

    tasks = {task.name: task for task in read_definition_of(folder).tasks}
    drives = [one for theirs in _drives(folder, database).values() for one in theirs]
    differ = 0
    for drive, steps in drives:
        again = measured_again(steps, drive, tasks[drive.task])
        if again != drive:
            differ += 1
            say(f"It differs: person {drive.person}, {drive.condition}, {drive.task} {drive.trial}.", json)
    say(f"Drives that come out the same: {len(drives) - differ} of {len(drives)}.", json)
    if json:
        print(json_format.dumps({"drives": len(drives), "differ": differ}))
    return 1 if differ else 0


def _drives(folder: Path, database: str | None) -> "dict[str, list[tuple[DriveRecord, Path]]]":
    """All drives of a served study by the person's key, each with the file of its steps."""
    from latentarm_research.user_studies.serving.served_store import served_store
    from latentarm_research.user_studies.serving.study_files import steps_path

    with served_store(folder, database) as store:
        people = store.people()
    return {one.key: [(drive, steps_path(folder, one.key, drive)) for drive in one.drives] for one in people}


def export_study(
    folder: Positional[
        Annotated[Path, arg(metavar="DIR", help="Folder of a run, of a served study, or of trials.")]
    ],
    answers: AnswersFile = None,
    database: Database = None,
    out: Annotated[
        Path | None, arg(metavar="DIR", help="Folder of the dataset; by default DIR-dataset.")
    ] = None,
    json: Json = False,
) -> int:
    """Write a study as a Psych-DS dataset, with scripts in Python and R for the tables of its report.

    Drives on the page are in it as LeRobot datasets, one for each task.

    For example: latentarm study export studies/eating-people
    """
    from latentarm.demonstrations.folders import staged_folder
    from latentarm_research.user_studies.export.dataset import write_dataset
    from latentarm_research.user_studies.recorded import read_recorded, was_served

    recorded = read_recorded(folder, database, answers)
    kept = _drives(folder, database) if was_served(folder, database) else {}
    finished = [person.key for person in recorded.participants if person.finished]
    drives = [drive for key in finished for drive in kept.get(key, [])]
    path = beside(folder, "dataset") if out is None else out
    with staged_folder(path) as part:
        write_dataset(part, recorded, drives)
    say(
        f"The dataset is in {path}/; analysis/tables.py and analysis/tables.R make the report's tables.", json
    )
    if json:
        print(json_format.dumps({"dataset": str(path)}))
    return 0
