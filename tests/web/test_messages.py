"""The schema takes what it says and nothing else."""

import json

import pytest
from hypothesis import given
from hypothesis import strategies as st

from latentarm.web.protocol.notice import Notice
from latentarm.web.protocol.page_messages import parse_message

INPUT = {
    "type": "input",
    "seq": 1,
    "nonce": "00ff",
    "u": [0.5, -1],
    "source": "pointer",
    "latched": False,
}


def test_a_page_s_messages_are_read():
    assert parse_message(json.dumps(INPUT)).u == (0.5, -1.0)
    assert parse_message(json.dumps({**INPUT, "gripper": "toggle"})).gripper == "toggle"
    assert parse_message('{"type": "mode", "mode": "end_effector", "axes": 2}').axes == 2
    assert parse_message('{"type": "profile", "name": null}').name is None


@pytest.mark.parametrize(
    "change",
    [
        {"seq": 1.5},
        {"seq": -1},
        {"seq": True},
        {"seq": 10**30},
        {"nonce": 7},
        {"nonce": "x" * 65},
        {"u": []},
        {"u": [0.0] * 9},
        {"u": [1.01]},
        {"u": ["0.5"]},
        {"u": [None]},
        {"u": [True]},
        {"u": 0.5},
        {"source": "mind"},
        {"latched": 1},
        {"gripper": "grab"},
        {"gripper": True},
        {"extra": 1},
        {"type": "Input"},
        {"type": None},
    ],
)
def test_what_is_not_of_the_schema_is_refused(change):
    with pytest.raises(ValueError):
        parse_message(json.dumps({**INPUT, **change}))


@pytest.mark.parametrize("value", ["NaN", "Infinity", "-Infinity", "1e999"])
def test_numbers_that_are_none_are_refused(value):
    with pytest.raises(ValueError):
        parse_message(json.dumps(INPUT).replace("0.5", value))


@pytest.mark.parametrize(
    "frame",
    [
        "",
        "null",
        "[]",
        "7",
        '"stop"',
        "{",
        "{}",
        '{"type": "stop"} {"type": "stop"}',
        "\x00",
        "[" * 4000,
        '{"a":' * 700,
        '{"type": "hello", "version": 2}',
        '{"type": "hello", "version": 1, "name": "' + "x" * 41 + '"}',
    ],
)
def test_what_is_no_message_is_refused(frame):
    with pytest.raises(ValueError):
        parse_message(frame)


anything = st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats() | st.text(max_size=8),
    lambda inner: st.lists(inner, max_size=4) | st.dictionaries(st.text(max_size=8), inner, max_size=4),
    max_leaves=12,
)


@given(
    st.text()
    | anything.map(json.dumps)
    | st.fixed_dictionaries(dict.fromkeys(INPUT, anything)).map(json.dumps)
)
def test_nothing_gets_past_it(frame):
    with pytest.raises(ValueError):
        parse_message(frame)


def test_a_message_that_is_final_cannot_be_extended():
    with pytest.raises(TypeError, match="final"):
        type(Notice)("Longer", (Notice,), {"__module__": __name__})
