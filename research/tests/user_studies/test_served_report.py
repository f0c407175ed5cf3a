"""The report and the dataset of a served study say how it was carried out."""

import csv
import json
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from latentarm.cli import main
from latentarm.runs.results_folder import write_json
from latentarm_research.user_studies.catalogue import load_definition
from latentarm_research.user_studies.drive_record import DriveRecord
from latentarm_research.user_studies.own.definition_file import read_definition
from latentarm_research.user_studies.recorded import Recorded
from latentarm_research.user_studies.report.people import input_words, practice_words
from latentarm_research.user_studies.serving.store import Store
from latentarm_research.user_studies.sizes import PRESETS
from latentarm_research.user_studies.trace import BINS, Trace
from study_participant import MODES, TWIST, definition

CONSENT, LATER = "ab" * 32, "cd" * 32  # texts
NO_DEVICE = [""] * 6
"""Columns of a check of the device, which was not made yet."""
DEVICES = "gamepad Pad (a: 1);pointer touch;keyboard"


def a_drive(number: int, order: int, condition: str, task: str) -> DriveRecord:
    rest = tuple((0.0,) * BINS for _ in range(BINS))
    trace = Trace(number, condition, task, 0, 0, False, (0.0,), ((0.0, 0.0, 0.0),), (), rest)
    measures = {"success_rate": 0.0, "steps_done": 0.0, "time_s": 1.0}
    return DriveRecord(
        people_are="real", person=number, condition=condition, order=order, task=task, trial=0, choice=0,
        attempt=0, ending="time_limit", measures=measures, trace=trace,
        input_s={"gamepad Pad (a: 1)": 3.0, "pointer touch": 2.0 + order, "keyboard": 0.1},
    )  # fmt: skip


@pytest.fixture
def planned(tmp_path: Path) -> Path:
    """A study of four people with two trials of 20 s."""
    document: dict[str, Any] = definition(MODES, TWIST)
    task = {**document["tasks"][0], "trials": 2, "trial_s": 20.0}
    path = tmp_path / "two_ways.json"
    path.write_text(json.dumps({**document, "people": 4, "tasks": [task], "questionnaire": []}))
    return path


@pytest.fixture
def served(planned: Path, tmp_path: Path) -> Path:
    """That study, served with the preset smoke: one person has finished, and one was away for too long."""
    study, folder = read_definition(planned), tmp_path / "try"
    folder.mkdir()
    about = {"definition": study.digest, "people_are": "real", "preset": {"name": "smoke"}, "seed": 0}
    write_json(folder / "config.json", {"study": study.study, **about})
    write_json(folder / "definition.json", {"digest": study.digest, **study.as_json()})
    store = Store(folder / "study.sqlite", away_s=10.0)
    store.open_places(4)
    for link, digest, day in (("gone", CONSENT, "2026-01-02"), ("stays", LATER, "2026-01-03")):
        key = store.arrive(link, "visit", 0.0)
        assert key is not None
        store.consent(key, digest, f"{day}T10:00:00+00:00")
        assert store.place(key, 0.0 if link == "gone" else 100.0) == 0
        store.practised(key, 1 if link == "gone" else 2)
        conditions = ("Modes",) if link == "gone" else ("Retargeting", "Modes")
        for order, condition in enumerate(conditions):
            assert store.keep_drive(key, a_drive(0, order, condition, study.tasks[0].name))
    store.finish(key, "CODE")
    store.close()
    return folder


def test_the_report_says_where_a_try_out_differs_from_the_plan(planned: Path, served: Path) -> None:
    plan = planned.parent / "plan.json"
    assert main(["study", "preregister", str(planned), "--out", str(plan)]) == 0
    assert main(["study", "analyse", str(served), "--preregistered", str(plan)]) == 0
    page = (served.parent / "try-analysis" / "results.md").read_text()
    lines = page.split("from the preregistration")[1].split("###")[0].strip().splitlines()
    written = json.loads(plan.read_text())["written"]
    assert lines == [
        "- The preset was smoke, which makes everything smaller than the definition says.",
        "- People: 4 planned, 1 took part.",
        "- Marshmallows, trials in each condition: 2 planned, 1 driven.",
        "- Marshmallows, longest trial: 20 s planned, 1 s driven.",
        f"- The preregistration was written at {written}, not before the first consent at"
        " 2026-01-02T10:00:00+00:00.",
    ]


def test_the_report_says_what_people_did(served: Path) -> None:
    assert main(["study", "analyse", str(served)]) == 0
    page = (served.parent / "try-analysis" / "results.md").read_text()
    assert "Input: each person's own choice on the page" in page
    assert "one stick" not in page
    assert "Practice: up to 5 minutes at Marshmallows, before the first condition only." in page
    assert "| 0 | Retargeting, Modes | gamepad Pad (a: 1), pointer touch, keyboard |" in page
    assert "2 consented (2026-01-02 to 2026-01-03; text abababababab, cdcdcdcdcdcd), and 1 of them" in page


def test_practice_and_input_of_people_who_were_not_served_are_as_planned() -> None:
    study = Recorded(load_definition("eating"), "real", (), (), (), PRESETS["paper"])
    assert practice_words(study) == "planned for up to 5 minutes before each condition"
    assert input_words(study) == "planned: one stick with two axes"
    simulated = replace(study, people_are="simulated")
    assert practice_words(simulated) == "5 minutes, before each condition at each task"
    assert input_words(simulated) == "one stick with two axes"


def test_the_dataset_has_everybody_who_consented_and_only_drives_of_people_who_finished(served: Path) -> None:
    assert main(["study", "export", str(served)]) == 0
    data = served.parent / "try-dataset" / "data"
    people, drives = (
        list(csv.DictReader((data / f"study-TwoWays_description-{name}_data.csv").read_text().splitlines()))
        for name in ("people", "drives")
    )
    assert [list(one.values()) for one in people] == [
        ["0", "Retargeting;Modes", LATER, "2026-01-03", *NO_DEVICE, "0", "2", DEVICES, "1"],
        ["", "Modes", CONSENT, "2026-01-02", *NO_DEVICE, "0", "1", DEVICES, "0"],
    ]
    # The place of the person who was away is that of the one who finished: their drives do not mix.
    assert [(one["person"], one["condition"]) for one in drives] == [("0", "Retargeting"), ("0", "Modes")]
    assert [one["devices"] for one in drives] == [DEVICES] * 2
    codebook = (data.parent / "documentation" / "codebook.csv").read_text()
    assert '\ndevices,"input devices that were pushed' in codebook


def test_progress_says_where_everybody_is_and_how_their_drives_went(
    served: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    store = Store(served / "study.sqlite")
    key = store.arrive("new", "visit", 200.0)
    assert key is not None
    store.consent(key, CONSENT, "2026-01-04T10:00:00+00:00")
    store.place(key, 200.0)
    store.close()
    assert main(["study", "progress", str(served), "--json"]) == 0
    people = json.loads(capsys.readouterr().out)
    assert [(one["due"], one["place"], one["way"], one["drives"]) for one in people] == [
        ("device", 1, None, 0),
        ("finished", 0, None, 2),
        ("lapsed", None, None, 1),
    ]
    assert people[0]["last_there"] == "1970-01-01 00:03"
    assert main(["study", "progress", str(served)]) == 0
    assert "4 places; device: 1, finished: 1, lapsed: 1." in capsys.readouterr().out
