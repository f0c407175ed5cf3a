import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from latentarm.core.types import Row
from latentarm.demonstrations.importers.importing import import_to
from latentarm.robots.catalogue import load_robot
from latentarm_research.studies.compare.preset import Preset
from latentarm_research.studies.compare.study import compare_study
from latentarm_research.studies.page import PDF
from latentarm_research.studies.results_folder import CONFIG
from latentarm_research.studies.study import ALWAYS_MADE, Report, Request, run_study

POUR = Path(__file__).parents[5] / "shared" / "demonstrations" / "panda_pour_coffee.npz"


def compared(table: Path, sizes: Preset, out: Path) -> Report:
    study = compare_study((table,), sizes)
    report = run_study(study, Request(out, sizes, jobs=1, quiet=True))
    made = {*ALWAYS_MADE, *study.documents} - {PDF}
    assert {path.name for path in out.iterdir()} == {
        CONFIG,
        *made,
        *(f"{name}.png" for name in report.figures),
    }
    return report


@pytest.fixture(scope="module")
def done(table: Path, tiny: Preset, tmp_path_factory: pytest.TempPathFactory) -> tuple[list[Row], Path]:
    out = tmp_path_factory.mktemp("compared") / "run"
    return compared(table, tiny, out).rows, out


def test_the_folder_holds_what_is_promised(done: tuple[list[Row], Path]) -> None:
    rows, out = done
    assert json.loads((out / "results.json").read_text())["rows"] == [row.as_json() for row in rows]
    held_out = json.loads((out / CONFIG).read_text())["held_out"]["table"]
    assert sorted(index for fold in held_out for index in fold) == list(range(5))


def test_every_model_has_every_measure_under_every_noise(done: tuple[list[Row], Path]) -> None:
    rows, _ = done
    for noise in ("noise 0 rad", "noise 0.05 rad"):
        by_model = {
            model: {row.measure for row in rows if (row.model, row.condition) == (model, noise)}
            for model in ("pca", "cae")
        }
        assert by_model["pca"] == by_model["cae"] >= {"reversal", "controllability_m", "motion_turn_p95"}


def test_the_noisy_error_is_the_noise_free_one_without_noise(done: tuple[list[Row], Path]) -> None:
    rows, _ = done
    at = {(row.measure, row.condition): row.mean for row in rows if row.model == "cae"}
    for encoded in ("", "search_"):
        noisy, clean = f"{encoded}error_percent_of_pca", f"{encoded}noise_free_error_percent_of_pca"
        assert at[noisy, "noise 0 rad"] == pytest.approx(at[clean, "noise 0 rad"])
        assert at[noisy, "noise 0.05 rad"] != at[clean, "noise 0.05 rad"]


def test_the_two_ways_of_encoding_are_in_tables_of_their_own(done: tuple[list[Row], Path]) -> None:
    rows, out = done
    at = {(row.model, row.measure): row for row in rows if row.condition == "noise 0 rad"}
    assert at["pca", "error_percent_of_pca"].mean is None
    assert at["pca", "search_error_percent_of_pca"].mean is not None
    assert at["cae", "error_percent_of_pca"].mean is not None
    tables = (out / "results.md").read_text().split("\n\n")
    nearest = [part for part in tables if "| error, nearest input, of PCA's (%) |" in part]
    network = [part for part in tables if "| error, of PCA's (%) | – |" in part]  # a dash for PCA
    assert len(nearest) == len(network) == 2  # noises
    assert not set(nearest) & set(network)


def test_pca_neither_drifts_nor_forgets(done: tuple[list[Row], Path]) -> None:
    rows, _ = done
    for row in rows:
        if row.model == "pca" and row.measure in ("drift", "reversal"):
            assert row.mean == pytest.approx(0.0, abs=1e-9)


def test_the_seeds_are_those_behind_the_table(done: tuple[list[Row], Path], tiny: Preset) -> None:
    rows, out = done
    seeds = [
        entry["values"]
        for entry in json.loads((out / "seeds.json").read_text())
        if (entry["model"], entry["noise_rad"], entry["measure"]) == ("cae", 0.0, "reversal")
        and entry["demonstrations"] > 1
    ]
    assert np.shape(seeds) == (tiny.folds, tiny.seeds)
    (row,) = (
        row for row in rows if (row.model, row.condition, row.measure) == ("cae", "noise 0 rad", "reversal")
    )
    assert row.mean == pytest.approx(np.mean(seeds))
    assert row.sd == pytest.approx(np.mean(seeds, axis=0).std(ddof=1))


def test_drives_are_told_from_measurements_and_called_simulated(done: tuple[list[Row], Path]) -> None:
    rows, out = done
    driven = {row.model for row in rows if row.condition == "noise 0 rad, driven"}
    assert driven == {"cae", "end_effector"}
    page = (out / "results.md").read_text()
    assert "A **simulated** operator follows" in page
    assert "![Turning against error and reach](turning.png)" in page


@pytest.mark.skipif(not POUR.exists(), reason="the recorded demonstrations are not beside this clone")
def test_recorded_demonstrations_are_compared_on(tmp_path: Path, tiny: Preset) -> None:
    import_to(POUR, tmp_path / "pour", load_robot("panda"))
    few = replace(tiny, noises_rad=(0.01,), seeds=1, demonstrations=(), drives=0)
    small = replace(few, models=("pca", "scl"), ours="homogeneous")
    rows = compared(tmp_path / "pour", small, tmp_path / "out").rows
    at = {(row.model, row.measure): row.mean for row in rows if row.condition == "noise 0.01 rad"}
    assert at["pca", "search_error_percent_of_pca"] == pytest.approx(100.0, abs=5.0)
    assert at["scl", "drift"] == pytest.approx(0.0, abs=1e-9)
