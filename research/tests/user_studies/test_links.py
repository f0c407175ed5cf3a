"""Links of ours and of Prolific; a faulty one says what is wrong with it, and to the log no person's id."""

import pytest
from starlette.datastructures import QueryParams

from latentarm.core.errors import UserError
from latentarm_research.user_studies.serving.links import link_of
from latentarm_research.user_studies.serving.words.catalogue import study_languages

STUDY = "5" * 24
ENGLISH = study_languages()["en"]
GIVEN = {"PROLIFIC_PID": "a" * 24, "STUDY_ID": STUDY, "SESSION_ID": "c" * 24}


def test_a_link_of_prolific_is_that_of_a_person_and_their_visit() -> None:
    assert link_of(QueryParams(GIVEN), STUDY, ENGLISH) == ("a" * 24, "c" * 24)


def test_a_link_of_ours_has_a_code_also_in_a_study_for_prolific() -> None:
    assert link_of(QueryParams({"code": "x-y_z"}), STUDY, ENGLISH) == ("x-y_z", "")
    assert link_of(QueryParams(), STUDY, ENGLISH) == ("", "")


@pytest.mark.parametrize(
    ("wrong", "said"),
    [
        ({"PROLIFIC_PID": ""}, "it lacks PROLIFIC_PID"),
        ({"SESSION_ID": ""}, "it lacks SESSION_ID"),
        ({"STUDY_ID": "6" * 24}, "its STUDY_ID is that of another study"),
        ({"PROLIFIC_PID": "{{%PROLIFIC_PID%}}"}, "Prolific has not filled in PROLIFIC_PID"),
        ({"SESSION_ID": "c" * 65}, "Prolific has not filled in SESSION_ID"),
    ],
)
def test_a_faulty_link_of_prolific_says_what_is_wrong(
    wrong: dict[str, str], said: str, caplog: pytest.LogCaptureFixture
) -> None:
    with pytest.raises(UserError, match=said) as refused:
        link_of(QueryParams({**GIVEN, **wrong}), STUDY, ENGLISH)
    assert "send the researchers a message" in str(refused.value)
    assert caplog.messages == [f"A link of Prolific was refused: {said}."]


def test_a_study_without_prolific_says_so() -> None:
    with pytest.raises(UserError, match="does not take people from Prolific"):
        link_of(QueryParams(GIVEN), None, ENGLISH)
