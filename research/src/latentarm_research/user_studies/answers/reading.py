"""Answers from a CSV file, strictly: what is wrong is one sentence with its line."""

from collections.abc import Collection, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Final, final

from latentarm.core.errors import UserError
from latentarm.demonstrations.csv_lines import read_lines
from latentarm_research.user_studies.answers.items import items_of
from latentarm_research.user_studies.definition import Definition

NEEDED: Final = ("person", "condition", "item", "answer")
"""Columns; ``text`` may stand there too, as in a sheet."""

KNOWN: Final = (*NEEDED, "text")


@final
@dataclass(frozen=True)
class Answer:
    """What one person answered to one item after one condition."""

    person: int  # their number, from 0
    condition: str  # name of the condition
    item: str  # name of the item
    points: int  # 1, strongly disagree, to the points of its scale


def read_answers(
    path: Path,  # CSV with the columns `NEEDED`
    definition: Definition,
    met: Mapping[int, Collection[str]],
) -> list[Answer]:
    """The answers of a file. A line without an answer is an item that was left out."""
    lines = read_lines(path)
    number, head = next(lines, (1, []))
    wrong = [name for name in head if name not in KNOWN or head.count(name) > 1]
    missing = [name for name in NEEDED if name not in head]
    if wrong or missing:
        what = f"the column {wrong[0]!r} is unknown or twice there" if wrong else f"no column {missing[0]!r}"
        raise UserError(f"{path}: line {number}: {what}; there must be {', '.join(NEEDED)}.")
    found: dict[tuple[int, str, str], tuple[int, Answer]] = {}
    for number, fields in lines:
        where = f"{path}: line {number}"
        if len(fields) != len(head):
            raise UserError(f"{where}: there are {len(fields)} fields, not {len(head)}.")
        given = {name: field.strip() for name, field in zip(head, fields, strict=True)}
        answer = _answer(given, definition, met, where)
        if answer is None:
            continue
        key = (answer.person, answer.condition, answer.item)
        if key in found:
            raise UserError(
                f"{where}: person {answer.person} has answered {answer.item} after {answer.condition} before,"
                f" in line {found[key][0]}."
            )
        found[key] = (number, answer)
    if not found:
        raise UserError(f"{path} holds no answers.")
    return [answer for _, answer in found.values()]


def _answer(
    given: Mapping[str, str], definition: Definition, met: Mapping[int, Collection[str]], where: str
) -> Answer | None:
    person, condition, item = given["person"], given["condition"], given["item"]
    items = items_of(definition)
    if item not in items:
        raise UserError(f"{where}: the study {definition.name} has no item {item!r}.")
    if not (person.isascii() and person.isdigit() and len(person) < 10 and int(person) in met):
        raise UserError(f"{where}: there is no person {person!r} in the study.")
    if condition not in met[int(person)]:
        raise UserError(f"{where}: person {person} has not met the condition {condition!r}.")
    points = items[item][0].points
    if not given["answer"]:
        return None
    if given["answer"] not in {str(point) for point in range(1, points + 1)}:
        raise UserError(
            f"{where}: the answer must be a whole number from 1 to {points}, not {given['answer']!r}."
        )
    return Answer(int(person), condition, item, int(given["answer"]))
