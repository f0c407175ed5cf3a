"""What a person is shown, and what they can type."""

import os
import pty
import select
import sys
import termios
import threading
import time

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from latentarm.alignment.answers import Motions
from latentarm.alignment.preference import ToolAxes
from latentarm.core.errors import UserError
from latentarm.core.types import Pose
from latentarm.robots.planar import planar
from latentarm.runs.asking import CELLS, PersonAtTerminal, SimulatedRespondent, describe, draw, moved
from latentarm.runs.person import Question
from latentarm.runs.stick_line import parse, read_line

UP, DOWN, RIGHT, LEFT = (f"\x1b[{letter}" for letter in "ABCD")


@pytest.mark.parametrize(
    ("line", "axes", "u"),
    [
        ("0.5 -1", 2, [0.5, -1]),
        (" 1e-1,  0 ", 2, [0.1, 0]),
        ("-0.25", 1, [-0.25]),
        ("0 0 1", 3, [0, 0, 1]),
        (UP, 2, [0, 0.25]),
        (RIGHT * 2 + DOWN, 2, [0.5, -0.25]),
        (LEFT * 9 + RIGHT, 2, [-0.75, 0]),
        ("\x1bOA", 2, [0, 0.25]),
        (RIGHT, 1, [0.25]),
    ],
)
def test_lines_that_are_inputs(line, axes, u):
    np.testing.assert_allclose(parse(line, axes), u)


@pytest.mark.parametrize("line", ["", "  ", ","])
def test_an_empty_line_skips(line):
    assert parse(line, 2) is None


@pytest.mark.parametrize(
    ("line", "axes"),
    [
        ("up", 2),
        ("1", 2),
        ("1 0 0", 2),
        ("1.5 0", 2),
        ("nan 0", 2),
        ("inf 0", 2),
        (UP, 1),
        (UP, 3),
        (UP + "1", 2),
    ],
)
def test_lines_that_are_none(line, axes):
    with pytest.raises(ValueError, match=r"\.$"):
        parse(line, axes)


class Terminal:
    """Both ends of a terminal; standard input is one of them."""

    def __init__(self, monkeypatch):
        self.keyboard, screen = pty.openpty()
        self.stdin = os.fdopen(screen, "r")
        monkeypatch.setattr(sys, "stdin", self.stdin)

    def type(self, keys):
        """Press keys once the terminal listens key by key: what was typed before is no answer."""
        os.write(self.keyboard, b"1 1\n")
        assert select.select([self.stdin], [], [], 10.0)[0], (
            "a terminal hands over what is typed a little later"
        )
        self.typing = threading.Thread(target=self._wait_and_type, args=(keys,))
        self.typing.start()

    def _wait_and_type(self, keys):
        for _ in range(1000):
            if not termios.tcgetattr(self.keyboard)[3] & termios.ICANON:
                time.sleep(0.05)  # Linux shows the new mode a moment before it applies it to what is typed
                os.write(self.keyboard, keys.encode())
                return
            time.sleep(0.01)

    def close(self):
        self.typing.join()
        self.stdin.close()
        os.close(self.keyboard)


@pytest.fixture
def terminal(monkeypatch):
    terminal = Terminal(monkeypatch)
    yield terminal
    terminal.close()


@pytest.mark.parametrize(
    ("keys", "u", "shown"),
    [
        ("0.5 -1\n", [0.5, -1], "0.5 -1"),
        (RIGHT + RIGHT + UP + "\n", [0.5, 0.25], "stick at (+0.50, +0.25)"),
        ("0.7\x7f5 0\n", [0.5, 0], "0.5 0"),
        (LEFT + "\x7f" + UP + "\r", [0, 0.25], "stick at (+0.00, +0.25)"),
        ("\x1b" + "0 1\n", [0, 1], "0 1"),
        ("\n", None, ""),
    ],
)
def test_keys_at_a_terminal(terminal, capsys, keys, u, shown):
    terminal.type(keys)
    answer = parse(read_line(2), 2)
    assert (answer is None) if u is None else np.allclose(answer, u)
    assert shown in capsys.readouterr().err


def test_the_terminal_is_left_as_it_was(terminal):
    before = termios.tcgetattr(terminal.stdin.fileno())
    terminal.type("\x04")
    with pytest.raises(EOFError):
        read_line(2)
    assert termios.tcgetattr(terminal.stdin.fileno()) == before


def pose(x=0.0, y=0.0, z=0.0, turn=(0.0, 0.0, 0.0)):
    return Pose(np.array([x, y, z]), Rotation.from_rotvec(turn).as_matrix())


def test_a_motion_in_words():
    words = describe("fork", pose(0.5), pose(0.531, -0.027, 0.0041))
    assert words == "fork moves x +31, y -27, z +4 mm and does not turn"
    turned = describe("fork", pose(turn=(0, 0, 1.0)), pose(turn=(0, 0, 1.0 + np.pi / 6)))
    assert turned == "fork moves x +0, y +0, z +0 mm and turns by 30° about (+0.0, +0.0, +1.0)"


def test_a_motion_as_a_figure():
    lines = draw(pose(), pose(0.1, -0.05, -0.1), reach_m=0.1).splitlines()[1:-1]
    assert len(lines) == 2 * CELLS + 1
    above = [line[4 : 4 + 4 * CELLS + 1 : 2] for line in lines]
    height = [line[-1] for line in lines]
    assert above[CELLS][CELLS] == "o"
    assert above[0][CELLS + CELLS // 2] == "*", "x is up, and y is to the left"
    assert height[CELLS] == "o"
    assert height[-1] == "*"
    assert "".join(lines).isascii()


def test_a_motion_beyond_the_figure_ends_at_its_edge():
    assert "*" in draw(pose(), pose(9.0, 9.0, 9.0), reach_m=0.1)
    assert "*" in draw(pose(), pose(), reach_m=0.0)


def test_only_the_tools_that_move_are_spoken_of(two_arms):
    start = np.zeros((1, 6))
    one = Motions(start, start + 0.1 * np.eye(6)[5], 0.5)
    assert len(moved(two_arms.chain, one)) == 1
    assert len(moved(two_arms.chain, Motions(start, start + 0.1, 0.5))) == 2
    assert len(moved(two_arms.chain, Motions(start, start, 0.5))) == 1


@pytest.fixture
def two_arms():
    return planar(n_links=3, arms=2)


@pytest.fixture
def question(two_arms):
    start = np.full((1, 6), 0.2)
    motion = Motions(start, start + 0.05, 0.5)
    return Question(2, 10, motion, two_arms.chain, reach_m=0.2, axes=2)


def test_a_person_is_asked_until_the_answer_is_one(question):
    heard, lines = [], iter(["what?", "3 3", "0.5 0.5"])
    person = PersonAtTerminal(heard.append, lambda axes: next(lines))
    np.testing.assert_allclose(person.answer(question), [0.5, 0.5])
    text = "\n".join(heard)
    assert "Question 2 of at most 10" in text
    assert text.count("Once more") == 2
    assert "from above" in text


def test_someone_who_leaves_is_no_answer(question):
    def gone(axes):
        raise EOFError

    with pytest.raises(UserError, match="ended"):
        PersonAtTerminal(lambda text: None, gone).answer(question)


def test_the_simulated_person_answers_by_the_axes_of_the_base(question, two_arms):
    preference = ToolAxes(two_arms.chain, 2, speed_m_s=0.5)
    heard = []
    u = SimulatedRespondent(preference, heard.append).answer(question)
    motion = question.motion
    moved = two_arms.chain.forward(motion.end[0]).position - two_arms.chain.forward(motion.start[0]).position
    np.testing.assert_allclose(u, np.clip(moved[:2] / (0.5 * 0.5), -1, 1))
    assert len(heard) == 1
    assert "simulated" in heard[0]


@pytest.mark.parametrize("wrong", [{"axes": 0}, {"axes": 4}, {"speed_m_s": 0.0}, {"speed_m_s": float("nan")}])
def test_a_preference_that_is_none_is_refused(two_arms, wrong):
    with pytest.raises(UserError, match="simulated person"):
        ToolAxes(**{"chain": two_arms.chain, "axes": 2, "speed_m_s": 0.1, **wrong})
