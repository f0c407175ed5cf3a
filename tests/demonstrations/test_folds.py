import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from latentarm.core.errors import UserError
from latentarm.demonstrations.split import make_folds


@given(st.integers(2, 40), st.integers(2, 8), st.integers(0, 99))
def test_every_episode_is_held_out_once_and_never_trained_on_then(
    episodes: int, count: int, seed: int
) -> None:
    if episodes < count:
        return
    folds = make_folds(episodes, count, np.random.default_rng(seed))
    assert sorted(index for fold in folds for index in fold.held_out) == list(range(episodes))
    for fold in folds:
        fitted = {*fold.training, *fold.validation}
        assert sorted([*fitted, *fold.held_out]) == list(range(episodes))


def test_fifteen_episodes_are_three_held_out_two_that_stop_and_ten_that_train() -> None:
    for fold in make_folds(15, 5, np.random.default_rng(0)):
        assert (len(fold.held_out), len(fold.validation), len(fold.training)) == (3, 2, 10)
        assert not set(fold.validation) & set(fold.training)


@pytest.mark.parametrize(("count", "validation", "training"), [(12, 2, 10), (6, 1, 5), (3, 1, 2)])
def test_fewer_demonstrations_are_some_of_the_more(count: int, validation: int, training: int) -> None:
    whole = make_folds(15, 5, np.random.default_rng(0))[1]
    fewer = whole.with_only(count)
    assert (len(fewer.validation), len(fewer.training)) == (validation, training)
    assert set(fewer.others) <= set(whole.others)
    assert fewer.held_out == whole.held_out


def test_a_single_demonstration_trains_and_stops() -> None:
    only = make_folds(15, 5, np.random.default_rng(0))[0].with_only(1)
    assert only.training == only.validation == only.others


def test_fewer_episodes_than_folds_are_refused() -> None:
    with pytest.raises(UserError, match="4 episodes, fewer than the 5 folds"):
        make_folds(4, 5, np.random.default_rng(0))
