"""`latentarm study questions` and `latentarm study analyse`: what real people are asked, and their trials."""

import hashlib
import json as json_format
from pathlib import Path
from typing import Annotated

from tyro.conf import Positional, arg

from latentarm.commands.configuration import write_options
from latentarm.commands.output import note, say, show
from latentarm.core.errors import UserError
from latentarm.core.untrusted.opening import read_bytes
from latentarm.demonstrations.bounds import MAX_TEXT_BYTES
from latentarm.runs.options import Json, Seed
from latentarm_research.commands.study_options import Database, StudyName, beside
from latentarm_research.user_studies.own.definition_file import find_definition

AnswersFile = Annotated[
    Path | None, arg(metavar="FILE.csv", help="Answers of real people: person, condition, item, answer.")
]


def questions(
    name: Positional[StudyName],
    people: Annotated[
        int | None, arg(metavar="N", help="How many people; by default as many as the definition plans.")
    ] = None,
    out: Annotated[
        Path | None, arg(metavar="FILE", help="A .csv or .md file; by default NAME-questions.csv.")
    ] = None,
    seed: Seed = 0,
    json: Json = False,
) -> int:
    """Write a study's questionnaire: after each condition all items, in a random order for each person.

    A .md file is for people to read and names no conditions; the .csv of the same seed does.

    For example: latentarm study questions eating --out sheets.md
    """
    from latentarm_research.user_studies.answers.items import sheet, write_sheet

    definition = find_definition(name)
    count = definition.people if people is None else people
    if count < 1:
        raise UserError(f"--people must be 1 or more, not {count}.")
    path = Path(f"{definition.name}-questions.csv") if out is None else out
    asked = sheet(definition, count, seed)
    write_sheet(path, definition, asked)
    say(f"{len(asked)} questions for {count} people are in {path}; people are numbered from 0.", json)
    if json:
        print(json_format.dumps({"sheet": str(path), "questions": len(asked), "people": count}))
    return 0


def analyse_study(
    folder: Positional[
        Annotated[Path, arg(metavar="DIR", help="Folder of a run, or of trials of real people.")]
    ],
    answers: AnswersFile = None,
    database: Database = None,
    preregistered: Annotated[
        Path | None,
        arg(metavar="FILE", help="What latentarm study preregister wrote: the report says what differs."),
    ] = None,
    out: Annotated[
        Path | None, arg(metavar="DIR", help="Folder for report and figures; by default DIR-analysis.")
    ] = None,
    json: Json = False,
) -> int:
    """Analyse recorded trials, with the answers of real people, and write the report.

    For example: latentarm study analyse studies/harmonic
    """
    from latentarm_research.studies.results_folder import ResultsFolder
    from latentarm_research.studies.study import REPORTED, write_report
    from latentarm_research.user_studies.answers.scales import rate
    from latentarm_research.user_studies.preregistration import differences
    from latentarm_research.user_studies.recorded import read_recorded
    from latentarm_research.user_studies.report.figures import figure_names
    from latentarm_research.user_studies.report.page import ANALYSIS, RATINGS, report_of

    recorded = read_recorded(folder, database, answers)
    definition = recorded.definition
    ratings = rate(definition, recorded.answers, recorded.trials) if recorded.answers else None
    digest = None if answers is None else hashlib.sha256(read_bytes(answers, MAX_TEXT_BYTES)).hexdigest()
    figures = (f"{figure}.png" for figure in figure_names(definition))
    claimed = ResultsFolder(f"analysis of {definition.study}", (*REPORTED, ANALYSIS, RATINGS, *figures))
    about: dict[str, object] = {
        "study": claimed.name,
        "definition": definition.digest,
        "analysed": str(folder),
        "people": len(recorded.met),
        "people_are": recorded.people_are,
        "answers": digest,
    }
    path = beside(folder, "analysis") if out is None else out
    claimed.claim(path, about)
    asked = "" if answers is None else f" --answers {answers}"
    if database is not None:
        from latentarm_research.user_studies.serving.database import postgresql, shown  # SQLAlchemy

        asked += f" --database {shown(postgresql(database))}"
    departures = None
    if preregistered is not None:
        departures = differences(preregistered, recorded)
        asked += f" --preregistered {preregistered}"
    report = report_of(recorded, f"latentarm study analyse {folder}{asked}", ratings, departures)
    if why := write_report(path, report, about):
        note([why])
    write_options(path, "study analyse")
    show(report.rows, json, *report.tables)
    say(f"Report, figures and analysis.json are in {path}/ (begin with {path}/report.html).", json)
    return 0
