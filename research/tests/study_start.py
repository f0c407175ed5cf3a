"""Starts of `latentarm study serve` in this process, which end as soon as the study is open."""

import json
from pathlib import Path
from typing import Any, final

import pytest

from latentarm.cli import main
from latentarm_research.user_studies.serving import serve as serving
from study_participant import CONTACT, MODES, TWIST, definition


@final
class Starts:
    """Starts a study from folders beside each other."""

    def __init__(self, folder: Path, patch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
        self.folder = folder
        self.out = folder / "people"
        self._capsys = capsys
        self._study = folder / "two_ways.json"
        self._study.write_text(json.dumps(definition(MODES, TWIST)))
        patch.setattr(serving, "serve_gate", _opened)

    def __call__(self, *options: str) -> int:
        """Start it with these options; its exit code."""
        given = ["study", "serve", str(self._study), "--port", "0", "--out", str(self.out), *options]
        is_first = not (self.out / "config.json").exists()
        return main([*given, "--contact", CONTACT] if is_first else given)

    @property
    def output(self) -> str:
        """Text printed since the last call, on one line."""
        printed = self._capsys.readouterr()
        return " ".join((printed.out + printed.err).split())

    @property
    def codes(self) -> list[str]:
        """The codes of the links."""
        lines = (self.out / "links.csv").read_text().splitlines()
        return [line.rpartition("=")[2] for line in lines[1:]]


def _opened(*given: Any) -> None:
    *_, open_it = given
    open_it()
