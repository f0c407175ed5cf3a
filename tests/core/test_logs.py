"""What strangers send reaches the operator's terminal only as text."""

import logging

import pytest
from hypothesis import given
from hypothesis import strategies as st

from latentarm.cli import main
from latentarm.core.errors import UserError
from latentarm.core.logs import (
    LONG_BYTES,
    LogSettings,
    log_settings,
    logging_also_to,
    logging_as,
    make_printable,
)


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


def test_secrets_are_left_out_of_messages_and_tracebacks():
    line = shown(
        "opened %s", "http://arm:8460/enter?key=abc-DEF_1&x=2", error=ValueError("cookie=s3cret; pin=1")
    )
    assert "x=2" in line
    assert "abc" not in line
    assert "s3cret" not in line
    assert "pin=1" not in line


def test_a_file_says_more_than_a_terminal_and_a_long_one_gives_way(tmp_path, capsys):
    path = tmp_path / "x.log"
    path.write_text("old " * LONG_BYTES)
    log = logging.getLogger("latentarm.test")
    with logging_as(LogSettings(files=(path,))), logging_also_to(tmp_path / "y.log"):
        assert log_settings().files == (path, tmp_path / "y.log")
        log.debug("detail")
        log.info("usual")
        log.warning("bad\x1b")
    log.warning("later")
    assert [line.split(": ")[-1] for line in path.read_text().splitlines()] == ["usual", r"bad\x1b"]
    assert (tmp_path / "y.log").read_text() == path.read_text()
    assert (tmp_path / "x.log.1").exists()
    assert capsys.readouterr().err == "WARNING: bad\\x1b\n"
    with logging_as(LogSettings(verbose=True, files=(path,))):
        log.debug("detail")
        log.info("usual")
    assert "detail" in path.read_text()
    assert capsys.readouterr().err == "INFO: usual\n"
    with pytest.raises(UserError, match="cannot be written"), logging_also_to(tmp_path / "no" / "file"):
        pass


def test_a_command_logs_how_it_ended(tmp_path, capsys):
    path = tmp_path / "x.log"
    assert main(["robots", "--log-file", str(path)]) == 0
    assert main(["robots", "nowhere.xml", "--log-file", str(path)]) == 2
    text = path.read_text()
    assert "robots begins." in text
    assert "robots ends with code 0." in text
    assert "UserError" in text
    assert main(["robots", "--log-file", str(tmp_path)]) == 2


@given(st.text())
def test_nothing_that_a_terminal_obeys_is_shown(text):
    lines = shown("%s", text, error=ValueError(text))
    assert all(one == "\n" or (one >= " " and not "\x7f" <= one <= "\x9f") for one in lines)
    assert "\n" not in lines.split("ValueError")[0].removesuffix("\n")
