"""Every measurement runs in its smallest size, and its page can be repeated."""

import json
import re
from collections.abc import Callable
from pathlib import Path

import pytest

from documentation import ROOT
from latentarm_research.measurements import catalogue
from latentarm_research.measurements.calibration import traits
from latentarm_research.measurements.catalogue import MEASUREMENTS, load_measurement
from latentarm_research.measurements.measurement import Outcome, line

Run = Callable[..., tuple[int, str, str]]

ARM = """<mujoco><worldbody><body><joint name="hinge" axis="0 1 0" range="-1 1"/>
<geom size="0.05" pos="0 0 0.4" mass="1"/></body></worldbody></mujoco>"""
LIMITS = """[joints.hinge]
velocity_rad_per_s = 1.0
acceleration_rad_per_s2 = 2.0
jerk_rad_per_s3 = 10.0
"""


def required(name: str, tmp_path: Path) -> list[object]:
    """Options without a default."""
    if name == "torque":
        (model := tmp_path / "arm.xml").write_text(ARM)
        (limits := tmp_path / "limits.toml").write_text(LIMITS)
        return ["--model", model, "--limits", limits]
    return []


SLOW = {"clearance", "zones", "help", "way-back", "calibration", "surroundings", "study-load"}
# Two need a trained run and a Chromium (tests/web/browser/test_fault_times.py), one a log that is not ours,
# one OpenGL.
ELSEWHERE = {"page-stops", "page-latency", "people", "tags"}


# A few demonstrations teach no way back.
@pytest.mark.filterwarnings("ignore:.*to learn a way back")
@pytest.mark.parametrize(
    "name",
    [
        pytest.param(name, marks=pytest.mark.slow) if name in SLOW else name
        for name in MEASUREMENTS
        if name not in ELSEWHERE
    ],
)
def test_every_measurement_runs_and_its_page_names_the_command(
    run: Run, workplace: Path, tmp_path: Path, name: str
) -> None:
    code, out, err = run("measure", name, "--smoke", "--seed", 1, *required(name, tmp_path))
    assert code == 0, err
    folder = Path("measured") / name
    page = (folder / "results.md").read_text(encoding="utf-8")
    assert page in out
    rows = json.loads((folder / "results.json").read_text(encoding="utf-8"))["rows"]
    assert {row["study"] for row in rows} == {name}
    (command,) = re.findall(r"`(latentarm measure .*)`, commit [0-9a-z]+, \d{4}-\d\d-\d\d\.", page)
    assert f" {name} " in command
    assert command.endswith("--seed 1")


@pytest.mark.slow
@pytest.mark.filterwarnings("ignore:.*to learn a way back")
def test_a_measurement_that_was_stopped_goes_on_from_its_finished_runs(run: Run, workplace: Path) -> None:
    smallest = ("measure", "surroundings", "--smoke", "--seed", 1)
    assert run(*smallest)[0] == 0
    folder = Path("measured/surroundings")
    (kept,) = folder.glob("runs/marshmallows/touch/*.json")
    finished = json.loads(kept.read_text("utf-8"))
    kept.write_text(json.dumps({**finished, "stops": 7.0}), "utf-8")
    assert run(*smallest)[0] == 0
    rows = json.loads((folder / "results.json").read_text("utf-8"))["rows"]
    assert [row["mean"] for row in rows if row["measure"] == "stops"] == [7.0]
    assert run("measure", "surroundings", "--smoke", "--seed", 2)[0] == 2


def test_a_broken_limit_is_an_exit_code(run: Run, workplace: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    rows = line("zones", "exact", 3, {"fastest_m_s": 0.2, "time_s": (1.0, 0.5), "gone_mm": None})
    monkeypatch.setattr(
        "latentarm_research.commands.measure.load_measurement",
        lambda name: lambda options, work: Outcome(rows, ["too fast"]),
    )
    code, out, err = run("measure", "zones", "--drives", 7, "--json")
    assert code == 1
    assert json.loads(out) == [row.as_json() for row in rows]
    assert "too fast" in err
    page = Path("measured/zones/results.md").read_text(encoding="utf-8")
    assert "|  | n | fastest (m/s) | time (s) | gone (mm) |" in page
    assert "| exact | 3 | 0.2 | 1.00 ± 0.50 | – |" in page
    assert "**Limit broken**: too fast" in page
    assert "`latentarm measure zones --drives 7 --seed 0`" in page


@pytest.mark.parametrize(
    "given", [("--people", 0), ("--people", 2, -1), ("--seconds", "nan"), ("--seconds", 1e9)]
)
def test_nobody_can_drive_by_impossible_numbers(run: Run, workplace: Path, given: tuple[object, ...]) -> None:
    code, _, err = run("measure", "study-load", *given)
    assert (code, err.strip()) == (2, "latentarm: --people must be 1 or more, and --seconds from 1 to 240.")


def test_the_catalogue_has_every_module_with_a_measurement() -> None:
    folder = Path(catalogue.__file__).parent
    modules = {path.stem for path in folder.glob("*.py") if "\ndef measure(" in path.read_text("utf-8")}
    assert modules == {name.replace("-", "_") for name in MEASUREMENTS}
    assert all(callable(load_measurement(name)) for name in MEASUREMENTS if name not in ELSEWHERE)


def test_the_evidence_has_the_traits_that_simulated_people_have() -> None:
    assert traits() in (ROOT / "docs/evidence/simulated_people.md").read_text(encoding="utf-8")
