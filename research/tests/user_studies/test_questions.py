"""Questions of every kind: asked on the page, checked by the server, exported, and counted."""

import csv
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from latentarm.cli import main
from latentarm.core.errors import UserError
from latentarm.evaluation.table import ABSENT
from latentarm.runs.results_folder import write_json
from latentarm_research.user_studies.answers.items import Answer, read_answers
from latentarm_research.user_studies.answers.scales import rate
from latentarm_research.user_studies.catalogue import load_definition
from latentarm_research.user_studies.export.dataset import guarded
from latentarm_research.user_studies.own.definition_file import read_definition
from latentarm_research.user_studies.questionnaire import Question
from latentarm_research.user_studies.recorded import Recorded
from latentarm_research.user_studies.report.page import report_of
from latentarm_research.user_studies.sizes import PRESETS
from study_here import Study

EFFORT = {
    "name": "effort",
    "label": "Effort",
    "items": [{"text": "How hard was it?"}],
    "points": 5,
    "low": "very easy",
    "high": "very hard",
}
PAIN = {
    "name": "pain",
    "label": "Pain",
    "items": [{"text": "How much did it hurt?"}],
    "points": 100,
    "low": "not at all",
    "high": "as much as can be",
    "slider": True,
}
USED = {
    "name": "used",
    "text": "Which do you use?",
    "options": ["cane", "chair", "none"],
    "several": True,
}
AGAIN = {"name": "again", "text": "Once more?", "options": ["yes", "no"], "attention": 2}
WISH = {"name": "wish", "text": "What do you wish for?"}
WORDS = '=1+1, "quoted"\nand \u0646\u200c\u0645'  # a line break and a joiner without width


@pytest.fixture
def study(tmp_path: Path) -> Iterator[Study]:
    study = Study(tmp_path, questionnaire=[EFFORT, PAIN], multiple_choice=[USED, AGAIN], in_words=[WISH])
    yield study
    study.close()


def test_answers_of_every_kind_go_from_the_page_to_the_dataset_and_the_report(study: Study) -> None:
    key = study.comes("questions")
    page = study.ask(key, "GET").text
    assert "1: very easy. 5: very hard." in page
    assert page.count('type="radio" name="effort_1"') == 5
    assert '<textarea name="wish"' in page
    assert page.count('type="checkbox" name="used"') == 3
    assert page.count('type="radio" name="again"') == 2
    assert page.count('type="range"') == 1
    assert page.count('aria-valuetext="not answered yet"') == page.count(">not answered yet<") == 1
    for wrong in ({"effort_1": 6}, {"effort_1": "5"}, {"wish": 5}, {"wish": " "}, {"wish": "\x1b[2J"},
                  {"wish": "a" * 2001}, {"other": 1}, {"pain_1": 0}, {"pain_1": 101}, {"pain_1": "50"},
                  {"pain_1": 50.5}, {"used": 1}, {"used": ""}, {"used": "4"}, {"used": "2;1"},
                  {"used": "1;1"}, {"used": "1;"}, {"used": "cane"}, {"again": "1;2"},
                  {"again": "0"}):  # fmt: skip
        assert study.ask(key, "POST", "/answers", order=0, answers=wrong).status_code == 400, wrong
    given: dict[str, Any] = {
        "order": 0,
        "answers": {"effort_1": 5, "pain_1": 73, "used": "1;3", "again": "2", "wish": WORDS},
    }
    assert study.ask(key, "POST", "/answers", **given).json() == {"to": "/study"}
    study.store.finish(key, "CODE")

    definition = read_definition(study.folder / "two_ways.json")
    about = {"definition": definition.digest, "people_are": "real", "preset": {"name": "smoke"}, "seed": 0}
    write_json(study.folder / "config.json", {"study": definition.study, **about})
    write_json(study.folder / "definition.json", definition.as_json())
    out = study.folder.parent / "dataset"
    assert main(["study", "export", str(study.folder), "--out", str(out)]) == 0

    def table(name: str) -> list[dict[str, str]]:
        with (out / "data" / f"study-TwoWays_description-{name}_data.csv").open(newline="") as stream:
            return [line for line in csv.DictReader(stream) if line["person"] == "0"]

    assert [(one["scale"], one["points"], one["answer"]) for one in table("answers")] == [
        ("effort", "5", "5"),
        ("pain", "100", "73"),
    ]
    # No spreadsheet takes what a person has written as a formula.
    assert [(one["question"], one["text"]) for one in table("texts")] == [(WISH["text"], f"'{WORDS}")]
    assert [tuple(one.values())[2:] for one in table("options")] == [
        ("used", USED["text"], "1", "cane", "0", "1"),
        ("used", USED["text"], "2", "chair", "0", "0"),
        ("used", USED["text"], "3", "none", "0", "1"),
        ("again", AGAIN["text"], "1", "yes", "0", "0"),
        ("again", AGAIN["text"], "2", "no", "1", "1"),
    ]

    report = study.folder.parent / "report"
    assert main(["study", "analyse", str(study.folder), "--out", str(report)]) == 0
    said = (report / "results.md").read_text()
    first = next(one["condition"] for one in table("answers"))
    cells = ["1 of 1", ABSENT] if first == "Modes" else [ABSENT, "1 of 1"]
    assert f"| Which do you use? | cane | {' | '.join(cells)} |" in said
    assert f"| Once more? | no (attention check) | {' | '.join(cells)} |" in said
    assert "| Pain | 1: not at all; 100: as much as can be; slider | How much did it hurt? |" in said
    assert (report / "ratings.png").exists()


def test_questions_with_options_alone_are_asked(tmp_path: Path) -> None:
    study = Study(tmp_path, questionnaire=[], multiple_choice=[AGAIN])
    assert 'data-part="questions"' in study.ask(study.comes("questions"), "GET").text
    study.close()


def test_a_sheet_asks_them_too_and_is_read_again(study: Study, capsys: pytest.CaptureFixture[str]) -> None:
    own, sheet = study.folder / "two_ways.json", study.folder / "sheet.csv"
    printed = study.folder / "sheet.md"
    for path in (sheet, printed):
        assert main(["study", "questions", str(own), "--people", "1", "--out", str(path)]) == 0
    text = printed.read_text()
    for asked in (
        "What do you wish for? (wish)",
        "Which do you use? Choose one or more: 1 cane, 2 chair, 3 none (used)",
        "How much did it hurt? A whole number from 1, not at all, to 100, as much as can be: ____ (pain_1)",
    ):
        assert text.count(asked) == 2
    assert "| How hard was it? | very easy | ☐ | ☐ | ☐ | ☐ | ☐ | very hard | effort_1 |" in text
    lines = [
        f"{line}{'less' if ',wish,' in line else '2;3' if ',used,' in line else 2}" if number else line
        for number, line in enumerate(sheet.read_text().splitlines())
    ]
    sheet.write_text("\n".join(lines))
    definition = read_definition(own)
    met = {0: [one.name for one in definition.conditions]}
    assert [one.answer for one in read_answers(sheet, definition, met)] == [2, 2, "2;3", "2", "less"] * 2


@settings(max_examples=50)
@given(st.text(st.sampled_from("=+-@'\t\n a\uff1d")))
def test_a_guarded_answer_is_no_formula_and_comes_back(text: str) -> None:
    exported = guarded(text)
    assert not exported.startswith(tuple("=+-@\uff1d\t\n"))
    assert exported.removeprefix("'") == text


def test_a_study_without_scales_is_reported() -> None:
    wish = Question("wish", "What do you wish for?")
    definition = replace(load_definition("harmonic"), questionnaire=(), in_words=(wish,), hypotheses=())
    answers = (Answer(0, "Modes", "wish", "more"),)
    recorded = Recorded(definition, "real", (), (), (), PRESETS["paper"], answers)
    page = report_of(recorded, "", rate(definition, answers, ())).page
    assert "Asked in words: What do you wish for? Answers: 1" in page


@pytest.mark.parametrize(
    ("change", "said"),
    [
        ({"in_words": [{**WISH, "name": "effort_1"}]}, "'effort_1' stands there twice"),
        ({"in_words": [{**WISH, "name": "A wish"}]}, "in_words: name must have"),
        ({"multiple_choice": [{**AGAIN, "name": "wish"}]}, "'wish' stands there twice"),
        ({"multiple_choice": [{**AGAIN, "attention": 3}]}, "attention of again must be"),
        ({"multiple_choice": [{**AGAIN, "several": True}]}, "attention of again must be"),
        ({"multiple_choice": [{**AGAIN, "options": ["yes"]}]}, "needs two options or more"),
        ({"multiple_choice": [{**AGAIN, "options": ["yes", "yes"]}]}, "each another"),
        ({"questionnaire": [{**EFFORT, "items": []}]}, "needs one item or more"),
        (
            {"comprehension": [{**AGAIN, "attention": 0}]},
            "must be the number of its right option",
        ),
    ],
)
def test_questions_that_cannot_be_asked_are_refused(
    tmp_path: Path, change: dict[str, Any], said: str
) -> None:
    with pytest.raises(UserError, match=said):
        Study(tmp_path, **{"questionnaire": [EFFORT], "in_words": [WISH], **change})
