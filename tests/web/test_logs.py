"""What strangers send reaches the operator's terminal only as text."""

import logging

from hypothesis import given
from hypothesis import strategies as st

from latentarm.web.server.logs import make_printable


def shown(message, *args, error=None):
    """The lines that a terminal is sent."""
    info = None if error is None else (type(error), error, None)
    record = logging.LogRecord("any", logging.WARNING, __file__, 1, message, args, info)
    assert make_printable(record)
    return logging.Formatter("%(levelname)s: %(message)s").format(record)


def test_escape_sequences_and_forged_lines_are_escaped():
    path = "/\x1b]0;owned\x07\x1b[2J\nERROR: the arm is on fire"
    line = shown("%s not found", path)
    assert line == r"WARNING: /\x1b]0;owned\x07\x1b[2J\nERROR: the arm is on fire not found"


@given(st.text())
def test_nothing_that_a_terminal_obeys_is_shown(text):
    lines = shown("%s", text, error=ValueError(text))
    assert all(one == "\n" or (one >= " " and not "\x7f" <= one <= "\x9f") for one in lines)
    assert "\n" not in lines.split("ValueError")[0].removesuffix("\n")
