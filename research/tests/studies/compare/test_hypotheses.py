import numpy as np

from latentarm_research.studies.compare.cell import FoldResult, Place
from latentarm_research.studies.compare.hypotheses import ENCODINGS, compared, h1_sentences


def cells(model: str, errors: tuple[float, ...]) -> list[FoldResult]:
    """A cell per fold, with two seeds about each error."""
    return [
        FoldResult(
            Place("pour", 0.01, model, fold, 12),
            {measure: np.array([error - 1.0, error + 1.0]) for measure in ENCODINGS},
            None,  # type: ignore[arg-type]
        )
        for fold, error in enumerate(errors)
    ]


BLIND = cells("ae", (42.0, 40.0, 45.0, 41.0))


def test_each_way_of_encoding_is_tested_paired_over_folds() -> None:
    # Folds out of order, as a grid may return them.
    tests = compared([*BLIND, *reversed(cells("cae", (30.0, 29.0, 35.0, 28.0)))])
    assert [one.family for one in tests] == ["encoder network", "nearest input"]
    assert [(one.mean, one.mean_against, one.n) for one in tests] == [(30.5, 42.0, 4)] * 2
    assert all((one.says, one.method) == ("held", "paired t") for one in tests)
    assert all(
        "lower mean error in 1 of 1 comparisons, significantly in 1" in one for one in h1_sentences(tests)
    )
    assert all(one.endswith("H1 is supported.") for one in h1_sentences(tests))


def test_a_context_that_does_not_help_is_said_plainly() -> None:
    tests = compared([*BLIND, *cells("cae", (50.0, 47.0, 52.0, 49.0))])
    assert {one.says for one in tests} == {"not held"}
    assert all("in 0 of 1 comparisons" in one and "not supported" in one for one in h1_sentences(tests))


def test_without_both_models_nothing_is_tested() -> None:
    assert compared(BLIND) == []
