"""A preregistration is one document with its hash, and a report says what differs from it."""

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from drawn_trials import drawn_trials
from latentarm.cli import main
from latentarm.runs.results_folder import write_json
from latentarm_research.user_studies.catalogue import load_definition
from latentarm_research.user_studies.definition import Definition
from latentarm_research.user_studies.preregistration import differences
from latentarm_research.user_studies.recorded import Recorded
from latentarm_research.user_studies.sizes import PRESETS

EATING = load_definition("eating")


@pytest.fixture
def plan(tmp_path: Path) -> Path:
    power = tmp_path / "power"
    write_json(power / "power.json", {"draws": 200})
    plan = tmp_path / "plan.json"
    command = ["study", "preregister", "eating", "--power", str(power), "--out", str(plan)]
    assert main(command) == 0
    assert main(command) == 2  # it is not overwritten
    return plan


def test_it_holds_the_plan(plan: Path) -> None:
    document = json.loads(plan.read_text())
    assert document["definition"] == EATING.as_json()
    assert document["power"] == {"draws": 200}
    assert "Holm" in document["analysis"]["words"]
    assert len(document["digest"]) == 64


def test_what_differs_is_said_field_by_field(plan: Path) -> None:
    study = whole(EATING)
    assert differences(plan, study) == []
    found = differences(plan, replace(study, definition=replace(EATING, people=20)))
    assert found == ["definition.people was 12, and is 20.", "People: 20 planned, 12 took part."]
    # One person who left out one trial.
    (found,) = differences(plan, replace(study, trials=study.trials[1:]))
    assert found.endswith("trials in each condition: 1 planned, 0 to 1 driven.")


def whole(definition: Definition) -> Recorded:
    """The study with as many people and trials as it plans."""
    trials = tuple(drawn_trials(definition, definition.people, np.random.default_rng(1)))
    return Recorded(definition, "real", trials, (), (), PRESETS["paper"])


def test_a_document_that_was_changed_is_refused(plan: Path, capsys: pytest.CaptureFixture[str]) -> None:
    plan.write_text(plan.read_text().replace('"draws": 200', '"draws": 100'))
    folder = plan.parent / "people"
    study = whole(EATING)
    write_json(folder / "config.json", {"study": EATING.study, "people_are": "real"})
    write_json(folder / "trials.json", study.documents["trials.json"])
    command = [
        "study",
        "analyse",
        str(folder),
        "--preregistered",
        str(plan),
        "--out",
        str(plan.parent / "report"),
    ]
    assert main(command) == 2
    assert "not as it was written" in capsys.readouterr().err
    plan.write_text(plan.read_text().replace('"draws": 100', '"draws": 200'))
    assert main(command) == 0
    page = (plan.parent / "report" / "results.md").read_text()
    assert "from the preregistration\n\nNowhere." in page
