import json
from dataclasses import replace
from pathlib import Path

import pytest

from latentarm.errors import UserError
from latentarm.metrics.results import read_results
from latentarm.models.catalogue import MODELS
from latentarm.parallel.grid import CellError
from latentarm.runs.results_folder import CONFIG
from latentarm.studies.properties import run as study
from latentarm.studies.properties.cell import measure_cell
from latentarm.studies.properties.preset import PRESETS, Preset
from latentarm.studies.properties.run import MADE, PropertiesConfig, run_properties

TINY = Preset(
    "tiny",
    episodes=4,
    test_episodes=2,
    seeds=2,
    epochs=1,
    hidden=(8,),
    reach_pairs=3,
    reach_goals=2,
    states=5,
    grid=5,
    noises_rad=(0.0, 0.1),
)
TASK = "reach"
SAME_EVERYWHERE = ("results.json", "results.md", "seeds.json", "hypotheses.json")


def tiny(out: Path, **changes) -> PropertiesConfig:
    return replace(PropertiesConfig(out, TINY, (TASK,), jobs=1, quiet=True), **changes)


@pytest.fixture(scope="module")
def done(tmp_path_factory):
    """A run on this process alone: its rows and its folder."""
    out = tmp_path_factory.mktemp("alone") / "run"
    return run_properties(tiny(out)), out


def test_every_model_has_its_figures_with_and_without_noise(done):
    rows, out = done
    assert read_results(out / "results.json") == rows
    assert {row.model for row in rows} == set(MODELS)
    assert {row.condition for row in rows} == {None, "noise 0 rad", "noise 0.1 rad"}
    main = {row.measure for row in rows if row.condition is None}
    swept = {row.measure for row in rows if row.condition is not None}
    assert {"error_percent_of_pca", "r2", "drift", "reversal", "final_distance"} <= main
    assert {"error_percent_of_pca", "r2", "drift", "reversal"} <= swept
    assert "final_distance" not in swept
    assert all(row.study == "properties" and row.task == TASK for row in rows)


def test_the_sweep_begins_with_the_figures_without_noise(done):
    rows, _ = done
    at = {(row.model, row.measure, row.condition): row.mean for row in rows}
    for (model, measure, condition), mean in at.items():
        if condition == "noise 0 rad":
            assert mean == at[model, measure, None]


def test_the_paper_stands_beside_what_it_prints(done):
    rows, _ = done
    assert any(row.paper_mean is not None for row in rows)
    assert all(row.paper_mean is None for row in rows if row.condition is not None)


def test_the_folder_holds_what_is_promised(done):
    _, out = done
    made = {path.name for path in out.iterdir()}
    assert {"reach.png", "noise.png", "results.md", "results.json", "timings.json", CONFIG} <= made
    assert made <= {CONFIG, *MADE}
    assert json.loads((out / CONFIG).read_text())["preset"]["name"] == "tiny"
    values = json.loads((out / "seeds.json").read_text())
    assert {len(entry["values"]) for entry in values} == {1, TINY.seeds}


@pytest.mark.parametrize(("backend", "jobs"), [("joblib", 2), ("dask", 2), ("ray", 2)])
def test_the_same_bytes_wherever_the_cells_run(done, tmp_path, backend, jobs):
    run_properties(tiny(tmp_path, backend=backend, jobs=jobs))
    for name in SAME_EVERYWHERE:
        assert (tmp_path / name).read_bytes() == (done[1] / name).read_bytes(), name


def test_an_earlier_run_makes_room_and_nothing_of_it_stays(done, tmp_path, monkeypatch):
    out = tmp_path / "run"
    out.mkdir()
    (out / CONFIG).write_bytes((done[1] / CONFIG).read_bytes())
    (out / "results.json").write_text("of the earlier run")
    (out / "sine.png").write_text("of the earlier run")
    (out / "notes.txt").write_text("mine")
    monkeypatch.setattr(study, "measure_cell", _faulty)
    with pytest.raises(CellError):
        run_properties(tiny(out))
    assert {path.name for path in out.iterdir()} == {CONFIG, "notes.txt"}


@pytest.mark.parametrize("content", ["{}", "[]", "no JSON", '{"study": "another"}'])
def test_a_folder_of_something_else_is_left_alone(tmp_path, content):
    (tmp_path / CONFIG).write_text(content)
    with pytest.raises(UserError, match="no earlier run of this command"):
        run_properties(tiny(tmp_path))
    assert [path.name for path in tmp_path.iterdir()] == [CONFIG]
    assert (tmp_path / CONFIG).read_text() == content


def test_a_file_is_no_folder(tmp_path):
    (tmp_path / "file").write_text("mine")
    for out in (tmp_path / "file", tmp_path / "file" / "under"):
        with pytest.raises(UserError, match="file"):
            run_properties(tiny(out))
    assert (tmp_path / "file").read_text() == "mine"


def test_a_disk_that_cannot_be_written_is_said_before_any_work(tmp_path, monkeypatch):
    def full(*_, **__):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr("latentarm.files.tempfile.mkstemp", full)
    monkeypatch.setattr(study, "run_grid", lambda *_, **__: pytest.fail("worked for nothing"))
    with pytest.raises(UserError, match="No space left"):
        run_properties(tiny(tmp_path))


def _faulty(cell):
    if (cell.model, cell.noise_rad) == ("ae", 0.1):
        raise ZeroDivisionError("no way")
    return measure_cell(cell)


def test_a_cell_that_fails_names_itself(tmp_path, monkeypatch):
    monkeypatch.setattr(study, "measure_cell", _faulty)
    with pytest.raises(CellError, match=r"reach, ae, noise 0\.1 rad[\s\S]*no way"):
        run_properties(tiny(tmp_path))
    assert not (tmp_path / "results.json").exists()


def test_sizes_that_make_no_sense_name_the_cell(tmp_path):
    with pytest.raises(UserError, match=r"reach, pca, noise 0 rad: .*demonstration"):
        run_properties(tiny(tmp_path, preset=replace(TINY, episodes=0)))


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        ({"tasks": ("sine", "square")}, "square.*sine, rotate, circle, reach"),
        ({"tasks": ()}, "at least one task"),
        ({"tasks": ("sine", "sine")}, "twice"),
        ({"seed": -1}, "seed"),
        ({"jobs": 0}, "jobs"),
        ({"backend": "slurm"}, "slurm"),
    ],
)
def test_refused_before_anything_is_written(tmp_path, changes, said):
    with pytest.raises(UserError, match=said):
        tiny(tmp_path / "run", **changes)


def test_presets_have_the_paper_s_setting_and_their_own_names():
    assert {name: preset.name for name, preset in PRESETS.items()} == {name: name for name in PRESETS}
    assert all(preset.noises_rad[0] == 0.0 for preset in PRESETS.values())
