"""Runs what the pages of the documentation tell their readers to run."""

import json
import re
import shlex
import signal
import subprocess
import sys
import textwrap
import tomllib
from dataclasses import dataclass
from pathlib import Path
from typing import Any
from urllib.request import urlopen

import yaml

from latentarm.cli import main

ROOT = Path(__file__).parents[1]
OF_THE_ROOT = ("README.md", "CONTRIBUTING.md", "SUPPORT.md", "SECURITY.md")
PAGES = [*(ROOT / name for name in OF_THE_ROOT), *sorted((ROOT / "docs").rglob("*.md"))]
BLOCK = re.compile(r'^( *)```([a-z]*)(?: title="([^"]*)")?\n(.*?)^\1```$', re.DOTALL | re.MULTILINE)
SNIPPET = re.compile(r'^--8<-- "([^"]+)"$')

SLOW = ("bench", "compare", "demo", "reproduce", "study")
"""Commands that take minutes even at their smallest."""

QUICKLY = {
    "train": {"--epochs": "1", "--seeds": "1", "--hidden": "8"},
    "evaluate": {"--folds": "0"},
    "drive": {"--drives": "1", "--time-limit-s": "1"},
    "align": {"--answers": "2"},
    "doctor": {"--port": "0"},
}
"""Options that make a command short, whatever the page says."""


@dataclass(frozen=True)
class Block:
    """A fenced block of a page.

    Attributes:
        language: after the opening fence; empty where none is given.
        title: the file that the reader saves it as; empty where it is none.
        code: what it says, without the indentation of the fence.
    """

    language: str
    title: str
    code: str


def name_of(page: Path) -> str:
    """A page as tests call it: its path from the root."""
    return page.relative_to(ROOT).as_posix()


def blocks(page: Path) -> list[Block]:
    """All fenced blocks, in order."""
    found = BLOCK.findall(page.read_text())
    return [Block(language, title, textwrap.dedent(code)) for _, language, title, code in found]


def commands(page: Path) -> list[str]:
    """The lines of a page's shell blocks, without comments."""
    lines = [line for block in blocks(page) if block.language == "sh" for line in lines_of(block)]
    return list(dict.fromkeys(lines))


def lines_of(block: Block) -> list[str]:
    """The commands of a shell block; a backslash continues one on the next line."""
    lines = [line.split("#")[0].strip() for line in block.code.replace("\\\n", " ").splitlines()]
    return [re.sub(r"\s+", " ", line) for line in lines if line]


def quickly(line: str) -> list[str]:
    """The words of a command after ``latentarm``, of a size for a test."""
    words = shlex.split(line)[1:]
    for option, value in QUICKLY.get(words[0], {}).items():
        if option in words:
            words[words.index(option) + 1] = value
        else:
            words += [option, value]
    return words


def serve(line: str) -> None:
    """Start the page, open it as a browser would, and end it with Ctrl-C."""
    words = [sys.executable, "-m", "latentarm", *shlex.split(line)[1:], "--port", "0", "--json"]
    with subprocess.Popen(words, stdout=subprocess.PIPE, text=True) as process:
        try:
            assert process.stdout is not None
            address = json.loads(process.stdout.readline())["address"]
            with urlopen(address, timeout=30) as page:  # noqa: S310 - our own server
                assert b"<html" in page.read().lower()
        finally:
            process.send_signal(signal.SIGINT)
        assert process.wait(30) == 0


def run_page(page: Path, not_run: dict[str, str]) -> dict[str, Any]:
    """Run a page from top to bottom in the current folder, as a reader would; slow commands are left out.

    Args:
        page: the page.
        not_run: lines that are not run.

    Returns:
        The names that its Python blocks define.
    """
    names: dict[str, Any] = {"__name__": "__main__"}
    for block in blocks(page):
        if included := SNIPPET.match(block.code.strip()):
            assert (ROOT / included[1]).exists(), included[1]  # test_examples.py runs it
        elif block.title:
            Path(block.title).write_text(block.code)
        elif block.language == "python":
            exec(compile(block.code, name_of(page), "exec"), names)  # noqa: S102 - the page is ours
        elif block.language == "toml":
            tomllib.loads(block.code)
        elif block.language == "json":
            json.loads(block.code)
        elif block.language == "yaml":
            yaml.safe_load(block.code)
        elif block.language == "sh":
            for line in lines_of(block):
                if line in not_run or line.split()[1] in SLOW:
                    continue
                if line.startswith("latentarm teleop"):
                    serve(line)
                else:
                    assert main(quickly(line)) in (0, 1), line
        else:
            assert block.language == "text", (
                f"{name_of(page)}: say how a block of {block.language!r} is tested"
            )
    return names
