"""A study speaks one language, on its own pages, in its refusals, and when the Drive page opens."""

import re
from collections.abc import Iterator
from pathlib import Path

import pytest

from latentarm.web.words.catalogue import COOKIE as LANGUAGE_COOKIE
from latentarm.web.words.catalogue import languages
from latentarm_research.user_studies.own.definition_file import read_definition
from latentarm_research.user_studies.serving import words
from latentarm_research.user_studies.serving.options import PAGES, general_information
from latentarm_research.user_studies.serving.words.catalogue import study_languages
from study_here import Study

OWN = languages(words.__name__)
ENGLISH = OWN["en"].texts


@pytest.fixture(scope="module")
def german(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Study]:
    study = Study(tmp_path_factory.mktemp("study"), language="de")
    yield study
    study.close()


def forms(text: object) -> list[str]:
    return list(text.values()) if isinstance(text, dict) else [str(text)]


def parameters(text: object) -> set[str]:
    return {name for form in forms(text) for name in re.findall(r"\{(\w*)\}", form)}


@pytest.mark.parametrize("language", sorted(languages()))
def test_a_study_has_all_texts_in_every_language_of_the_drive_page(language: str) -> None:
    own = (Path(words.__path__[0]) / f"{language}.json").read_text()
    assert re.findall(r'^  "(study\.[a-z_.]+)":', own, re.MULTILINE) == list(ENGLISH)
    texts = study_languages()[language].texts
    assert {key: parameters(texts[key]) for key in ENGLISH} == {
        key: parameters(text) for key, text in ENGLISH.items()
    }
    same = [key for key, text in ENGLISH.items() if texts[key] == text and language != "en"]
    assert [key for key in same if key != "study.questions.ends"] == []


def test_every_text_is_used_and_every_key_that_is_used_has_a_text() -> None:
    sources = [*PAGES.iterdir(), *PAGES.parent.glob("*.py")]
    used = {
        key for path in sources for key in re.findall(r'"(study\.[a-z_]+(?:\.[a-z_]+)?)"', path.read_text())
    }
    used -= {path.name for path in sources}
    used |= {key for key in ENGLISH if key.startswith("study.prolific.")}
    assert used == set(ENGLISH)


def test_every_page_of_a_study_in_german_is_german(german: Study) -> None:
    for part in ("", "?left", "?PROLIFIC_PID=1"):
        page = german.ask("", "GET", part).text
        assert '<html lang="de">' in page
        assert not [text for text in map(str, ENGLISH.values()) if " " in text and f">{text}<" in page]
    consent = german.ask(german.key("consent"), "GET").text
    assert "Teilnehmen" in consent
    assert "nehme freiwillig teil" in consent
    assert german.ask("", "POST", "/begin").json() == {"problem": study_languages()["de"].say("study.link")}


def test_the_drive_page_opens_in_the_studys_language(german: Study) -> None:
    code = german.store.open_places(5)[-1]
    answer = german.ask("", "GET", f"?code={code}")
    assert answer.cookies[LANGUAGE_COOKIE] == "de"


@pytest.mark.parametrize("language", sorted(languages()))
def test_the_general_information_says_how_many_ways_and_for_how_long(german: Study, language: str) -> None:
    told = read_definition(german.folder / "two_ways.json")
    text = general_information(told, 2.5, study_languages()[language])
    assert all(part in text for part in ("2.5", "2 " if language != "zh" else "2", "- **"))
    assert "{" not in text
