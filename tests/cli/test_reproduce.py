import json
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import pytest

from latentarm.metrics.results import read_results
from latentarm.models.catalogue import MODELS
from latentarm.studies.alignment import preset as alignment
from latentarm.studies.properties.preset import PRESETS, Preset
from latentarm.studies.shared_autonomy import preset as shared_autonomy
from latentarm.studies.shared_autonomy.cell import TASKS
from latentarm.studies.shared_autonomy.figures.draw import FIGURES

Run = Callable[..., tuple[int, str, str]]

TINY = Preset(
    "smoke",
    episodes=4,
    test_episodes=2,
    seeds=2,
    epochs=1,
    hidden=(8,),
    reach_pairs=3,
    reach_goals=2,
    states=5,
    grid=5,
    noises_rad=(0.0,),
)
PROPERTIES = ("reproduce", "properties", "--preset", "smoke", "--task", "reach", "--jobs", 1)


def test_the_properties_for_people_and_for_machines(
    run: Run, workplace: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(PRESETS, "smoke", TINY)
    code, out, err = run(*PROPERTIES)
    assert code == 0
    assert "reach, simulated" in out
    assert "reproduced/properties/results.md" in out
    assert f"{len(MODELS)} models on reach" in err
    written = read_results(Path("reproduced/properties/results.json"))

    code, out, err = run(*PROPERTIES, "--json")
    assert code == 0
    assert json.loads(out) == [row.as_json() for row in written]
    assert "results.md" in err


@pytest.mark.slow
def test_the_smallest_study_of_shared_autonomy_runs_from_end_to_end(run: Run, workplace: Path) -> None:
    code, out, err = run("reproduce", "shared-autonomy", "--preset", "smoke", "--jobs", 2)
    assert code == 0
    assert "Panda, 7 joints, cAE, simulated: final state error" in out
    assert "LA+SA+Entropy" in out
    assert "reproduced/shared-autonomy/results.md" in out
    assert "12 cells" in " ".join(err.split())
    folder = Path("reproduced/shared-autonomy")
    written = read_results(folder / "results.json")
    assert {row.task for row in written} == set(TASKS)
    assert {path.stem for path in folder.glob("*.png")} == {*FIGURES} - {"entropy_weight"}


def test_one_task_of_shared_autonomy_for_machines(
    run: Run, workplace: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    tiny = replace(shared_autonomy.PRESETS["smoke"], epochs=1, drives=2, betas=(0.0, 75.0, 1e4))
    monkeypatch.setitem(shared_autonomy.PRESETS, "smoke", tiny)
    words = ("--preset", "smoke", "--task", "planar_two_cups", "--jobs", 1, "--json")
    code, out, err = run("reproduce", "shared-autonomy", *words)
    assert code == 0
    written = read_results(Path("reproduced/shared-autonomy/results.json"))
    assert json.loads(out) == [row.as_json() for row in written]
    assert "results.md" in err


def test_the_alignment_of_one_task_for_machines(
    run: Run, workplace: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    small = alignment.PRESETS["smoke"]
    curves = replace(small.curves, ensemble_steps=2, candidates=6)
    tiny = replace(small, epochs=1, runs=2, steps=2, ideal_steps=2, ideal_answers=20, curves=curves)
    monkeypatch.setitem(alignment.PRESETS, "smoke", tiny)
    words = ("--preset", "smoke", "--task", "plane", "--jobs", 1, "--json")
    code, out, err = run("reproduce", "alignment", *words)
    assert code == 0
    written = read_results(Path("reproduced/alignment/results.json"))
    assert json.loads(out) == [row.as_json() for row in written]
    assert "reproduced/alignment/results.md" in err


@pytest.mark.slow
def test_the_smallest_study_of_alignment_runs_from_end_to_end(run: Run, workplace: Path) -> None:
    code, out, err = run("reproduce", "alignment", "--preset", "smoke", "--jobs", 2)
    assert code == 0
    for words in ("Plane, cAE, simulated", "Ideal Align", "Drives at the table, cVAE, simulated"):
        assert words in out
    assert "Decoders: 9 cells" in err
