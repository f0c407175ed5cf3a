import json
from collections.abc import Callable
from pathlib import Path

import pytest

from latentarm.core.types import Row
from latentarm_research.studies.properties.preset import PRESETS, Preset
from latentarm_research.studies.shared_autonomy.cell import TASKS
from latentarm_research.studies.shared_autonomy.study import STUDY as SHARED_AUTONOMY
from latentarm_research.studies.study import Report
from result_rows import rows_in

Run = Callable[..., tuple[int, str, str]]

TINY = Preset(
    "smoke",
    models=("pca", "vae", "cvae"),
    episodes=4,
    test_episodes=2,
    seeds=2,
    epochs=1,
    hidden=(8,),
    reach_pairs=3,
    reach_goals=2,
    states=5,
    grid=5,
)
PROPERTIES = ("reproduce", "properties", "--preset", "smoke", "--task", "reach", "--jobs", 1)


def test_the_properties_for_people(run: Run, workplace: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(PRESETS, "smoke", TINY)
    code, out, err = run(*PROPERTIES)
    assert code == 0
    assert "reach, simulated" in out
    assert "reproduced/properties/results.md" in out
    assert f"{len(TINY.models)} cells" in err
    assert rows_in(Path("reproduced/properties/results.json"))


@pytest.mark.slow
def test_the_smallest_study_of_shared_autonomy_runs_from_end_to_end(run: Run, workplace: Path) -> None:
    code, out, err = run("reproduce", "shared-autonomy", "--preset", "smoke", "--jobs", 2)
    assert code == 0
    assert "only shows that the study runs" in out
    assert "reproduced/shared-autonomy/results.md" in out
    assert "8 cells" in " ".join(err.split())
    folder = Path("reproduced/shared-autonomy")
    written = rows_in(folder / "results.json")
    assert {row.task for row in written} == set(TASKS)
    assert {path.stem for path in folder.glob("*.png")} == {*SHARED_AUTONOMY.figures}


@pytest.mark.parametrize(("name", "task"), [("shared-autonomy", "planar_two_cups"), ("alignment", "plane")])
def test_one_task_for_machines(
    run: Run, workplace: Path, monkeypatch: pytest.MonkeyPatch, name: str, task: str
) -> None:
    """What is asked for reaches the study, and its rows are printed; tests/studies runs the studies."""
    asked = []
    rows = [Row(name, "drift", "1", 0.5, 0.1, 3, task=task, model="cae")]
    report = Report(rows, "", {})
    monkeypatch.setattr(
        "latentarm_research.studies.study.run_study", lambda study, request: asked.append(request) or report
    )
    folder = Path("reproduced") / name
    folder.mkdir(parents=True)
    options = ("--preset", "smoke", "--task", task, "--seed", 5, "--jobs", 1, "--json")
    code, out, err = run("reproduce", name, *options)
    assert code == 0
    assert json.loads(out) == [row.as_json() for row in rows]
    assert f"{folder}/results.md" in err
    (request,) = asked
    assert (request.out, request.preset.name, request.tasks) == (folder, "smoke", (task,))
    assert (request.seed, request.jobs, request.backend, request.quiet) == (5, 1, "joblib", True)


@pytest.mark.slow
def test_the_smallest_study_of_alignment_runs_from_end_to_end(run: Run, workplace: Path) -> None:
    code, out, err = run("reproduce", "alignment", "--preset", "smoke", "--jobs", 2)
    assert code == 0
    assert "only shows that the study runs" in out
    assert "Decoders: 3 cells" in err
