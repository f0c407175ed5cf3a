import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from latentarm.evaluation.accuracy import pca_error, reconstruction_error


def test_error_is_the_mean_square_per_joint_and_seed(linear_decoder):
    action = np.array([[1.0, 2.0], [3.0, 4.0]])
    context = np.zeros((2, 2))
    decoders = [linear_decoder(np.eye(2)), linear_decoder(np.eye(2), offset=np.array([0.3, 0.0]))]
    error = reconstruction_error(decoders, np.stack([action, action]), context, action)
    np.testing.assert_allclose(error, [0.0, 0.3**2 / 2], atol=1e-15)


def test_pca_loses_what_lies_off_its_plane():
    rng = np.random.default_rng(0)
    train = rng.normal(size=(500, 3)) * [3.0, 2.0, 0.0] + [0.0, 0.0, 5.0]
    test = np.array([[1.0, 1.0, 5.0], [0.0, 0.0, 5.6]])
    assert pca_error(train, test, latent_dim=2) == pytest.approx(0.6**2 / 6)


def test_pca_agrees_with_scikit_learn():
    from sklearn.decomposition import PCA

    rng = np.random.default_rng(1)
    mix = rng.normal(size=(7, 7))
    train, test = rng.normal(size=(300, 7)) @ mix + 1.0, rng.normal(size=(50, 7)) @ mix
    pca = PCA(2).fit(train)
    expected = np.mean((pca.inverse_transform(pca.transform(test)) - test) ** 2)
    assert pca_error(train, test, latent_dim=2) == pytest.approx(expected)


@given(seed=st.integers(0, 10_000), joints=st.integers(1, 7))
def test_more_components_never_hurt_on_the_training_actions(seed, joints):
    actions = np.random.default_rng(seed).normal(size=(20, joints))
    errors = [pca_error(actions, actions, dim) for dim in range(1, joints + 1)]
    assert np.all(np.diff(errors) <= 1e-12)
    assert errors[-1] == pytest.approx(0.0, abs=1e-12)
