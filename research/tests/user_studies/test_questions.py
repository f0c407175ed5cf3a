"""Questions with labelled ends and in words: asked on the page, checked by the server, and exported."""

import csv
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from latentarm.cli import main
from latentarm.core.errors import UserError
from latentarm.runs.results_folder import write_json
from latentarm_research.user_studies.answers.items import read_answers
from latentarm_research.user_studies.own.definition_file import read_definition
from study_here import Study

EFFORT = {
    "name": "effort",
    "label": "Effort",
    "items": [{"text": "How hard was it?"}],
    "points": 5,
    "low": "very easy",
    "high": "very hard",
}
WISH = {"name": "wish", "text": "What do you wish for?"}
WORDS = '=1+1, "quoted"\nand \u0646\u200c\u0645'  # a line break and a joiner without width


@pytest.fixture
def study(tmp_path: Path) -> Iterator[Study]:
    study = Study(tmp_path, questionnaire=[EFFORT], in_words=[WISH])
    yield study
    study.close()


def test_words_and_one_item_scales_go_from_the_page_to_the_dataset(study: Study) -> None:
    key = study.comes("questions")
    page = study.ask(key, "GET").text
    assert "1: very easy. 5: very hard." in page
    assert page.count('type="radio" name="effort_1"') == 5
    assert '<textarea name="wish"' in page
    for wrong in ({"effort_1": 6}, {"effort_1": "5"}, {"wish": 5}, {"wish": " "}, {"wish": "\x1b[2J"},
                  {"wish": "a" * 2001}, {"other": 1}):  # fmt: skip
        assert study.ask(key, "POST", "/answers", order=0, answers=wrong).status_code == 400, wrong
    given: dict[str, Any] = {"order": 0, "answers": {"effort_1": 5, "wish": WORDS}}
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
        ("effort", "5", "5")
    ]
    assert [(one["question"], one["text"]) for one in table("texts")] == [(WISH["text"], WORDS)]


def test_a_sheet_asks_them_too_and_is_read_again(study: Study, capsys: pytest.CaptureFixture[str]) -> None:
    own, sheet = study.folder / "two_ways.json", study.folder / "sheet.csv"
    printed = study.folder / "sheet.md"
    for path in (sheet, printed):
        assert main(["study", "questions", str(own), "--people", "1", "--out", str(path)]) == 0
    assert printed.read_text().count("What do you wish for? (wish)") == 2
    assert (
        "| How hard was it? | very easy | ☐ | ☐ | ☐ | ☐ | ☐ | very hard | effort_1 |" in printed.read_text()
    )
    lines = [
        f"{line}{'less' if ',wish,' in line else 3}" if number else line
        for number, line in enumerate(sheet.read_text().splitlines())
    ]
    sheet.write_text("\n".join(lines))
    definition = read_definition(own)
    met = {0: [one.name for one in definition.conditions]}
    assert [one.answer for one in read_answers(sheet, definition, met)] == [3, "less"] * 2


@pytest.mark.parametrize(
    ("change", "said"),
    [
        ({"in_words": [{**WISH, "name": "effort_1"}]}, "'effort_1' stands there twice"),
        ({"in_words": [{**WISH, "name": "A wish"}]}, "in_words: name must have"),
        ({"questionnaire": [{**EFFORT, "items": []}]}, "needs one item or more"),
    ],
)
def test_questions_that_cannot_be_asked_are_refused(
    tmp_path: Path, change: dict[str, Any], said: str
) -> None:
    with pytest.raises(UserError, match=said):
        Study(tmp_path, **{"questionnaire": [EFFORT], "in_words": [WISH], **change})
