"""`latentarm drive`: who gives inputs, one row per drive, and what is not overwritten."""

import csv
import json
from dataclasses import replace
from pathlib import Path

import pytest

from latentarm.core.errors import UserError
from latentarm_research.commands.drive_options import ControllerName, DriveOptions
from latentarm_research.commands.drive_run import drive_run
from latentarm_research.drives.drive_table import COLUMNS, endings_in_words
from latentarm_research.people.catalogue import PEOPLE, OperatorName, usual_operator


def config(out: Path, **others: object) -> DriveOptions:
    usual = DriveOptions(
        run=None, controller="end_effector", out=out, robot="planar", drives=1, time_limit_s=0.5, jobs=1
    )
    return replace(usual, **others)


def test_one_row_for_each_drive_in_json_and_csv(tmp_path: Path) -> None:
    driven = drive_run(config(tmp_path / "out"))
    document = json.loads((tmp_path / "out/drives.json").read_text())
    assert document["drives"] == driven.entries
    with (tmp_path / "out/drives.csv").open() as stream:
        lines = list(csv.DictReader(stream))
    assert list(lines[0]) == list(COLUMNS)
    for line, entry in zip(lines, driven.entries, strict=True):
        assert list(entry) == list(COLUMNS)
        assert float(line["time_s"]) == entry["time_s"]
        assert line["success"] == str(entry["success"]).lower()
    rate = next(row.mean for row in driven.rows if row.measure == "success_rate")
    assert rate == pytest.approx(sum(bool(entry["success"]) for entry in driven.entries) / len(lines))
    assert sum(int(said.split()[0]) for said in endings_in_words(driven.entries)) == len(lines)


def test_another_drive_is_not_overwritten_and_the_same_is_repeated(tmp_path: Path) -> None:
    out = tmp_path / "out"
    first = drive_run(config(out))
    before = (out / "drives.csv").read_bytes()
    with pytest.raises(UserError, match=r"seed 0 there, 1 now.*out-2"):
        drive_run(config(out, seed=1))
    assert (out / "drives.csv").read_bytes() == before
    assert drive_run(config(out)) == first


@pytest.mark.parametrize("controller", ["two_sticks", "retargeting"])
def test_published_help_goes_with_any_controller(tmp_path: Path, controller: ControllerName) -> None:
    out = tmp_path / "out"
    driven = drive_run(config(out, controller=controller, assistance="hindsight", time_limit_s=0.1))
    assert {entry["controller"] for entry in driven.entries} == {controller}
    about = json.loads((out / "config.json").read_text())
    assert (about["assistance"], about["belief"], about["alpha"]) == ("hindsight", "hindsight", None)


def test_a_recording_has_the_same_rows(tmp_path: Path) -> None:
    recorded = drive_run(config(tmp_path / "one", record=tmp_path / "driven"))
    assert recorded == drive_run(config(tmp_path / "two"))


def test_the_operator_plans_where_goals_are_held_out_episodes() -> None:
    assert PEOPLE[usual_operator("held_out")].plans is not None
    assert PEOPLE[usual_operator("table_top")].plans is PEOPLE[usual_operator("reach")].plans is None


@pytest.mark.parametrize("name", PEOPLE)
def test_everybody_in_the_catalogue_drives_and_is_named(tmp_path: Path, name: OperatorName) -> None:
    driven = drive_run(config(tmp_path, operator=name, drives=1, time_limit_s=0.3))
    assert {entry["operator"] for entry in driven.entries} == {name}
    assert name in COLUMNS["operator"]
