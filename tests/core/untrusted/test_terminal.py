"""A terminal shows hostile text and obeys none of it."""

import unicodedata

import pytest
from hypothesis import given
from hypothesis import strategies as st

from latentarm.core.untrusted.terminal import MOST_CHARACTERS, one_line, visible


@pytest.mark.parametrize(
    ("text", "shown"),
    [
        ("pour coffee", "pour coffee"),
        ("\x1b]0;owned\x07\x1b[2J", r"\x1b]0;owned\x07\x1b[2J"),
        ("\x9b31m", r"\x9b31m"),
        ("over\rwritten\b\t", r"over\rwritten\x08\t"),
        ("\u202egnp.exe", r"\u202egnp.exe"),
        ("\u2067a\u2069", r"\u2067a\u2069"),
        ("\ud83d", r"\ud83d"),
        ("\U000e0041", r"\U000e0041"),
        ("Käse, 日本, \N{GRINNING FACE}, می\u200cخواهم", "Käse, 日本, \N{GRINNING FACE}, می\u200cخواهم"),
        ("two\nlines", "two\nlines"),
    ],
)
def test_shows_and_does_not_obey(text: str, shown: str) -> None:
    assert visible(text) == shown


@given(text=st.text(st.characters(), max_size=50))
def test_nothing_that_is_obeyed_comes_through(text: str) -> None:
    kept = {"\n", "\u200c", "\u200d"}
    assert all(unicodedata.category(one) not in {"Cc", "Cf", "Cs"} or one in kept for one in visible(text))
    assert "\n" not in one_line(text)
    visible(text).encode()


def test_a_sentence_is_short_and_keeps_both_ends() -> None:
    shown = one_line("begins " + "\x1b" * 10_000 + " ends")
    assert len(shown) <= MOST_CHARACTERS + 3
    assert shown.startswith("begins ")
    assert shown.endswith(" ends")
