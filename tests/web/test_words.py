"""Every text of the pages is in every language's catalogue, and every key that is used has words."""

import json
import re
from pathlib import Path
from typing import get_args

import pytest

from latentarm.robots.catalogue import ROBOTS
from latentarm.web.jobs.training import model_names
from latentarm.web.protocol.notice import Notice, NoticeCode
from latentarm.web.protocol.orders import ModeName
from latentarm.web.protocol.report import HeldBack
from latentarm.web.server.assets import FOLDER
from latentarm.web.words.catalogue import DEFAULT, languages

ENGLISH = languages()[DEFAULT].texts
SOURCES = [*FOLDER.rglob("*.js"), *FOLDER.rglob("*.html")]


def forms(text):
    return [text] if isinstance(text, str) else list(text.values())


def parameters(text):
    return {name for form in forms(text) for name in re.findall(r"\{(\w*)\}", form)}


def test_every_code_has_words():
    keys = {f"notice.{code}" for code in get_args(NoticeCode)}
    assert {key for key in ENGLISH if key.startswith("notice.")} == keys
    assert {f"held_back.{cause}" for cause in get_args(HeldBack)} <= set(ENGLISH)
    assert {f"model.{name}.help" for name in model_names()} <= set(ENGLISH)
    assert {f"robot.{name}" for name in ROBOTS} == {key for key in ENGLISH if key.startswith("robot.")}
    assert len(get_args(ModeName)) == 3


def test_every_key_that_a_page_names_has_words():
    parts = "|".join({key.split(".")[0] for key in ENGLISH})
    named = re.compile(rf"""["']((?:{parts})\.[a-z_0-9]+(?:\.[a-z_0-9]+)*)["']""")
    used = {key for path in SOURCES for key in named.findall(path.read_text())}
    used -= {key for key in used if key.endswith((".html", ".js", ".css", ".svg"))}
    assert len(used) > 150
    assert used - set(ENGLISH) == set()


def test_the_pages_speak_four_languages():
    named = {code: words.name for code, words in languages().items()}
    assert named == {"de": "Deutsch", "en": "English", "es": "Español", "zh": "中文（简体）"}


@pytest.mark.parametrize("language", sorted(languages()))
def test_a_language_has_the_keys_of_english_in_their_order_once(language):
    pairs = []
    own = (FOLDER.parent / "words" / f"{language}.json").read_text(encoding="utf-8")
    json.loads(own, object_pairs_hook=lambda found: pairs.append([key for key, _ in found]))
    assert pairs[-1] == list(ENGLISH)


@pytest.mark.parametrize("language", sorted(set(languages()) - {DEFAULT}))
def test_what_is_a_sentence_in_english_is_translated(language):
    texts = languages()[language].texts
    words = {key: re.findall(r"[a-z]{4,}", str(text)) for key, text in ENGLISH.items()}
    same = [key for key, text in ENGLISH.items() if texts[key] == text and len(words[key]) > 2]
    assert same == []


@pytest.mark.parametrize("language", sorted(languages()))
def test_a_language_has_every_text_with_the_same_parameters(language):
    texts = languages()[language].texts
    path = Path(str(FOLDER.parent / "words" / f"{language}.json"))
    assert path.is_file()
    own = path.read_text()
    missing = [key for key in ENGLISH if f'"{key}":' not in own]
    assert missing == []
    assert {key: parameters(text) for key, text in texts.items()} == {
        key: parameters(text) for key, text in ENGLISH.items()
    }
    assert all("other" in text for text in texts.values() if not isinstance(text, str))


def test_a_notice_is_a_sentence_in_english():
    notice = Notice(code="too_few_episodes", parameters={"least": 3, "count": 1})
    assert notice.text.startswith("Training needs at least 3 recordings, and only one is chosen")
    assert Notice(code="stop_pressed_by", parameters={"name": "{x}"}).text == "{x} pressed Stop."
