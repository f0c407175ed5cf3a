"""The folder of results, statistics, streams of randomness and parts of pages, which all studies use."""

import json

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from latentarm.core.errors import UserError
from latentarm.runs.results_folder import write_json
from latentarm_research.studies.results_folder import CONFIG, ResultsFolder
from latentarm_research.studies.statistics import compare_means, format_p, holm, one_sample, spreads
from latentarm_research.studies.streams import integer, sequence
from latentarm_research.studies.tables import listed, markdown_table

STUDY = ResultsFolder("tides", ("tides.png",))


def test_a_folder_says_what_was_asked_for_and_with_what(tmp_path):
    STUDY.claim(tmp_path / "new", {"study": "tides", "moons": 1})
    config = json.loads((tmp_path / "new" / CONFIG).read_text())
    assert config["moons"] == 1
    assert {"python", "latentarm", "torch"} <= config["versions"].keys()


def test_an_earlier_run_makes_room_and_another_study_stays(tmp_path):
    STUDY.claim(tmp_path, {"study": "tides"})
    (tmp_path / "tides.png").touch()
    (tmp_path / "mine.txt").touch()
    STUDY.claim(tmp_path, {"study": "tides"})
    assert {path.name for path in tmp_path.iterdir()} == {CONFIG, "mine.txt"}
    with pytest.raises(UserError, match="not an earlier run of this command"):
        ResultsFolder("winds", ("tides.png",)).claim(tmp_path, {"study": "winds"})


def test_the_results_of_another_run_are_not_replaced(tmp_path):
    out = tmp_path / "tides"
    STUDY.claim(out, {"study": "tides", "moons": 1, "tasks": ("sea",)})
    (out / "tides.png").write_text("earlier")
    (tmp_path / "tides-2").mkdir()
    with pytest.raises(UserError, match=r"moons 1 there, 2 now.*tides-3"):
        STUDY.claim(out, {"study": "tides", "moons": 2, "tasks": ("sea",)})
    assert (out / "tides.png").read_text() == "earlier"
    STUDY.claim(out, {"study": "tides", "moons": 1, "tasks": ("sea",)})


def test_a_run_that_was_cut_off_before_it_had_results_makes_room(tmp_path):
    STUDY.claim(tmp_path, {"study": "tides", "moons": 1})
    STUDY.claim(tmp_path, {"study": "tides", "moons": 2})
    assert json.loads((tmp_path / CONFIG).read_text())["moons"] == 2


def test_a_figure_that_is_no_number_is_not_written(tmp_path):
    with pytest.raises(ValueError, match="JSON"):
        write_json(tmp_path / "file.json", {"mean": float("nan")})
    assert not list(tmp_path.iterdir())


@settings(max_examples=30)
@given(st.lists(st.one_of(st.none(), st.floats(0.0, 1.0)), max_size=8))
def test_holm_by_its_definition(p):
    tested = sorted(one for one in p if one is not None)
    stepped = np.maximum.accumulate([(len(tested) - rank) * one for rank, one in enumerate(tested)])
    expected = {one: min(float(after), 1.0) for one, after in reversed([*zip(tested, stepped, strict=True)])}
    for before, after in zip(p, holm(p), strict=True):
        assert after is None if before is None else after == pytest.approx(expected[before], abs=1e-12)


def test_rounding_is_no_spread():
    assert spreads(np.array([1.0, 2.0]))
    assert not spreads(np.array([1.0]))
    assert not spreads(np.array([1.0, 1.0 + 1e-12]))
    assert not spreads(np.zeros(3))


def test_small_p_are_not_zero():
    assert [format_p(p) for p in (None, 0.0, 0.0004, 0.0312)] == ["not tested", "< 0.001", "< 0.001", "0.031"]


def test_streams_hang_on_seed_task_and_use_alone():
    drawn = [sequence(*place).generate_state(2).tolist() for place in ((0, "a", 1), (0, "a", 2), (0, "b", 1))]
    assert drawn[0] == sequence(0, "a", 1).generate_state(2).tolist()
    assert len({tuple(one) for one in drawn}) == 3
    assert 0 <= integer(sequence(3, "a", 1)) < 2**30


def test_parts_of_a_page():
    assert markdown_table(["a", "b"], [["1", "2"]]) == "| a | b |\n| --- | ---: |\n| 1 | 2 |\n"
    assert [listed(names) for names in (["a"], ["a", "b", "a"], ["a", "b", "c"])] == [
        "a",
        "a and b",
        "a, b and c",
    ]


def test_welch_by_hand():
    found = compare_means(np.array([1.0, 2.0, 3.0]), np.array([4.0, 6.0, 8.0, 10.0]), "less")
    # Variances 1 and 20/3: t = -5 / sqrt(1/3 + 5/3); Welch-Satterthwaite; pooled SD sqrt((2 + 20) / 5).
    assert found.method == "Welch's t"
    assert found.test.t == pytest.approx(-5.0 / np.sqrt(2.0))
    assert found.test.dof == pytest.approx(2.0**2 / ((1 / 3) ** 2 / 2 + (5 / 3) ** 2 / 3))
    assert found.test.g == pytest.approx(-5.0 / np.sqrt(22 / 5) * 0.8408, rel=1e-4)
    assert 0.005 < found.p < 0.02  # t(3.8) = -3.54, one-sided


def test_pairs_by_hand():
    found = one_sample(np.array([1.0, 2.0, 3.0]), 0.0, "greater")
    assert found.test.t == pytest.approx(2.0 * np.sqrt(3.0))
    assert found.test.dof == 2
    # The distribution of t with two degrees of freedom has a closed form.
    assert found.p == pytest.approx(0.5 - found.test.t / (2 * np.sqrt(2 + found.test.t**2)))
    assert found.test.g == pytest.approx(2.0 * 0.5642, rel=1e-4)
