"""JSON that nobody vouches for: refused in one sentence before it costs much."""

import json
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from latentarm.core.errors import UserError
from latentarm.core.untrusted.documents import (
    MOST_BYTES,
    MOST_LEVELS,
    MOST_TEXT_BYTES,
    parse_object,
    read_object,
)

FINITE = st.floats(allow_nan=False, allow_infinity=False)
VALUES = st.recursive(
    st.none() | st.booleans() | st.integers(-(10**18), 10**18) | FINITE | st.text(),
    lambda inner: st.lists(inner) | st.dictionaries(st.text(), inner),
    max_leaves=20,
)


@settings(max_examples=20)
@given(document=st.dictionaries(st.text(), VALUES), escaped=st.booleans())
def test_reads_what_json_wrote(document: dict[str, object], escaped: bool) -> None:
    assert parse_object(json.dumps(document, ensure_ascii=escaped), "it") == document


@given(content=st.binary() | st.text(alphabet='{}[]",:\\u0d819e').map(str.encode))
def test_anything_else_is_one_sentence(content: bytes) -> None:
    said = ""
    try:
        parse_object(content, "it")
    except UserError as error:
        said = str(error)
    assert "\n" not in said


def test_a_slip_is_named_with_its_line_and_column() -> None:
    with pytest.raises(
        UserError, match=r"^mine\.json is not .*: line 3, column 3: expecting ',' delimiter\.$"
    ):
        parse_object('{\n  "people": 12\n  "name": "mine"\n}', "mine.json")


HOSTILE = {
    "deep list": (b'{"a":' + b"[" * 10_000 + b"]" * 10_000 + b"}", f"deeper than {MOST_LEVELS}"),
    "deep object": (b'{"a":' * 10_000 + b"1" + b"}" * 10_000, "deeper than"),
    "deep and cut off": (b'{"a":' * 500_000, "deeper than"),
    "many lists": (b'{"a":[' + b"[]," * 500_000 + b"1]}", "more than 1,000,000 values"),
    "many quotes": (b'"' * 4_000_001, "more than 1,000,000 values"),
    "long text": (b'{"a":"' + b"x" * (MOST_TEXT_BYTES + 1) + b'"}', "a text of more than"),
    "long text of escapes": (b'{"a":"' + b"\\\\" * MOST_TEXT_BYTES + b'"}', "a text of more than"),
    "long name": (b'{"' + b"x" * (MOST_TEXT_BYTES + 1) + b'":1}', "a text of more than"),
    "text without an end": (b'{"a":"' + b'\\"' * 1000, "not a JSON document"),
    "not a number": (b'{"a":NaN}', "holds NaN"),
    "infinity": (b'{"a":[-Infinity]}', "holds -Infinity"),
    "hidden infinity": (b'{"a":1e999}', "too large for a computer"),
    "long number": (b'{"a":' + b"9" * 4000 + b"}", "more than 20 digits"),
    "same field twice": (b'{"a":1,"a":2}', "a field twice"),
    "half a character": (b'{"a":["\\ud83d"]}', "not Unicode"),
    "half a character in a name": (b'{"a":{"\\uDC00":1}}', "not Unicode"),
    "no UTF-8": (b'{"a":"\xff"}', "not a JSON document in UTF-8"),
    "UTF-16": ('{"a":1}'.encode("utf-16"), "not a JSON document in UTF-8"),
    "list": (b"[1]", "not an object"),
    "nothing": (b"", "not a JSON document"),
    "too long": (b" " * (MOST_BYTES + 1), "more than"),
}


@pytest.mark.parametrize("case", HOSTILE)
def test_hostile_documents(case: str) -> None:
    content, said = HOSTILE[case]
    with pytest.raises(UserError, match=said) as refusal:
        parse_object(content, "the file")
    assert str(refusal.value).startswith("the file ")


def test_brackets_and_commas_in_texts_count_for_nothing() -> None:
    text = '[{,"\\' * 5_000
    assert parse_object(json.dumps({"a": text}), "it") == {"a": text}


def test_a_whole_character_from_two_escapes() -> None:
    assert parse_object(b'{"a":"\\ud83d\\ude00"}', "it") == {"a": "\N{GRINNING FACE}"}


def test_a_file_is_bounded_too(tmp_path: Path) -> None:
    path = tmp_path / "file.json"
    path.write_text('{"a": 1}')
    assert read_object(path) == {"a": 1}
    with pytest.raises(UserError, match="at most 4 bytes"):
        read_object(path, 4)
