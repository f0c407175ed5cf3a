import os
import pickle
import subprocess
import sys
from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from latentarm.evaluation.measures import MEASURES
from latentarm_research.studies.properties.cell import PropertiesCell, demonstrated, measure_cell
from latentarm_research.studies.properties.preset import Preset
from latentarm_research.tasks.planar.catalogue import MOTIONS

TINY = Preset(
    "tiny",
    episodes=4,
    test_episodes=2,
    seeds=2,
    epochs=2,
    hidden=(8,),
    reach_pairs=4,
    reach_goals=2,
    states=5,
    grid=5,
)

ALWAYS = {
    "error_percent_of_pca",
    "median_error_percent_of_pca",
    "r2",
    "drift",
    "reversal",
}
CONTROL = {
    "controllability_m",
    "controllability_percent_of_pca",
    "median_controllability_percent_of_pca",
    "start_distance_m",
}
OF_TASK = {
    "sine": CONTROL,
    "rotate": CONTROL,
    "circle": CONTROL | {"disentanglement_deg"},
    "reach": {"final_distance", "path_length", "path_over_straight", "start_distance_m"},
}


def cell(task="sine", model="cae", seed=0):
    return PropertiesCell(task, model, TINY, seed)


measured = cache(measure_cell)
"""Several tests look at the same cell."""


def assert_same(first, second):
    assert list(first.figures) == list(second.figures)
    for name, values in first.figures.items():
        np.testing.assert_array_equal(values, second.figures[name])


@pytest.mark.parametrize("task", MOTIONS)
def test_every_task_has_its_measures_one_figure_a_seed(task):
    figures = measured(cell(task)).figures
    assert set(figures) == ALWAYS | OF_TASK[task]
    assert set(figures) <= set(MEASURES)
    for name, values in figures.items():
        assert values.shape == (TINY.seeds,)
        if task != "circle" or "controllability_percent" not in name:
            assert np.isfinite(values).all()


@pytest.mark.parametrize("model", TINY.models)
def test_every_model_can_be_measured(model):
    result = measured(cell("circle", model))
    assert result.decoder.kind == model
    assert len(result.figures["error_percent_of_pca"]) == TINY.seeds


def test_pca_is_its_own_hundred_percent():
    figures = measured(cell("rotate", "pca")).figures
    for name in figures:
        if name.endswith("percent_of_pca"):
            np.testing.assert_allclose(figures[name], [100.0, 100.0])


def test_demonstrations_are_the_same_for_every_model_and_others_for_another_seed():
    starts = [
        measured(asked).figures["start_distance_m"].tolist()
        for asked in (cell(), cell(model="pca"), cell(seed=1))
    ]
    assert starts[0] == starts[1] != starts[2]


def test_every_seed_has_demonstrations_of_its_own():
    first, second = measured(cell(model="pca")).figures["start_distance_m"]
    assert first != second
    sizes = TINY.episodes, TINY.test_episodes
    one, other = demonstrated("sine", sizes, 2, 0)
    for training, test in (one, other):
        assert len(training.episodes) == TINY.episodes
        assert len(test.episodes) == TINY.test_episodes
    assert not np.array_equal(one[0].episodes[0].state, other[0].episodes[0].state)
    assert not np.array_equal(one[0].episodes[0].state, one[1].episodes[0].state)


def test_the_same_cell_gives_the_same_bits_in_another_process_with_more_threads(tmp_path):
    here, there = measure_cell(cell("rotate", "cvae")), tmp_path / "there"
    program = (
        "import pickle, sys; from pathlib import Path\n"
        "from latentarm_research.studies.properties.cell import measure_cell\n"
        "asked = pickle.loads(Path(sys.argv[1]).read_bytes())\n"
        "Path(sys.argv[1]).write_bytes(pickle.dumps(measure_cell(asked)))\n"
    )
    there.write_bytes(pickle.dumps(here.cell))
    more = {**os.environ, "OMP_NUM_THREADS": "2", "OPENBLAS_NUM_THREADS": "2"}
    subprocess.run([sys.executable, "-c", program, str(there)], check=True, env=more, timeout=120)
    back = pickle.loads(there.read_bytes())  # noqa: S301, our own
    assert back.cell == here.cell
    assert_same(here, back)
    z, context = np.full((3, 1), 0.5), np.zeros((3, 10))
    np.testing.assert_array_equal(back.decoder.decode(z, context), here.decoder.decode(z, context))


def test_figures_of_a_seed_do_not_hang_on_how_many_pairs_are_driven():
    few = measured(cell()).figures
    asked = replace(cell(), preset=replace(TINY, reach_pairs=5))
    many = measure_cell(asked).figures
    np.testing.assert_array_equal(few["r2"], many["r2"])
    assert (few["start_distance_m"] != many["start_distance_m"]).all()
