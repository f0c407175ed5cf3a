"""The one contract, over every model; and once what all refuse in the base that they have in common."""

from dataclasses import fields

import numpy as np
import pytest
from sklearn.base import clone

from latentarm.core.errors import UserError
from latentarm.models.estimators import MODELS, load_model
from latentarm.models.saving import load_decoder
from latentarm.testing.models import SMALL, ModelContract


class TestModel(ModelContract):
    @pytest.fixture(params=list(MODELS))
    def estimator(self, request):
        return MODELS[request.param]

    def test_it_takes_what_all_models_take(self, estimator):
        every = {entry.name for entry in fields(MODELS["pca"]) if entry.init}
        assert every <= {entry.name for entry in fields(estimator) if entry.init}


@pytest.fixture(scope="module")
def model(demonstrations):
    return MODELS["pca"](**SMALL).fit(demonstrations)


def test_fit_uses_what_set_params_set(demonstrations):
    changed = clone(MODELS["cae"](**SMALL)).set_params(latent_dim=1, seeds=1, epochs=1)
    changed.fit(demonstrations)
    assert changed.decoder().latent_dim == 1
    assert changed.seed_numbers == (0,)
    with pytest.raises(ValueError, match="Invalid parameter 'depth'"):
        changed.set_params(depth=3)


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
def test_parameters_that_make_no_sense_are_refused(demonstrations, wrong, value):
    with pytest.raises(UserError, match=r"latent action of 5|parameter " + wrong):
        MODELS["pca"](**{**SMALL, wrong: value}).fit(demonstrations)


@pytest.mark.parametrize(
    ("validation", "message"), [([12], "Episode 12"), ([], "0 of 12"), (list(range(12)), "12 of 12")]
)
def test_validation_episodes_must_leave_some_on_both_sides(demonstrations, validation, message):
    with pytest.raises(UserError, match=message):
        MODELS["pca"](**SMALL).fit(demonstrations, validation=validation)


def test_validation_episodes_may_come_as_an_array(demonstrations, tmp_path):
    model = MODELS["pca"](**SMALL).fit(demonstrations, validation=np.array([2, 5]))
    model.save(tmp_path)
    assert load_model(tmp_path).validation_episodes_ == (2, 5)
