"""Writes a study as a Psych-DS dataset: CSV files, codebook, drives, and scripts for the tables."""

import csv
import shutil
from collections.abc import Iterable, Sequence
from io import StringIO
from pathlib import Path
from typing import Final

from latentarm.core.files import write_text
from latentarm.runs.results_folder import write_json
from latentarm_research.user_studies.answers.items import Answer, items_of
from latentarm_research.user_studies.definition import Definition
from latentarm_research.user_studies.drive_record import DriveRecord, devices_of
from latentarm_research.user_studies.exclusion import counted
from latentarm_research.user_studies.export.codebook import VARIABLES, variable_of
from latentarm_research.user_studies.export.drives import write_drives
from latentarm_research.user_studies.record import Trial
from latentarm_research.user_studies.recorded import Recorded

# Formulas begin with these, also in their full width; an apostrophe says that none follows.
_GUARDED: Final = tuple("=+-@\uff1d\uff0b\uff0d\uff20'\t\r\n")
SCRIPTS: Final = ("tables.py", "tables.R")
_DEVICE: Final = ("browser", "width_px", "height_px", "round_trip_ms", "jitter_ms")

Cell = str | float | None


def write_dataset(folder: Path, recorded: Recorded, drives: Sequence[tuple[DriveRecord, Path]] = ()) -> None:
    """Write the dataset into an empty folder; ``drives`` of real people come with the files of their steps.

    Raises a `UserError` where one of these files holds no steps of a drive.
    """
    definition = recorded.definition
    tables: dict[str, tuple[Sequence[str], Iterable[Sequence[Cell]]]] = {
        "trials": (
            ("person", "condition", "task", "order", "trial", "excluded", *definition.measures),
            _trials(definition, recorded.trials),
        ),
        "people": (
            (
                "person",
                "conditions",
                "consent",
                "consented",
                *_DEVICE,
                "device_passed",
                "comprehension",
                "practised",
                "devices",
                "finished",
            ),
            _people(recorded),
        ),
        "answers": (
            ("person", "condition", "scale", "item", "reversed", "points", "answer"),
            _answers(definition, recorded.answers),
        ),
        "options": (
            ("person", "condition", "item", "question", "option", "label", "attention", "chosen"),
            _options(definition, recorded.answers),
        ),
        "claims": (
            ("claim", "hypothesis", "measure", "direction", "margin", "design"),
            _claims(definition),
        ),
        "sides": (("claim", "kind", "name"), _sides(definition)),
        "factors": (("factor", "level", "condition"), _factors(definition)),
    }
    if definition.in_words:
        tables["texts"] = (
            ("person", "condition", "item", "question", "text"),
            _texts(definition, recorded.answers),
        )
    if drives:
        columns = ("person", "condition", "task", "order", "trial", "choice", "attempt", "ending")
        tables["drives"] = ((*columns, "devices", "episode"), _drives(folder, definition, drives, columns))
    named = "".join(letter for letter in definition.name.title() if letter.isascii() and letter.isalnum())
    for name, (head, rows) in tables.items():
        path = folder / "data" / f"study-{named or 'own'}_description-{name}_data.csv"
        write_text(path, _csv(head, rows))
    variables = (*VARIABLES, *map(variable_of, definition.measures))
    write_text(
        folder / "documentation" / "codebook.csv",
        _csv(("name", "meaning", "unit"), ((one.name, one.meaning, one.unit) for one in variables)),
    )
    described = {
        "@context": "https://schema.org",
        "@type": "Dataset",
        "schemaVersion": "Psych-DS 1.0.0",
        "name": definition.title,
        "description": f"{definition.about} Trials of {recorded.who}.",
        "identifier": definition.digest,
        "variableMeasured": [
            {
                "@type": "PropertyValue",
                "name": one.name,
                "description": one.meaning,
                **({"unitText": one.unit} if one.unit else {}),
            }
            for one in variables
        ],
    }
    write_json(folder / "dataset_description.json", described)
    (folder / "analysis").mkdir()
    for name in SCRIPTS:
        shutil.copyfile(Path(__file__).with_name(name), folder / "analysis" / name)


def _trials(definition: Definition, trials: Sequence[Trial]) -> Iterable[Sequence[Cell]]:
    _, out = counted(definition.exclusions, trials)
    why = dict(out.trials)
    for index, one in enumerate(trials):
        of_person = "too many trials of the person do not count" if one.person in out.people else None
        measures = [one.measures.get(name) for name in definition.measures]
        yield one.person, one.condition, one.task, one.order, one.trial, why.get(index, of_person), *measures


def _people(recorded: Recorded) -> Iterable[Sequence[Cell]]:
    """Everybody who has consented; only the conditions where nothing else is known."""
    for one in recorded.participants:
        person = one.number if one.finished else None
        conditions, day = ";".join(one.conditions), one.consented[:10]
        yield (
            person,
            conditions,
            one.consent,
            day,
            *(one.device.get(name) for name in _DEVICE),
            int(one.device_passed) if one.device else None,
            len(one.comprehension),
            one.practised,
            ";".join(devices_of(one.drives)),
            int(one.finished),
        )
    if not recorded.participants:
        in_order = sorted(recorded.trials, key=lambda trial: trial.order)
        for person in sorted(recorded.met):
            theirs = dict.fromkeys(trial.condition for trial in in_order if trial.person == person)
            yield person, ";".join(theirs), *(None for _ in range(7 + len(_DEVICE)))


def _answers(definition: Definition, answers: Sequence[Answer]) -> Iterable[Sequence[Cell]]:
    items = items_of(definition)
    for one in answers:
        if one.item in items and isinstance(one.answer, int):
            scale, item = items[one.item]
            turned = int(item.reversed)
            yield one.person, one.condition, scale.name, one.item, turned, scale.points, one.answer


def _options(definition: Definition, answers: Sequence[Answer]) -> Iterable[Sequence[Cell]]:
    asked = {one.name: one for one in definition.with_options}
    for one in (one for one in answers if one.item in asked):
        question, chosen = asked[one.item], str(one.answer).split(";")
        for number, label in enumerate(question.options, start=1):
            given = one.person, one.condition, one.item, question.text
            yield *given, number, label, int(number == question.attention), int(str(number) in chosen)


def _texts(definition: Definition, answers: Sequence[Answer]) -> Iterable[Sequence[Cell]]:
    asked = {one.name: one.text for one in definition.in_words}
    for one in answers:
        if one.item in asked:
            yield one.person, one.condition, one.item, asked[one.item], guarded(str(one.answer))


def guarded(text: str) -> str:
    """A person's own words, such that no spreadsheet takes them as a formula."""
    return f"'{text}" if text.startswith(_GUARDED) else text


def _drives(
    folder: Path,
    definition: Definition,
    drives: Sequence[tuple[DriveRecord, Path]],
    columns: Sequence[str],
) -> Iterable[Sequence[Cell]]:
    """Write the drives with steps as episodes, and say of each drive which episode it is."""
    for task in definition.tasks:
        theirs = [one for one in drives if one[0].task == task.name]
        with_steps = [one for one in theirs if one[1].exists()]
        if with_steps:
            write_drives(folder, task, with_steps)
        episodes = {path: number for number, (_, path) in enumerate(with_steps)}
        for record, path in theirs:
            devices = ";".join(devices_of([record]))
            yield *(getattr(record, name) for name in columns), devices, episodes.get(path)


def _claims(definition: Definition) -> Iterable[Sequence[Cell]]:
    owners = [hypothesis.name for hypothesis in definition.hypotheses for _ in hypothesis.claims]
    for number, (owner, one) in enumerate(zip(owners, definition.claims, strict=True)):
        yield number, owner, one.measure, one.direction, one.margin, definition.design


def _sides(definition: Definition) -> Iterable[Sequence[Cell]]:
    for number, one in enumerate(definition.claims):
        for kind, names in (("subject", one.subject), ("against", one.against), ("task", one.tasks)):
            yield from ((number, kind, name) for name in names)


def _factors(definition: Definition) -> Iterable[Sequence[Cell]]:
    for factor in definition.factors:
        for level, (_, conditions) in enumerate((factor.low, factor.high), start=1):
            yield from ((factor.name, level, condition) for condition in conditions)


def _csv(head: Sequence[str], rows: Iterable[Sequence[Cell]]) -> str:
    stream = StringIO()
    lines = csv.writer(stream, lineterminator="\n")
    lines.writerow(head)
    lines.writerows(rows)
    return stream.getvalue()
