import pytest

from latentarm.core.types import Row
from latentarm.models.estimators import MODELS
from latentarm_research.studies.properties.paper import LENGTHS, MODELS_OF_THE_PAPER, PAPER, with_paper
from latentarm_research.tasks.planar.catalogue import MOTIONS


def row(task, model, measure, mean=1.0, unit="%"):
    return Row("properties", measure, unit, mean, 0.1, 10, task=task, model=model)


def test_every_figure_is_of_a_task_and_a_model_of_ours():
    for task, model, _ in (*PAPER, *LENGTHS):
        assert task in MOTIONS
        assert model in MODELS
    assert MODELS_OF_THE_PAPER == ("pca", "ae", "vae", "cae", "cvae")


@pytest.mark.parametrize(
    ("key", "printed"),
    [
        (("sine", "cae", "median_error_percent_of_pca"), (1.37, 1.2)),
        (("sine", "pca", "r2"), (0.99, None)),
        (("rotate", "vae", "median_controllability_percent_of_pca"), (71.5, 8.0)),
        (("circle", "cvae", "disentanglement_deg"), (74.0, 12.0)),
    ],
)
def test_figures_are_the_papers(key, printed):
    assert PAPER[key] == printed


def test_lengths_without_a_unit_are_compared_as_ratios_only():
    assert not PAPER.keys() & LENGTHS.keys()
    for key, mean, sd in (
        (("sine", "cvae", "median_controllability_percent_of_pca"), 0.10 / 0.90, 0.01 / 0.90),
        (("reach", "cvae", "final_distance_percent_of_vae"), 0.48 / 0.57, 0.5 / 0.57),
        (("reach", "cvae", "path_length_percent_of_vae"), 3.1 / 5.1, 0.5 / 5.1),
    ):
        assert PAPER[key] == pytest.approx((100 * mean, 100 * sd))
    (length,) = with_paper([row("sine", "cae", "controllability_m", unit="m")])
    assert length.paper_mean is None


def test_the_papers_figures_stand_beside_ours():
    beside, without = with_paper(
        [row("sine", "cae", "median_error_percent_of_pca"), row("sine", "scl", "median_error_percent_of_pca")]
    )
    assert (beside.mean, beside.sd) == (1.0, 0.1)
    assert (beside.paper_mean, beside.paper_sd) == (1.37, 1.2)
    assert (without.paper_mean, without.paper_sd) == (None, None)


def test_our_lengths_on_reach_become_ratios_too():
    lengths = [
        row("reach", model, "final_distance", mean, unit="m")
        for model, mean in {"vae": 0.2, "cvae": 0.1, "scl": 0.05}.items()
    ]
    ratios = with_paper(lengths)[3:]
    assert [(one.model, one.measure, one.unit, one.sd) for one in ratios] == [
        (model, "final_distance_percent_of_vae", "%", None) for model in ("vae", "cvae", "scl")
    ]
    assert [one.mean for one in ratios] == pytest.approx([100.0, 50.0, 25.0])
    assert [one.paper_mean for one in ratios] == [100.0, pytest.approx(84.2, abs=0.05), None]


def test_no_ratio_to_nothing():
    assert len(with_paper([row("reach", "cvae", "final_distance", unit="m")])) == 1
    still = [row("reach", "vae", "path_length", 0.0), row("reach", "cvae", "path_length", 1.0)]
    assert with_paper(still) == still
