"""The one contract, over every model."""

import warnings
from dataclasses import fields

import numpy as np
import pytest
import torch
from sklearn.base import clone
from sklearn.exceptions import NotFittedError
from sklearn.utils import estimator_checks
from sklearn.utils.validation import check_is_fitted

from latentarm.errors import UserError
from latentarm.models.catalogue import KINDS, MODELS
from latentarm.models.decoder import load_decoder
from latentarm.models.saving import load_model
from latentarm.models.scaling import CollapseWarning

SMALL = {"seeds": 2, "epochs": 2, "hidden": (8, 8), "window": 2}


@pytest.fixture(scope="module", params=list(MODELS))
def name(request):
    return request.param


@pytest.fixture(scope="module")
def model(name, demonstrations):
    return MODELS[name](**SMALL).fit(demonstrations)


@pytest.fixture(scope="module")
def believing(name, demonstrations):
    """A model whose context holds a belief."""
    return MODELS[name](**SMALL, context="state_belief").fit(demonstrations)


def test_an_estimator_and_its_kind_name_each_other(name):
    assert MODELS[name].kind is KINDS[name]


def test_all_models_take_the_same_parameters(name):
    common = {entry.name for entry in fields(MODELS["pca"]) if entry.init}
    assert common <= {entry.name for entry in fields(MODELS[name]) if entry.init}


@pytest.mark.parametrize(
    "check",
    [
        estimator_checks.check_parameters_default_constructible,
        estimator_checks.check_no_attributes_set_in_init,
        estimator_checks.check_do_not_raise_errors_in_init_or_set_params,
        estimator_checks.check_get_params_invariance,
        estimator_checks.check_set_params,
        estimator_checks.check_estimator_cloneable,
        estimator_checks.check_estimator_repr,
        estimator_checks.check_mixin_order,
        estimator_checks.check_estimator_tags_renamed,
        estimator_checks.check_valid_tag_types,
    ],
    ids=lambda check: check.__name__,
)
def test_scikit_learn_finds_an_estimator(name, check):
    """The checks of scikit-learn that do not call fit: ours takes demonstrations, not a table."""
    check(MODELS[name].__name__, MODELS[name]())


def test_the_constructor_stores_what_it_is_given_even_where_fit_will_refuse_it(name):
    given = {key: object() for key in MODELS[name]().get_params()}
    assert MODELS[name](**given).get_params() == given


def test_a_clone_is_unfitted_and_the_same_seed_fits_the_same_model(model, demonstrations, samples):
    context, z = samples
    again = clone(model)
    assert type(again) is type(model)
    assert again.get_params() == model.get_params()
    with pytest.raises(NotFittedError):
        check_is_fitted(again)
    np.testing.assert_array_equal(again.fit(demonstrations).decode(z, context), model.decode(z, context))
    check_is_fitted(again)


def test_fit_uses_what_set_params_set(name, demonstrations):
    changed = clone(MODELS[name](**SMALL)).set_params(latent_dim=1, seeds=1, epochs=1)
    changed.fit(demonstrations)
    assert changed.decoder().latent_dim == 1
    assert changed.seed_numbers == (0,)
    with pytest.raises(ValueError, match="Invalid parameter 'depth'"):
        changed.set_params(depth=3)


def test_the_representation_is_the_call_that_makes_the_model(name):
    made = MODELS[name](**SMALL)
    again = eval(repr(made), {MODELS[name].__name__: MODELS[name]})  # noqa: S307
    assert again.get_params() == made.get_params()
    assert repr(MODELS[name]()) == f"{MODELS[name].__name__}()"


def test_shapes(model, samples):
    context, z = samples
    action = np.ones((30, 4))
    assert model.encode(context, action).shape == (2, 30, 2)
    assert model.decode(z, context).shape == (2, 30, 4)
    assert model.decode(np.stack([z, -z]), context).shape == (2, 30, 4)
    assert model.collapsed_.shape == (2, 2)
    assert model.validation_loss_.shape == (2,)
    assert model.history_.shape[1] == 2


def test_a_stack_of_latents_decodes_seed_by_seed(model, samples):
    context, z = samples
    both = model.decode(np.stack([z, -z]), context)
    np.testing.assert_array_equal(both[0], model.decode(z, context)[0])
    np.testing.assert_array_equal(both[1], model.decode(-z, context)[1])


def test_different_seeds_give_different_models(name, model, samples):
    context, z = samples
    first, second = model.decode(z, context)
    assert np.array_equal(first, second) == (name == "pca")


def test_saved_and_loaded_is_the_same(name, model, samples, tmp_path):
    context, z = samples
    model.save(tmp_path, run={"dataset": "ring"})
    loaded = load_model(tmp_path)
    assert type(loaded) is MODELS[name]
    assert loaded.get_params() == model.get_params()
    np.testing.assert_array_equal(loaded.decode(z, context), model.decode(z, context))
    np.testing.assert_array_equal(
        loaded.encode(context, z @ np.ones((2, 4))), model.encode(context, z @ np.ones((2, 4)))
    )
    np.testing.assert_array_equal(loaded.history_, model.history_)
    assert loaded.validation_episodes_ == model.validation_episodes_


def test_the_numpy_runtime_equals_the_model(model, samples, tmp_path):
    context, z = samples
    expected = model.decode(z, context)
    model.save(tmp_path)
    for seed in range(2):
        for decoder in (model.decoder(seed), load_decoder(tmp_path, seed)):
            np.testing.assert_allclose(decoder.decode(z, context), expected[seed], rtol=0, atol=1e-12)
            assert (decoder.latent_dim, decoder.context_dim, decoder.action_dim) == (2, 4, 4)


@pytest.mark.parametrize(("latent_dim", "hidden"), [(1, (8,)), (3, (6, 5, 4)), (4, ()), (2, (16, 4))])
def test_the_numpy_runtime_equals_the_model_at_any_size(name, demonstrations, latent_dim, hidden):
    settings = {**SMALL, "latent_dim": latent_dim, "hidden": hidden, "epochs": 1}
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", CollapseWarning)
        model = MODELS[name](**settings).fit(demonstrations)
    rng = np.random.default_rng(1)
    z, context = rng.uniform(-1, 1, (20, latent_dim)), rng.uniform(-1, 1, (20, 4))
    expected = model.decode(z, context)
    size = np.abs(expected).max()
    np.testing.assert_allclose(
        model.decoder(1).decode(z, context), expected[1], rtol=0, atol=1e-12 * max(size, 1)
    )


@pytest.mark.parametrize("context_kind", ["state", "state_belief"])
def test_the_torch_decoder_equals_the_model_and_its_gradient_is_the_slope(model, believing, context_kind):
    model = model if context_kind == "state" else believing
    rng = np.random.default_rng(2)
    width = 4 if context_kind == "state" else 6
    z, context = rng.uniform(-1, 1, (2, 3, 2)), rng.uniform(-1, 1, (2, 3, width))
    for seed in range(2):
        decoder = model.torch_decoder(seed, torch.float64)
        assert (decoder.context, decoder.latent_dim) == (context_kind, 2)
        assert (decoder.context_dim, decoder.action_dim) == (width, 4)

        def action(z, context, decoder=decoder):
            return decoder.decode(z, decoder.observe(context))

        inputs = [torch.from_numpy(values).requires_grad_() for values in (z, context)]
        expected = model.decoder(seed).decode(z, context)
        np.testing.assert_allclose(action(*inputs).detach().numpy(), expected, rtol=0, atol=1e-10)
        assert torch.autograd.gradcheck(action, inputs, atol=1e-5)


def test_what_the_torch_decoder_sees_begins_with_the_normalised_context(model, samples):
    context, _ = samples
    seen = model.torch_decoder(0, torch.float64).observe(torch.from_numpy(context))[..., :4].numpy()
    tensors = model.trained_.tensors
    expected = (context - tensors["context.centre"]) / tensors["context.scale"]
    np.testing.assert_allclose(seen, expected, rtol=0, atol=1e-12)


def test_one_pair_alone_equals_the_same_pair_in_a_batch(model, samples):
    context, z = samples
    action = z @ np.ones((2, 4))
    batch, encoded = model.decode(z, context), model.encode(context, action)
    decoder = model.decoder(1)
    for i in (0, 17):
        one = slice(i, i + 1)
        np.testing.assert_allclose(model.decode(z[one], context[one]), batch[:, one], rtol=0, atol=1e-12)
        np.testing.assert_allclose(
            model.encode(context[one], action[one]), encoded[:, one], rtol=0, atol=1e-9
        )
        np.testing.assert_allclose(decoder.decode(z[i], context[i]), batch[1, i], rtol=0, atol=1e-12)


def test_leading_axes_of_the_decoder_broadcast(model, samples):
    context, z = samples
    decoder = model.decoder()
    grid = decoder.decode(z[:9, None], context[:5])
    assert grid.shape == (9, 5, 4)
    np.testing.assert_allclose(grid[3, 2], decoder.decode(z[3], context[2]), atol=1e-12)
    np.testing.assert_allclose(decoder.decode(z[:9], context[2]), grid[:, 2], atol=1e-12)
    np.testing.assert_allclose(decoder.decode(z[3], context[:5]), grid[3], atol=1e-12)


def test_unit_inputs_span_what_was_demonstrated(name, model, demonstrations):
    from latentarm.demonstrations.pairs import make_pairs

    pairs = make_pairs(demonstrations, 2, 0.0, "state", np.random.default_rng(0))
    trained_on = ~np.isin(pairs.episode, model.validation_episodes_)
    used = np.abs(model.encode(pairs.context[trained_on], pairs.action[trained_on]))
    if name in ("isometric", "homogeneous"):
        # The same in every direction: the longest latent action, not each axis, reaches 1.
        longest = np.quantile(np.linalg.norm(used, axis=-1), 0.99, axis=1)
        assert ((longest > 0.6) & (longest < 1.2)).all()
    else:
        np.testing.assert_allclose(np.quantile(used, 0.99, axis=1), 1.0, atol=1e-6)


def test_unfitted_says_so(name, samples, tmp_path):
    context, z = samples
    fresh = MODELS[name]()
    for use in (
        lambda: fresh.decode(z, context),
        lambda: fresh.encode(context, context),
        fresh.decoder,
        fresh.torch_decoder,
        lambda: fresh.save(tmp_path),
        lambda: fresh.collapsed_,
    ):
        with pytest.raises(UserError, match="not fitted yet") as refused:
            use()
        assert isinstance(refused.value, NotFittedError)
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize(
    ("z", "context", "message"),
    [
        (np.ones((3, 2)), np.ones((3, 5)), "context has shape"),
        (np.ones((3, 3)), np.ones((3, 4)), "z has shape"),
        (np.ones((2, 2)), np.ones((3, 4)), "z has shape"),
        (np.ones((5, 3, 2)), np.ones((3, 4)), "z has shape"),
        (np.ones(2), np.ones((1, 4)), "z has shape"),
        (np.ones((3, 2)), np.full((3, 4), np.nan), "context holds a NaN"),
        (np.full((3, 2), np.inf), np.ones((3, 4)), "z holds a NaN or an infinity"),
    ],
)
def test_wrong_arrays_are_refused(model, z, context, message):
    with pytest.raises(UserError, match=message):
        model.decode(z, context)


def test_a_wrong_action_is_refused(model):
    with pytest.raises(UserError, match="action has shape"):
        model.encode(np.ones((3, 4)), np.ones((3, 5)))


def test_a_seed_that_is_not_there_is_refused(model, tmp_path):
    model.save(tmp_path)
    for use in (model.decoder, model.torch_decoder, lambda seed: load_decoder(tmp_path, seed)):
        with pytest.raises(UserError, match="no seed index 2"):
            use(2)


def test_the_context_may_hold_a_belief(believing, tmp_path):
    model = believing
    rng = np.random.default_rng(0)
    z, context = rng.uniform(-1, 1, (20, 2)), rng.uniform(0, 1, (20, 6))
    model.save(tmp_path)
    decoder = load_decoder(tmp_path, 1)
    assert (decoder.context, decoder.context_dim) == ("state_belief", 6)
    np.testing.assert_allclose(decoder.decode(z, context), model.decode(z, context)[1], atol=1e-12)


@pytest.mark.parametrize(
    ("wrong", "value"),
    [
        ("latent_dim", 0),
        ("latent_dim", 5),
        ("seeds", 0),
        ("window", 2.5),
        ("learning_rate", float("nan")),
        ("learning_rate", 0.0),
        ("state_noise_rad", -1.0),
        ("validation_fraction", 1.0),
        ("hidden", (0,)),
        ("hidden", [8]),
        ("context", "goal"),
        ("device", "tpu"),
        ("epochs", True),
    ],
)
def test_parameters_that_make_no_sense_are_refused(name, demonstrations, wrong, value):
    with pytest.raises(UserError, match=r"latent action of 5|parameter " + wrong):
        MODELS[name](**{**SMALL, wrong: value}).fit(demonstrations)


@pytest.mark.parametrize(
    ("validation", "message"), [([12], "Episode 12"), ([], "0 of 12"), (list(range(12)), "12 of 12")]
)
def test_validation_episodes_must_leave_some_on_both_sides(name, demonstrations, validation, message):
    with pytest.raises(UserError, match=message):
        MODELS[name](**SMALL).fit(demonstrations, validation=validation)


def test_validation_episodes_may_come_as_an_array(name, demonstrations, tmp_path):
    model = MODELS[name](**SMALL).fit(demonstrations, validation=np.array([2, 5]))
    model.save(tmp_path)
    assert load_model(tmp_path).validation_episodes_ == (2, 5)
