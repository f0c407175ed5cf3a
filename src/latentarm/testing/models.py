"""Contract tests of latent action models."""

import warnings
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from functools import cache
from pathlib import Path
from typing import Any, Final, cast

import numpy as np
import pytest
import torch
from sklearn.base import clone
from sklearn.exceptions import NotFittedError
from sklearn.utils import estimator_checks
from sklearn.utils.validation import check_is_fitted

from latentarm.core.errors import UserError
from latentarm.core.types import Demonstrations, Episode, FloatArray
from latentarm.demonstrations.pairs import make_pairs
from latentarm.evaluation.search import nearest_latents
from latentarm.models.catalogue import KINDS
from latentarm.models.estimators import load_model
from latentarm.models.model import LatentActionModel
from latentarm.models.saving import load_decoder
from latentarm.models.scaling import CollapseWarning
from latentarm.robots.planar import planar

JOINTS: Final = 4
OBJECTS: Final = ("cup", "table")
STANDS: Final = np.array([0.5, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0])  # pose of the table, which never moves
EVERYTHING: Final = ("joints", "objects_in_tool", "gripper", "belief", "objects")
CONTEXTS: Final[Mapping[tuple[str, ...], int]] = {
    ("joints",): JOINTS,
    ("joints", "belief"): JOINTS + 2,
    EVERYTHING: JOINTS + 3 + 2 * 9 * len(OBJECTS),
}
"""Contexts that every model must take, and how many entries they have."""

SMALL: Final[dict[str, Any]] = {"seeds": 2, "epochs": 2, "hidden": (8, 8), "window": 2}
"""Parameters of a training that takes a second or less."""

FEW: Final = 16  # samples of a motion where it does not matter how well the model learns


def ring(rng: np.random.Generator, samples: int = 80, rate_hz: float = 20.0) -> Episode:
    """A motion back and forth around a ring whose radius swells: two-dimensional at every state.

    What a joint does depends on where the arm is, and the last joint never moves.
    """
    time = np.arange(samples) / rate_hz
    angle = rng.uniform(-np.pi, np.pi) + 2.0 * np.sin(rng.uniform(0.5, 1.0) * time + rng.uniform(0, 6))
    radius = rng.uniform(0.5, 1.0) + 0.3 * np.sin(rng.uniform(1.0, 2.0) * time + rng.uniform(0, 6))
    state = np.stack(
        [radius * np.cos(angle), radius * np.sin(angle), 0.4 * np.sin(2 * angle), np.full(samples, 0.3)],
        axis=-1,
    )
    extras = {
        "belief": np.stack([0.5 + 0.4 * np.sin(angle), 0.5 - 0.4 * np.sin(angle)], axis=-1),
        "observation.gripper_width": 0.04 + 0.04 * np.sin(2 * time)[:, None],
        "observation.environment_state": np.concatenate(
            [_swung(time), np.tile(STANDS, (samples, 1))], axis=1
        ),
    }
    return Episode(state=state, timestamp=time, extras=extras)


def _swung(time: FloatArray) -> FloatArray:
    """Poses (T, 7) of a thing that is carried about and turned."""
    half = 0.3 * np.sin(time)
    turn = np.stack([np.cos(half), 0 * half, 0.6 * np.sin(half), 0.8 * np.sin(half)], axis=-1)
    place = np.stack([0.4 + 0.2 * np.cos(time), 0.3 * np.sin(time), 0.1 + 0 * time], axis=-1)
    return np.concatenate([place, turn], axis=-1)


@cache
def demonstrations(samples: int = 80) -> Demonstrations:
    """Twelve motions of a planar arm, each of so many samples."""
    rng = np.random.default_rng(3)
    names = tuple(f"joint{joint + 1}" for joint in range(JOINTS))
    return Demonstrations(tuple(ring(rng, samples) for _ in range(12)), 20.0, names, objects=OBJECTS)


def fit(
    model: LatentActionModel, shown: Demonstrations, validation: Sequence[int] | None = None
) -> LatentActionModel:
    """Fit a model to demonstrations of a known arm; warnings about collapsed dimensions are ignored."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", CollapseWarning)
        return model.fit(shown, validation=validation, chain=planar(JOINTS).chain)


@cache
def fitted(estimator: type[LatentActionModel], context: tuple[str, ...]) -> LatentActionModel:
    """A model that all tests of a session share; none may change it."""
    return fit(estimator(**SMALL, context=context), demonstrations(80 if context == ("joints",) else FEW))


class ModelContract:
    """Tests of a latent action model that is registered in the catalogue of models.

    Override the fixture ``estimator``::

        class TestTheirModel(ModelContract):
            @pytest.fixture
            def estimator(self):
                return TheirModel

    A model is trained on small data a few times; most tests share the same two trainings.
    """

    @pytest.fixture
    def estimator(self) -> type[LatentActionModel]:
        """The class of the model."""
        raise NotImplementedError("override the fixture `estimator`")

    @pytest.fixture
    def model(self, estimator: type[LatentActionModel]) -> LatentActionModel:
        """A fitted model of two seeds, which no test may change."""
        return fitted(estimator, ("joints",))

    @pytest.fixture
    def context(self) -> FloatArray:
        """Contexts (30, 4) that no model was trained on."""
        return np.random.default_rng(4).uniform(-1, 1, size=(30, JOINTS))

    @pytest.fixture
    def z(self) -> FloatArray:
        """Inputs (30, 2)."""
        return np.random.default_rng(5).uniform(-1, 1, size=(30, 2))

    def test_the_catalogue_has_its_kind(self, estimator: type[LatentActionModel]) -> None:
        assert KINDS[estimator.kind.name] is estimator.kind

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
    def test_scikit_learn_finds_an_estimator(self, estimator: type[LatentActionModel], check: Any) -> None:
        """The checks of scikit-learn that do not call fit: ours takes demonstrations, not a table."""
        check(estimator.__name__, estimator())

    def test_the_representation_is_the_call_that_makes_the_model(
        self, estimator: type[LatentActionModel]
    ) -> None:
        made = estimator(**SMALL)
        again = eval(repr(made), {estimator.__name__: estimator})  # noqa: S307
        assert again.get_params() == made.get_params()
        assert repr(estimator()) == f"{estimator.__name__}()"

    def test_a_clone_is_unfitted_and_the_same_seed_fits_the_same_model(
        self, model: LatentActionModel, z: FloatArray, context: FloatArray
    ) -> None:
        again = cast(LatentActionModel, clone(model))
        assert type(again) is type(model)
        assert again.get_params() == model.get_params()
        with pytest.raises(NotFittedError):
            check_is_fitted(again)
        np.testing.assert_array_equal(
            fit(again, demonstrations()).decode(z, context), model.decode(z, context)
        )
        check_is_fitted(again)

    def test_shapes(self, model: LatentActionModel, z: FloatArray, context: FloatArray) -> None:
        assert model.encode(context, np.ones((30, JOINTS))).shape == (2, 30, 2)
        assert model.decode(z, context).shape == (2, 30, JOINTS)
        assert model.collapsed_.shape == (2, 2)
        assert model.validation_loss_.shape == (2,)
        assert model.history_.shape[1] == 2

    def test_a_stack_of_latents_decodes_seed_by_seed(
        self, model: LatentActionModel, z: FloatArray, context: FloatArray
    ) -> None:
        both = model.decode(np.stack([z, -z]), context)
        np.testing.assert_array_equal(both[0], model.decode(z, context)[0])
        np.testing.assert_array_equal(both[1], model.decode(-z, context)[1])

    def test_different_seeds_give_different_models(
        self, model: LatentActionModel, z: FloatArray, context: FloatArray
    ) -> None:
        first, second = model.decode(z, context)
        trained_in_epochs = len(model.history_) > 0
        assert np.array_equal(first, second) != trained_in_epochs

    def test_validation_episodes_leave_the_weights_alone(
        self, estimator: type[LatentActionModel], z: FloatArray, context: FloatArray
    ) -> None:
        """What they hold decides when to stop; weights, normalisers and scaling never see it."""
        data = demonstrations(FEW)
        altered = list(data.episodes)
        for index in (0, 5):
            altered[index] = replace(altered[index], state=3.0 - 7.0 * altered[index].state[::-1])
        briefly: dict[str, Any] = {**SMALL, "epochs": 1}
        plain, changed = (
            fit(estimator(**briefly), replace(data, episodes=tuple(episodes)), validation=[0, 5])
            for episodes in (data.episodes, altered)
        )
        for tensor, values in plain.trained_.tensors.items():
            np.testing.assert_array_equal(changed.trained_.tensors[tensor], values, err_msg=tensor)
        np.testing.assert_array_equal(changed.decode(z, context), plain.decode(z, context))
        assert (changed.validation_loss_ != plain.validation_loss_).all()

    def test_saved_and_loaded_is_the_same(
        self, model: LatentActionModel, z: FloatArray, context: FloatArray, tmp_path: Path
    ) -> None:
        model.save(tmp_path, run={"dataset": "ring"})
        loaded = load_model(tmp_path)
        action = z @ np.ones((2, JOINTS))
        assert type(loaded) is type(model)
        assert loaded.get_params() == model.get_params()
        np.testing.assert_array_equal(loaded.decode(z, context), model.decode(z, context))
        np.testing.assert_array_equal(loaded.encode(context, action), model.encode(context, action))
        np.testing.assert_array_equal(loaded.history_, model.history_)
        assert loaded.validation_episodes_ == model.validation_episodes_

    @pytest.mark.parametrize("kind", CONTEXTS)
    def test_the_runtime_in_numpy_equals_the_model(
        self, estimator: type[LatentActionModel], z: FloatArray, tmp_path: Path, kind: tuple[str, ...]
    ) -> None:
        width = CONTEXTS[kind]
        model = fitted(estimator, kind)
        context = np.random.default_rng(6).uniform(-1, 1, (30, width))
        expected = model.decode(z, context)
        model.save(tmp_path)
        for seed in range(2):
            for decoder in (model.decoder(seed), load_decoder(tmp_path, seed)):
                np.testing.assert_allclose(decoder.decode(z, context), expected[seed], rtol=0, atol=1e-12)
                assert (decoder.layout, decoder.latent_dim) == (model.trained_.layout, 2)
                assert decoder.layout.features == kind
                assert (decoder.context_dim, decoder.action_dim) == (width, JOINTS)

    @pytest.mark.parametrize(("latent_dim", "hidden"), [(1, (8,)), (3, (6, 5, 4)), (4, ())])
    def test_the_runtime_in_numpy_equals_the_model_at_any_size(
        self, estimator: type[LatentActionModel], latent_dim: int, hidden: tuple[int, ...]
    ) -> None:
        sizes: dict[str, Any] = {**SMALL, "latent_dim": latent_dim, "hidden": hidden, "epochs": 1}
        model = fit(estimator(**sizes), demonstrations(FEW))
        rng = np.random.default_rng(1)
        z, context = rng.uniform(-1, 1, (20, latent_dim)), rng.uniform(-1, 1, (20, JOINTS))
        expected = model.decode(z, context)
        tolerance = 1e-12 * max(np.abs(expected).max(), 1)
        np.testing.assert_allclose(model.decoder(1).decode(z, context), expected[1], rtol=0, atol=tolerance)

    @pytest.mark.parametrize("kind", [kind for kind in CONTEXTS if kind != EVERYTHING])
    def test_the_torch_decoder_equals_the_model_and_its_gradient_is_the_slope(
        self, estimator: type[LatentActionModel], kind: tuple[str, ...]
    ) -> None:
        width = CONTEXTS[kind]
        model = fitted(estimator, kind)
        rng = np.random.default_rng(2)
        z, context = rng.uniform(-1, 1, (2, 3, 2)), rng.uniform(-1, 1, (2, 3, width))
        for seed in range(2):
            decoder = model.torch_decoder(seed, torch.float64)
            assert (decoder.layout, decoder.latent_dim) == (model.trained_.layout, 2)
            assert (decoder.context_dim, decoder.action_dim) == (width, JOINTS)

            def action(both: torch.Tensor, decoder: Any = decoder) -> torch.Tensor:
                return decoder.decode(both[..., :2], decoder.observe(both[..., 2:]))

            both = torch.from_numpy(np.concatenate([z, context], axis=-1))
            expected = model.decoder(seed).decode(z, context)
            np.testing.assert_allclose(action(both).detach().numpy(), expected, rtol=0, atol=1e-10)
            _check_slope(action, both)

    def test_what_the_torch_decoder_sees_begins_with_the_normalised_context(
        self, model: LatentActionModel, context: FloatArray
    ) -> None:
        seen = model.torch_decoder(0, torch.float64).observe(torch.from_numpy(context))[..., :JOINTS].numpy()
        tensors = model.trained_.tensors
        expected = (context - tensors["context.centre"]) / tensors["context.scale"]
        np.testing.assert_allclose(seen, expected, rtol=0, atol=1e-12)

    def test_one_pair_alone_equals_the_same_pair_in_a_batch(
        self, model: LatentActionModel, z: FloatArray, context: FloatArray
    ) -> None:
        action = z @ np.ones((2, JOINTS))
        batch, encoded, decoder = model.decode(z, context), model.encode(context, action), model.decoder(1)
        for i in (0, 17):
            one = slice(i, i + 1)
            np.testing.assert_allclose(model.decode(z[one], context[one]), batch[:, one], rtol=0, atol=1e-12)
            np.testing.assert_allclose(
                model.encode(context[one], action[one]), encoded[:, one], rtol=0, atol=1e-9
            )
            np.testing.assert_allclose(decoder.decode(z[i], context[i]), batch[1, i], rtol=0, atol=1e-12)

    def test_leading_axes_of_the_decoder_broadcast(
        self, model: LatentActionModel, z: FloatArray, context: FloatArray
    ) -> None:
        decoder = model.decoder()
        grid = decoder.decode(z[:9, None], context[:5])
        assert grid.shape == (9, 5, JOINTS)
        np.testing.assert_allclose(grid[3, 2], decoder.decode(z[3], context[2]), atol=1e-12)
        np.testing.assert_allclose(decoder.decode(z[:9], context[2]), grid[:, 2], atol=1e-12)
        np.testing.assert_allclose(decoder.decode(z[3], context[:5]), grid[3], atol=1e-12)

    def test_unit_inputs_span_what_was_demonstrated(self, model: LatentActionModel) -> None:
        pairs = make_pairs(demonstrations(), SMALL["window"], 0.0, ("joints",), np.random.default_rng(0))
        trained_on = ~np.isin(pairs.episode, model.validation_episodes_)
        used = np.abs(model.encode(pairs.context[trained_on], pairs.action[trained_on]))
        if model.kind.encoder != "nearest":
            np.testing.assert_allclose(np.quantile(used, 0.99, axis=1), 1.0, atol=1e-6)
        else:
            # The same in every direction: the longest latent action, not each axis, reaches 1.
            longest = np.quantile(np.linalg.norm(used, axis=-1), 0.99, axis=1)
            assert ((longest > 0.6) & (longest < 1.2)).all()

    def test_the_search_for_the_nearest_input_is_right_for_it(self, model: LatentActionModel) -> None:
        pairs = make_pairs(demonstrations(), SMALL["window"], 0.0, ("joints",), np.random.default_rng(0))
        rows = np.linspace(0, len(pairs.action) - 1, 30).astype(int)
        seen, action = pairs.context[rows], pairs.action[rows]
        codes = model.encode(seen, action)
        decoders = [model.decoder(seed) for seed in range(2)]
        values = np.linspace(-1.0, 1.0, 41)
        grid = np.stack(np.meshgrid(values, values), axis=-1).reshape(-1, 2)
        found = nearest_latents(decoders, seen, action)
        assert np.abs(found).max() <= 1.0
        for decoder, z, code in zip(decoders, found, codes, strict=True):
            error = np.square(decoder.decode(z, seen) - action).sum(axis=-1)
            own = np.square(decoder.decode(np.clip(code, -1.0, 1.0), seen) - action).sum(axis=-1)
            # Not told the code, it does as well but for rounding; told, by construction.
            assert error.sum() <= 1.001 * own.sum() + 1e-12
            came = decoder.decode(grid, seen[:, None])
            least = np.square(came - action[:, None]).sum(axis=-1).min(axis=1)
            assert error.sum() <= 1.001 * least.sum() + 1e-12
        told = nearest_latents(decoders, seen, action, codes)
        for decoder, z, code in zip(decoders, told, codes, strict=True):
            error = np.square(decoder.decode(z, seen) - action).sum(axis=-1)
            own = np.square(decoder.decode(np.clip(code, -1.0, 1.0), seen) - action).sum(axis=-1)
            assert (error <= own + 1e-12).all()

    def test_at_rest_it_rests_and_reverses_where_its_kind_says_so(
        self, model: LatentActionModel, z: FloatArray, context: FloatArray
    ) -> None:
        if model.kind.reverses:
            np.testing.assert_allclose(model.decode(0 * z, context), 0.0, atol=1e-9)
            np.testing.assert_allclose(model.decode(-z, context), -model.decode(z, context), atol=1e-9)
        if not model.kind.sees_context:
            there = model.decode(z, np.roll(context, 1, axis=0))
            np.testing.assert_array_equal(there, model.decode(z, context))

    def test_unfitted_it_says_so(
        self, estimator: type[LatentActionModel], z: FloatArray, context: FloatArray, tmp_path: Path
    ) -> None:
        fresh = estimator()
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


def _check_slope(function: Callable[[torch.Tensor], torch.Tensor], at: torch.Tensor) -> None:
    """The gradient of a function of the last axis is that of central differences.

    `torch.autograd.gradcheck` finds the same, but imports SymPy, which takes seconds.
    """
    at = at.detach().requires_grad_()
    by_output = function(at).sum(dim=tuple(range(at.ndim - 1))).unbind()
    slopes = torch.stack([torch.autograd.grad(one, at, retain_graph=True)[0] for one in by_output])
    with torch.no_grad():
        nudges = 1e-6 * torch.eye(at.shape[-1], dtype=at.dtype)[(slice(None), *[None] * (at.ndim - 1))]
        differences = (function(at + nudges) - function(at - nudges)) / 2e-6
    np.testing.assert_allclose(slopes, torch.movedim(differences, (-1, 0), (0, -1)), rtol=1e-3, atol=1e-5)
