"""People who have not understood the information read it again before they practise."""

from collections.abc import Iterator
from pathlib import Path

import pytest

from latentarm_research.user_studies.own.definition_file import read_definition
from latentarm_research.user_studies.recorded import Recorded
from latentarm_research.user_studies.report.people import consent_words
from latentarm_research.user_studies.sizes import PRESETS
from study_here import INFORMATION, Study
from study_participant import DEVICE

ASKED = [
    {"name": "stop", "text": "When may you stop?", "options": ["at the end", "at any time"], "attention": 2},
    {"name": "arm", "text": "The arm is", "options": ["simulated", "real"], "attention": 1},
]
RIGHT = {"stop": "2", "arm": "1"}


@pytest.fixture
def study(tmp_path: Path) -> Iterator[Study]:
    study = Study(tmp_path, comprehension=ASKED)
    yield study
    study.close()


def test_who_answers_wrong_reads_the_information_again_and_answers_again(study: Study) -> None:
    key = study.comes("consent")
    study.store.consent(key, "0" * 64, "2026-01-01T00:00:00+00:00")
    study.store.keep_device(key, DEVICE, passed=True)
    page = study.ask(key, "GET").text
    assert 'data-part="comprehension"' in page
    assert page.count(" required") == 4
    assert '<details class="more">' in page
    assert INFORMATION in page
    for invalid in ({"arm": "3"}, {"arm": 1}, {"other": "1"}):
        assert study.ask(key, "POST", "/comprehension", answers=invalid).status_code == 400
    for wrong in ({"stop": "1", "arm": "1"}, {"stop": "2"}):
        assert study.ask(key, "POST", "/comprehension", answers=wrong).json() == {"to": "/study"}
        again = study.ask(key, "GET").text
        assert 'data-part="comprehension"' in again
        assert '<p role="status">Not all answers were right.' in again
        assert '<details class="more" open>' in again
    for _ in range(2):  # the second time from another tab
        study.ask(key, "POST", "/comprehension", answers=RIGHT)
    assert 'data-part="practice"' in study.ask(key, "GET").text
    standing = study.store.standing(key)
    assert standing is not None
    assert standing.comprehension == (False, False, True)
    definition = read_definition(study.folder / "two_ways.json")
    recorded = Recorded(definition, "real", (), (), (), PRESETS["smoke"], participants=(standing,))
    assert "0 answered all questions about it right at the first try." in consent_words(recorded)
    kept = study.ask(key, "GET", "/data").json()["comprehension"]
    assert [one["options"] for one in kept] == [{"stop": "1", "arm": "1"}, {"stop": "2"}, RIGHT]
    study.ask(key, "POST", "/withdraw")
    assert study.store.everything(key)["comprehension"] == []


def test_a_study_without_such_questions_goes_on_to_practice(tmp_path: Path) -> None:
    study = Study(tmp_path)
    key = study.comes("consent")
    study.store.consent(key, "0" * 64, "2026-01-01T00:00:00+00:00")
    study.store.keep_device(key, DEVICE, passed=True)
    assert 'data-part="practice"' in study.ask(key, "GET").text
    study.close()
