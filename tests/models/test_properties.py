"""What a person who steers would notice of each model."""

import warnings
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from sklearn import decomposition

from latentarm.core.types import Demonstrations, Episode
from latentarm.demonstrations.pairs import make_pairs
from latentarm.demonstrations.split import select_episodes
from latentarm.models.estimators import MODELS
from latentarm.models.scaling import CollapseWarning, action_normaliser, context_normaliser

TRAINED = {"seeds": 2, "epochs": 5, "hidden": (24, 24), "window": 2}
SEES_TOOLS = {name: {"epochs": 3} for name in ("isometric", "homogeneous", "low_turning")}
"""These take five times as long for an epoch, and need fewer."""
VALIDATION = [1, 6, 9]


class Trained(dict):
    """Models by name, each trained when a test first asks for it."""

    def __init__(self, demonstrations):
        super().__init__()
        self._demonstrations = demonstrations

    def __missing__(self, name):
        model = MODELS[name](**{**TRAINED, **SEES_TOOLS.get(name, {})})
        self[name] = model.fit(self._demonstrations, validation=VALIDATION)
        return self[name]


@pytest.fixture(scope="module")
def trained(demonstrations):
    return Trained(demonstrations)


@pytest.fixture(scope="module")
def unseen(demonstrations):
    return make_pairs(select_episodes(demonstrations, VALIDATION), 2, 0.0, "state", np.random.default_rng(0))


def relative_error(model, pairs):
    """Squared reconstruction error as a share of the action's own square, (S,)."""
    rebuilt = model.decode(model.encode(pairs.context, pairs.action), pairs.context)
    return np.square(rebuilt - pairs.action).sum((1, 2)) / np.square(pairs.action).sum()


CONDITIONED = [name for name in MODELS if name not in ("pca", "ae", "vae")]


@pytest.mark.parametrize("name", CONDITIONED)
def test_conditioned_models_rebuild_unseen_actions_far_better_than_pca(trained, unseen, name):
    assert relative_error(trained[name], unseen).max() < 0.5 * relative_error(trained["pca"], unseen).max()


def test_pca_is_scikit_learns(trained, demonstrations, unseen):
    kept = [index for index in range(12) if index not in VALIDATION]
    seen = make_pairs(select_episodes(demonstrations, kept), 2, 0.0, "state", np.random.default_rng(0))
    reference = decomposition.PCA(n_components=2).fit(seen.action)
    expected = reference.inverse_transform(reference.transform(unseen.action))
    model = trained["pca"]
    rebuilt = model.decode(model.encode(unseen.context, unseen.action), unseen.context)
    np.testing.assert_allclose(rebuilt, np.stack([expected, expected]), atol=1e-12)
    at_rest = model.decode(np.zeros((1, 2)), unseen.context[:1])
    np.testing.assert_allclose(at_rest[:, 0], np.stack([reference.mean_] * 2), atol=1e-12)


finite = st.floats(-2, 2, allow_nan=False, width=32)


@settings(max_examples=50)
@given(
    context=arrays(np.float64, (3, 4), elements=finite),
    z=arrays(np.float64, (2, 3, 2), elements=finite),
    weights=st.tuples(finite, finite),
)
def test_scl_is_linear_in_z_in_every_context(trained, context, z, weights):
    decoder = trained["scl"].decoder(1)
    mixed = weights[0] * z[0] + weights[1] * z[1]
    expected = weights[0] * decoder.decode(z[0], context) + weights[1] * decoder.decode(z[1], context)
    np.testing.assert_allclose(decoder.decode(mixed, context), expected, atol=1e-9)
    assert not decoder.decode(np.zeros((3, 2)), context).any()


@settings(max_examples=50)
@given(context=arrays(np.float64, (4,), elements=finite))
def test_the_columns_of_scl_are_orthonormal(trained, context):
    """A Gram-Schmidt that returns its input would pass every other test here."""
    model = trained["scl"]
    scale = model.trained_.tensors["latent.scale"][0] * model.trained_.tensors["action.scale"]
    matrix = model.decoder(0).decode(np.eye(2), context) / scale[:, None]
    np.testing.assert_allclose(matrix @ matrix.T, np.eye(2), atol=1e-6)


@pytest.mark.parametrize("name", ["pca", "scl"])
def test_projections_find_the_latent_action_again(trained, samples, name):
    context, z = samples
    model = trained[name]
    for seed in range(2):
        action = model.decode(z, context)[seed]
        np.testing.assert_allclose(model.encode(context, action)[seed], z, atol=1e-6)


def test_the_zero_penalty_brings_rest_at_zero_input(trained, unseen):
    def drift(model):
        at_rest = model.decode(np.zeros((len(unseen.context), 2)), unseen.context)
        return np.square(at_rest).sum() / np.square(unseen.action).sum()

    assert drift(trained["cae_zero"]) < 0.2 * drift(trained["cae"])


def uneven(model, pairs):
    """What the opposite input leaves of a motion, as a share of the actions' own square."""
    z = model.encode(pairs.context, pairs.action)
    left = model.decode(z, pairs.context) + model.decode(-z, pairs.context)
    return np.square(left).sum() / np.square(pairs.action).sum()


def changing(model, pairs):
    """Mean square of how much the same push changes between states 0.05 rad apart, of the actions' square."""
    z = model.encode(pairs.context, pairs.action)
    aside = 0.05 * np.random.default_rng(0).normal(size=pairs.context.shape)
    change = model.decode(z, pairs.context + aside) - model.decode(z, pairs.context)
    return np.square(change).sum() / np.square(pairs.action).sum()


def test_the_reversal_penalty_makes_the_opposite_input_go_back(trained, unseen):
    assert uneven(trained["cae_reversal"], unseen) < 0.2 * uneven(trained["cae"], unseen)


@pytest.mark.parametrize("name", ["cae", "cvae"])
def test_the_jacobian_penalty_makes_a_push_mean_the_same_nearby(demonstrations, unseen, name):
    free, held = (
        MODELS[f"{name}_jacobian"](**{**TRAINED, "epochs": 3}, jacobian_weight=weight).fit(
            demonstrations, validation=VALIDATION
        )
        for weight in (0.0, 0.3)
    )
    assert changing(held, unseen) < 0.7 * changing(free, unseen)


@settings(max_examples=25)
@given(context=arrays(np.float64, (3, 4), elements=finite), z=arrays(np.float64, (3, 2), elements=finite))
def test_rest_and_reversal_hold_in_every_context(trained, context, z):
    decoder = trained["odd_cae"].decoder(1)
    assert np.abs(decoder.decode(0 * z, context)).max() < 1e-12
    np.testing.assert_allclose(decoder.decode(-z, context), -decoder.decode(z, context), atol=1e-12)


@pytest.mark.parametrize("name", ["ae", "vae", "pca"])
def test_models_without_conditioning_ignore_the_context(trained, samples, name):
    context, z = samples
    np.testing.assert_array_equal(trained[name].decode(z, context), trained[name].decode(z, -context))


def test_state_noise_reaches_the_context_and_never_the_action(demonstrations, trained, unseen):
    noisy = MODELS["pca"](window=2, state_noise_rad=0.3).fit(demonstrations, validation=VALIDATION)
    np.testing.assert_allclose(
        noisy.decode(np.ones((1, 2)), unseen.context[:1]),
        trained["pca"].decode(np.ones((1, 2)), unseen.context[:1])[:1],
        atol=1e-12,
    )


def line(rng):
    """Motion along one straight line of joint space: a second latent dimension has nothing to do."""
    time = np.arange(60) / 20.0
    along = np.sin(rng.uniform(0.5, 1.5) * time + rng.uniform(0, 6))
    return Episode(state=along[:, None] * np.array([1.0, -0.5, 0.2]), timestamp=time)


@pytest.fixture(scope="module")
def straight():
    rng = np.random.default_rng(0)
    return Demonstrations(tuple(line(rng) for _ in range(8)), 20.0, ("a", "b", "c"))


@pytest.mark.parametrize(
    ("name", "weight"), [("pca", {}), ("vae", {"kl_weight": 0.3}), ("cvae", {"kl_weight": 0.3})]
)
def test_a_dimension_with_nothing_to_do_is_said_to_have_collapsed(straight, name, weight):
    with pytest.warns(
        CollapseWarning, match=rf"{name} model has collapsed latent dimensions .*seed 0: z[12]"
    ):
        model = MODELS[name](epochs=25, hidden=(8,), window=1, **weight).fit(straight)
    assert model.collapsed_.sum() == 1


def test_one_dimension_for_one_line_has_not_collapsed(straight):
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        model = MODELS["cvae"](latent_dim=1, epochs=25, hidden=(8,), window=1).fit(straight)
    assert not model.collapsed_.any()


def test_a_heavy_kl_weight_collapses_everything(demonstrations):
    with pytest.warns(CollapseWarning, match="seed 0: z1, z2; seed 1: z1, z2"):
        model = MODELS["cvae"](seeds=2, epochs=20, hidden=(8,), window=1, kl_weight=100.0).fit(demonstrations)
    assert model.collapsed_.all()


def test_a_constant_joint_stays_finite(trained, samples):
    """The ring's last joint never moves; a state beside its one value must not blow up."""
    context, z = samples
    for model in trained.values():
        assert np.abs(model.decode(z, context)).max() < 100


@given(values=arrays(np.float64, (20, 3), elements=st.floats(-1e3, 1e3, width=32)))
def test_normalising_can_be_undone(values):
    normaliser = context_normaliser(values)
    np.testing.assert_allclose(normaliser.invert(normaliser.apply(values)), values, atol=1e-9)
    assert (normaliser.scale > 0).all()


def test_normalised_contexts_have_zero_mean_and_unit_spread_and_constants_stay():
    values = np.random.default_rng(0).normal(3, 5, size=(1000, 3))
    values[:, 1] = 7.0
    normalised = context_normaliser(values).apply(values)
    np.testing.assert_allclose(normalised.mean(0), 0, atol=1e-12)
    np.testing.assert_allclose(normalised.std(0), [1, 0, 1], atol=1e-12)


def test_actions_keep_their_proportions_and_their_zero():
    action = np.random.default_rng(0).normal(size=(100, 3)) * [1.0, 10.0, 0.0]
    normaliser = action_normaliser(action)
    scaled = normaliser.apply(action)
    assert np.square(scaled).mean() == pytest.approx(1)
    np.testing.assert_allclose(scaled * normaliser.scale, action)


def test_fit_leaves_the_demonstrations_as_they_were(demonstrations):
    copies = [episode.state.copy() for episode in demonstrations.episodes]
    MODELS["cae"](epochs=1, state_noise_rad=0.1).fit(replace(demonstrations))
    for copy, episode in zip(copies, demonstrations.episodes, strict=True):
        np.testing.assert_array_equal(copy, episode.state)


@pytest.mark.parametrize("name", ["ae", "vae", "cae", "cvae"])
def test_an_input_at_rest_is_the_mean_latent_action_where_rest_has_no_latent_of_its_own(name, demonstrations):
    model = MODELS[name](epochs=1, hidden=(8,), window=1, seeds=2).fit(demonstrations, validation=[0])
    trained_on = replace(demonstrations, episodes=demonstrations.episodes[1:])
    pairs = make_pairs(trained_on, 1, 0.0, "state", np.random.default_rng(0))
    z = model.encode(pairs.context, pairs.action)
    np.testing.assert_allclose(z.mean(axis=1), 0.0, atol=1e-9)
