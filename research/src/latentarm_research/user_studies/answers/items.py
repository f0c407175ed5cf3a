"""Items of a questionnaire in each person's order: sheets to fill in or print, and answers, read strictly."""

import csv
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass
from io import StringIO
from itertools import groupby
from pathlib import Path
from typing import Final, final

import numpy as np

from latentarm.core.errors import UserError
from latentarm.core.files import write_text
from latentarm.demonstrations.importers.csv_lines import read_lines
from latentarm_research.studies.streams import generator
from latentarm_research.studies.tables import markdown_table
from latentarm_research.user_studies.definition import Definition
from latentarm_research.user_studies.designs import design_of
from latentarm_research.user_studies.questionnaire import LONGEST_TEXT, Item, MultipleChoice, Scale
from latentarm_research.user_studies.sizes import Stream


@final
@dataclass(frozen=True)
class Asked:
    """One line of a sheet."""

    person: int  # their number, from 0
    condition: str  # after which they are asked
    item: str  # name of the item, or of the question
    text: str  # the statement or question


def items_of(definition: Definition) -> dict[str, tuple[Scale, Item]]:
    """Every item by name, such as ``ease_1``, with its scale."""
    return {
        f"{scale.name}_{number}": (scale, item)
        for scale in definition.questionnaire
        for number, item in enumerate(scale.items, start=1)
    }


def names_of(definition: Definition) -> list[str]:
    """Names of everything that is asked, in the order of the definition."""
    others = (*definition.with_options, *definition.in_words)
    return [*items_of(definition), *(one.name for one in others)]


def sheet(definition: Definition, people: int, seed: int) -> list[Asked]:
    """Everybody's questions: after each condition all items in an order of their own, then all others.

    Comparisons come after the last condition, for each of them.
    """
    items = items_of(definition)
    others = {
        **{one.name: _with_options(one) for one in definition.multiple_choice},
        **{one.name: one.text for one in definition.in_words},
    }
    compared = {one.name: _with_options(one) for one in definition.compared}
    if not (items or others or compared):
        raise UserError(f"The study {definition.name} has no questionnaire.")
    texts = {**{name: item.text for name, (_, item) in items.items()}, **others, **compared}
    rng = generator(seed, definition.name, Stream.ORDER)
    met = design_of(definition).orders(definition, people, rng)
    rng = generator(seed, f"{definition.name} items", Stream.QUESTIONS)
    return [
        Asked(person, condition, name, texts[name])
        for person, order in enumerate(met)
        for names in [_shuffled(list(items), rng)]
        for condition, asked in (
            *((one, (*names, *others)) for one in order),
            *((one, tuple(compared)) for one in order),
        )
        for name in asked
    ]


def _with_options(question: MultipleChoice) -> str:
    """A question with its numbered options, for a sheet."""
    options = ", ".join(f"{number} {text}" for number, text in enumerate(question.options, start=1))
    return f"{question.text} {'Choose one or more' if question.several else 'Choose one'}: {options}"


def _shuffled(names: Sequence[str], rng: np.random.Generator) -> list[str]:
    return [names[int(place)] for place in rng.permutation(len(names))]


COLUMNS: Final = ("person", "condition", "item", "text", "answer")
"""Of a CSV sheet; the last one is empty until people answer."""


def write_sheet(
    path: Path,  # ends in `.csv` or `.md`
    definition: Definition,
    asked: Sequence[Asked],
) -> None:
    """Write a sheet. Raises a `UserError` where the file has another ending, exists, or cannot be written."""
    kinds = {".csv": _csv, ".md": _markdown}
    if path.suffix not in kinds:
        raise UserError(f"{path} must end in {' or '.join(kinds)}.")
    if path.exists():
        raise UserError(f"{path} already exists, and may hold answers: name another file with --out.")
    write_text(path, kinds[path.suffix](definition, asked))


def _csv(definition: Definition, asked: Sequence[Asked]) -> str:
    stream = StringIO()
    lines = csv.writer(stream, lineterminator="\n")
    lines.writerow(COLUMNS)
    lines.writerows((one.person, one.condition, one.item, one.text, "") for one in asked)
    return stream.getvalue()


def _markdown(definition: Definition, asked: Sequence[Asked]) -> str:
    items = items_of(definition)
    most = max((scale.points for scale in definition.questionnaire if not scale.slider), default=0)
    head = ["statement", "1 means", *map(str, range(1, most + 1)), "the highest means", "item"]
    parts = [f"# {definition.public_title}\n"]
    places: dict[int, list[str]] = {}
    for (person, condition), lines in groupby(asked, lambda one: (one.person, one.condition)):
        theirs = places.setdefault(person, [])
        if condition not in theirs:
            theirs.append(condition)
        parts.append(f"## Person {person}, way of driving {theirs.index(condition) + 1}\n")
        asked_now = list(lines)
        rows: list[list[str]] = []
        for one in asked_now:
            if one.item in items and not (scale := items[one.item][0]).slider:
                boxes = ["☐"] * scale.points + [""] * (most - scale.points)
                rows.append([one.text, scale.low, *boxes, scale.high, one.item])
        if rows:
            parts.append("Mark one number on each line.\n")
            parts.append(markdown_table(head, rows))
        for one in asked_now:
            scale = items[one.item][0] if one.item in items else None
            if scale is None:
                parts.append(f"{one.text} ({one.item})\n\n")
            elif scale.slider:
                ends = f"from 1, {scale.low}, to {scale.points}, {scale.high}"
                parts.append(f"{one.text} A whole number {ends}: ____ ({one.item})\n\n")
    return "\n".join(parts)


NEEDED: Final = ("person", "condition", "item", "answer")
"""Columns; ``text`` may stand there too, as in a sheet."""

KNOWN: Final = (*NEEDED, "text")


@final
@dataclass(frozen=True)
class Answer:
    """One person's answer to one item after one condition."""

    person: int  # their number, from 0
    condition: str  # name of the condition
    item: str  # name of the item, or of the question
    # 1 to the points of the item's scale; numbers of options from 1, separated by ;; or words
    answer: int | str


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
    scale = items_of(definition).get(item, (None,))[0]
    if item not in names_of(definition):
        raise UserError(f"{where}: the study {definition.name} has no item {item!r}.")
    if not (person.isascii() and person.isdigit() and len(person) < 10 and int(person) in met):
        raise UserError(f"{where}: there is no person {person!r} in the study.")
    if condition not in met[int(person)]:
        raise UserError(f"{where}: person {person} has not met the condition {condition!r}.")
    if not given["answer"]:
        return None
    is_whole = scale is not None and given["answer"].isascii() and given["answer"].isdigit()
    answer = int(given["answer"]) if is_whole and len(given["answer"]) < 10 else given["answer"]
    if wrong := wrong_answer(definition, item, answer):
        raise UserError(f"{where}: the answer must be {wrong}, not {given['answer']!r}.")
    return Answer(int(person), condition, item, answer)


def wrong_answer(definition: Definition, item: str, answer: int | str) -> str:
    """Describe what an item accepts if ``answer`` is invalid; "" if it is valid."""
    scale = items_of(definition).get(item, (None,))[0]
    if scale is not None:
        right = isinstance(answer, int) and 1 <= answer <= scale.points
        return "" if right else f"a whole number from 1 to {scale.points}"
    for one in definition.with_options:
        if one.name == item:
            numbers = [str(number) for number in range(1, len(one.options) + 1)]
            given = answer.split(";") if isinstance(answer, str) else []
            right = bool(given) and given == [number for number in numbers if number in given]
            most = len(numbers) if one.several else 1
            return "" if right and len(given) <= most else _right_numbers(one)
    right = (
        isinstance(answer, str)
        and item in {one.name for one in definition.in_words}
        and len(answer) <= LONGEST_TEXT
        and bool(answer.strip())
        and not any(letter < " " and letter not in "\t\n\r" for letter in answer)
    )
    return "" if right else f"words, of at most {LONGEST_TEXT} characters"


def _right_numbers(question: MultipleChoice) -> str:
    one = f"the number of an option, from 1 to {len(question.options)}"
    return f"{one}, or several in order, separated by ;" if question.several else one
