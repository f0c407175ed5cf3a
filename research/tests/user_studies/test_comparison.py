"""People compare the ways of driving that they have met; the answers are those of the conditions."""

import csv
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import pytest

from latentarm.core.errors import UserError
from latentarm_research.user_studies.answers.items import read_answers, sheet, write_sheet
from latentarm_research.user_studies.answers.scales import rate
from latentarm_research.user_studies.catalogue import load_definition
from latentarm_research.user_studies.own.definition_file import read_definition
from latentarm_research.user_studies.questionnaire import Question
from latentarm_research.user_studies.serving.page_drive import ToDrive
from latentarm_research.user_studies.serving.way import ToAnswer
from study_here import Study, driven

AGAIN = {"name": "again", "text": "Which one would you use again?"}
ASKED = (Question(**AGAIN),)


@pytest.fixture
def study(tmp_path: Path) -> Iterator[Study]:
    study = Study(tmp_path, comparison=[AGAIN])
    yield study
    study.close()


def driven_all(study: Study) -> str:
    """The cookie of somebody new who has answered the questions after each condition."""
    key = study.comes("trial")
    while not isinstance(due := study.due(key), str):
        if isinstance(due, ToAnswer):
            study.store.keep_answers(key, due.order, due.condition.name, dict.fromkeys(due.items, 4))
        else:
            assert isinstance(due, ToDrive)
            study.store.keep_drive(key, driven(due))
    return key


@pytest.mark.parametrize("way", [1, 2])
def test_the_chosen_way_is_a_condition_by_the_persons_own_order(study: Study, way: int) -> None:
    for _ in range(2):  # two people have the conditions in two orders
        key = driven_all(study)
        page = study.ask(key, "GET").text
        assert 'data-part="compare"' in page
        assert page.count('type="radio" name="again"') == 2
        for wrong in ({"again": 3}, {"again": 0}, {"other": 1}, {"again": "1"}):
            assert study.ask(key, "POST", "/compare", answers=wrong).status_code == 400
        assert study.ask(key, "POST", "/compare", answers={"again": way}).json() == {"to": "/study"}
        assert study.ask(key, "POST", "/compare", answers={"again": 1}).status_code == 409
        assert 'data-part="finished"' in study.ask(key, "GET").text
    people = study.store.people()
    given = {(one.number, a.condition): a.answer for one in people for a in one.answers if a.item == "again"}
    orders = {one.number: study.way.order(one.number or 0) for one in people}
    assert len(set(orders.values())) == 2
    assert given == {
        (number, condition): "1" if place == way - 1 else "2"
        for number, order in orders.items()
        for place, condition in enumerate(order)
    }
    definition = read_definition(study.folder / "two_ways.json")
    ratings = rate(definition, [a for one in people for a in one.answers if a.item == "again"], [])
    counts = [one.counts for one in ratings.chosen if one.question == "again"]
    assert counts == [(1, 1), (1, 1)]


def test_it_may_be_left_out(study: Study) -> None:
    key = driven_all(study)
    study.ask(key, "POST", "/compare", answers={})
    assert 'data-part="finished"' in study.ask(key, "GET").text
    standing = study.store.standing(key)
    assert standing is not None
    assert "again" not in {one.item for one in standing.answers}


def test_a_sheet_asks_after_the_last_condition(tmp_path: Path) -> None:
    definition = replace(load_definition("eating"), comparison=ASKED)
    asked = sheet(definition, 2, 0)
    conditions = {one.name for one in definition.conditions}
    for person in (0, 1):
        theirs = [one for one in asked if one.person == person]
        assert {one.condition for one in theirs[-4:]} == conditions
        assert [one.item for one in theirs[-4:]] == ["again"] * 4
        assert "again" not in {one.item for one in theirs[:-4]}
    path = tmp_path / "sheet.csv"
    write_sheet(path, definition, asked)
    with path.open(newline="") as file:
        lines = list(csv.DictReader(file))
    for line in lines:
        line["answer"] = "1" if line["item"] == "again" else ""
    with path.open("w", newline="") as file:
        table = csv.DictWriter(file, list(lines[0]))
        table.writeheader()
        table.writerows(lines)
    answers = read_answers(path, definition, {0: conditions, 1: conditions})
    assert [one.answer for one in answers] == ["1"] * 8
    write_sheet(tmp_path / "sheet.md", definition, asked)
    text = (tmp_path / "sheet.md").read_text()
    assert "way of driving 4" in text
    assert "way of driving 5" not in text


def test_people_who_meet_one_condition_compare_nothing() -> None:
    with pytest.raises(UserError, match="has a comparison, and each person meets one condition"):
        replace(load_definition("eating"), design="between", orders=(), comparison=ASKED)
