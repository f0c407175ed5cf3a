"""A study with a task, condition, measure and questionnaire of one's own, as the documentation says."""

import csv
import json
import os
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

from documentation import ROOT, blocks
from registered import register
from study_participant import participant, serving

PACKAGE = ROOT / "tests" / "plugins" / "latentarm_example"


@pytest.fixture
def study(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The definition of the page, for processes with the package of the page."""
    register(PACKAGE, tmp_path / "site")
    path = (tmp_path / "site", PACKAGE / "src", os.environ.get("PYTHONPATH", ""))
    monkeypatch.setenv("PYTHONPATH", os.pathsep.join(map(str, path)))
    monkeypatch.chdir(tmp_path)
    document: dict[str, Any] = json.loads((ROOT / "examples" / "pie_apart.json").read_text())
    for block in blocks(ROOT / "docs" / "how-to" / "study.md"):
        if block.language == "json":
            document |= json.loads(block.code)
    (tmp_path / "bite.json").write_text(json.dumps(document))
    return tmp_path / "bite.json"


def output_of(*words: object) -> str:
    """The standard output of a command that must end well."""
    done = subprocess.run(
        [sys.executable, "-m", "latentarm", "study", *map(str, words)],
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    return done.stdout


def test_a_page_with_ones_own_parts_is_a_study(study: Path) -> None:
    shown = json.loads(output_of("show", study, "--json"))
    assert shown["tasks"][0]["scene"] == "one_bite"
    assert "highest_speed" in shown["measures"]
    output_of("preregister", study, "--out", "plan.json")
    analysis = json.loads(Path("plan.json").read_text())["analysis"]
    assert analysis["measures"] == {"highest_speed": "latentarm-example 0.3.0"}


@pytest.mark.slow
def test_ones_own_parts_go_through_a_study(study: Path) -> None:
    output_of("run", study, "--preset", "smoke", "--simulated", 2, "--jobs", 1, "--out", "simulated")
    trials = json.loads(Path("simulated/trials.json").read_text())["trials"]
    assert {one["condition"] for one in trials} == {"Alone", "Help"}
    assert all(one["measures"]["highest_speed"] > 0.0 for one in trials)
    with serving(str(study), "--out", "people") as (link, _), participant(link, link) as person:
        while (part := person.part) != "finished":
            if part == "questions":
                answers = {"ease_1": 6, "ease_2": 2, "load_1": 30, "uses": "1;2", "wish": "more"}
                order = int(person.page.split('data-order="')[1][0])
                assert person.post("answers", order=order, answers=answers).json() == {"to": "/study"}
            else:
                {"consent": person.consent, "practice": person.ready, "trial": person.try_drive}[part]()
    assert "Drives that come out the same: 2 of 2." in output_of("replay", "people")
    output_of("analyse", "people")
    page = Path("people-analysis/results.md").read_text()
    assert "highest speed (m/s)" in page
    assert "| What do you use? | cane | 1 of 1 | 1 of 1 |" in page
    output_of("export", "people")
    codebook = Path("people-dataset/documentation/codebook.csv").read_text().splitlines()
    (about,) = (line for line in csv.DictReader(codebook) if line["name"] == "highest_speed")
    assert about["unit"] == "m/s"
