"""A line as an input: numbers, or the arrow keys as a stick."""

import os
import re
import sys
from collections.abc import Callable
from typing import Final

import numpy as np

from latentarm.core.types import FloatArray

ARROW: Final = re.compile(r"\x1b[\[O]([ABCD])")  # a terminal's bytes for an arrow key
PUSHES: Final = {"C": (0, 1), "D": (0, -1), "A": (1, 1), "B": (1, -1)}
"""Axis and direction of the keys right, left, up and down."""

PRESS: Final = 0.25  # how far one press of an arrow key pushes
ESCAPE: Final = "\x1b"
END: Final = "\x04"
ERASE: Final = ("\x7f", "\b")


def parse(line: str, axes: int) -> FloatArray | None:
    """The input (d,) of a typed line, or None for an empty one.

    The line has ``axes`` numbers in [-1, 1], separated by blanks or commas, or arrow keys as terminals send
    them. Any other raises ValueError with a sentence for the person.
    """
    if ARROW.search(line):
        if ARROW.sub("", line).strip():
            raise ValueError("That mixes arrow keys and letters.")
        return _pushed(line, axes)
    words = line.replace(",", " ").split()
    if not words:
        return None
    try:
        u = np.array([float(word) for word in words])
    except ValueError as error:
        raise ValueError("That is not a number.") from error
    if len(u) != axes:
        raise ValueError(f"That was {len(u)} of {axes} numbers.")
    # Written so that a value that is not a number fails too.
    if not (np.abs(u) <= 1).all():
        raise ValueError("Each number must be from -1 to 1.")
    return u


def read_line(axes: int) -> str:
    """A line from standard input. At a terminal the arrow keys push a stick that is shown meanwhile.

    Windows has no POSIX terminal: there, as from a pipe, a line is numbers. Raises EOFError where the input
    has ended.
    """
    if sys.platform != "win32" and sys.stdin.isatty():
        return _read_terminal(axes)
    line = sys.stdin.readline()
    if not line:
        raise EOFError
    return line.rstrip("\n")


def _read_terminal(axes: int) -> str:
    """A line typed at a POSIX terminal, key by key; EOFError where the input ends."""
    import termios
    import tty

    descriptor = sys.stdin.fileno()
    before = termios.tcgetattr(descriptor)
    tty.setcbreak(descriptor, termios.TCSAFLUSH)  # keys typed before the question do not answer it
    try:
        return _read_keys(lambda: os.read(descriptor, 1).decode("latin-1"), _show, axes)
    finally:
        termios.tcsetattr(descriptor, termios.TCSADRAIN, before)
        _show("\n")


def _read_keys(key: Callable[[], str], show: Callable[[str], None], axes: int) -> str:
    """Keys up to Enter as one line, shown as they come; EOFError where the input ends."""
    line = ""
    while True:
        pressed = key()
        if pressed == ESCAPE:
            pressed = key()
            if pressed in "[O":
                pressed = ESCAPE + pressed + key()
        if pressed in ("", END):
            raise EOFError
        if pressed in ("\n", "\r"):
            return line
        if pressed in ERASE:
            # Pushes are not undone one by one: the stick returns to the centre.
            line = "" if ARROW.search(line) else line[:-1]
        elif ARROW.fullmatch(pressed) or pressed.isprintable():
            line += pressed
        show("\r\x1b[K" + _shown(line, axes))


def _shown(line: str, axes: int) -> str:
    """The line as the person sees it: for arrow keys, where the stick is."""
    if not ARROW.search(line):
        return line
    try:
        u = parse(line, axes)
    except ValueError as error:
        return f"{error} (Backspace starts over.)"
    return "" if u is None else f"stick at ({', '.join(f'{value:+.2f}' for value in u)})"


def _pushed(line: str, axes: int) -> FloatArray:
    u = np.zeros(axes)
    for name in ARROW.findall(line):
        axis, way = PUSHES[name]
        if axis >= axes or axes > len("xy"):
            raise ValueError("The arrow keys have two axes, and this stick has others.")
        u[axis] = np.clip(u[axis] + way * PRESS, -1, 1)
    return u


def _show(text: str) -> None:
    sys.stderr.write(text)
    sys.stderr.flush()
