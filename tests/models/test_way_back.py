"""A way back beside any decoder: its laws for all weights, and what it learns."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from latentarm.core.errors import UserError
from latentarm.models.decoder import Decoder
from latentarm.models.estimators import MODELS
from latentarm.models.saved_chain import chain_of_tensors
from latentarm.models.saving import load_decoder, read_model
from latentarm.models.tool_contexts import places_and_jacobian
from latentarm.models.way_back import training
from latentarm.models.way_back.runtime import DAMPING_M2, GATE_M, NETWORK, STRENGTH, WayBack, metric_length
from latentarm.models.way_back.training import NOISE_M, NoWayBackWarning, displaced
from latentarm.tasks.table_top import TableTop

KINDS = ("homogeneous", "cvae", "pca")
FEW_EPOCHS = {"seeds": 2, "epochs": 2, "way_back_m": 0.06}


@pytest.fixture(scope="module")
def shown():
    return TableTop().demonstrate(10, np.random.default_rng(0))


@pytest.fixture(scope="module", params=KINDS)
def model(request, shown):
    """One of which nobody asks how well it learned."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(training, "CONFIG", replace(training.CONFIG, epochs=2))
        return MODELS[request.param](**FEW_EPOCHS).fit(shown)


@pytest.fixture(scope="module")
def chain(model):
    return chain_of_tensors(model.trained_.tensors)


def with_weights(trained, rng, size):
    """The model with other weights of its way back."""
    drawn = {
        name: size * rng.normal(size=array.shape)
        for name, array in trained.tensors.items()
        if name.startswith(f"{NETWORK}.") and array.ndim == 3
    }
    return replace(trained, tensors={**trained.tensors, **drawn})


@given(seed=st.integers(0, 2**32 - 1), size=st.sampled_from([0.0, 0.01, 0.1, 1.0]))
def test_its_laws_hold_for_all_weights(model, chain, seed, size):
    rng = np.random.default_rng(seed)
    trained = with_weights(model.trained_, rng, size)
    decoder, alone = Decoder(trained), Decoder(replace(trained, dimensions=_none(trained)))
    context = rng.uniform(-2.0, 2.0, size=(40, 7))
    z = rng.uniform(-1.0, 1.0, size=(40, 2))
    speed, _ = trained.tensors[f"{NETWORK}.scale"]
    _, jacobian = places_and_jacobian(chain, context)
    action, person = decoder.decode(z, context), alone.decode(z, context)
    lengths = metric_length(jacobian, action)[:, 0]

    np.testing.assert_array_equal(decoder.decode(0.0 * z, context), 0.0)
    assert (lengths <= speed * np.linalg.norm(z, axis=1) + 2e-6).all()
    along = np.vecdot(np.matvec(jacobian, action), np.matvec(jacobian, person))
    along = along + DAMPING_M2 * np.vecdot(action, person)
    least = (1 - STRENGTH) / (1 + STRENGTH) * lengths * metric_length(jacobian, person)[:, 0]
    assert (along >= least - 1e-6).all()
    if trained.kind.name == "homogeneous":
        np.testing.assert_allclose(decoder.decode(0.5 * z, context), 0.5 * action, rtol=1e-3, atol=1e-8)


def _none(trained):
    return replace(trained.dimensions, way_back=())


def test_where_it_knows_nothing_it_does_nothing(model):
    trained = model.trained_
    last = f"{NETWORK}.{len(trained.dimensions.way_back)}.bias"
    far = replace(
        trained, tensors={**trained.tensors, last: np.full_like(trained.tensors[last], 50.0 * GATE_M)}
    )
    context, z = np.random.default_rng(0).uniform(-1.0, 1.0, size=(20, 7)), np.full((20, 2), 1e-3)
    capped = WayBack(far, 0)
    action = 1e-6 * np.ones((20, 7))
    np.testing.assert_allclose(capped(action, z, context), action, rtol=1e-9)


def test_every_form_of_the_decoder_gives_the_same(model, tmp_path):
    rng = np.random.default_rng(1)
    context, z = rng.uniform(-1.0, 1.0, size=(30, 7)), rng.uniform(-1.0, 1.0, size=(30, 2))
    model.save(tmp_path)
    expected = model.decode(z, context)
    for seed in range(2):
        for decoder in (model.decoder(seed), load_decoder(tmp_path, seed)):
            np.testing.assert_allclose(decoder.decode(z, context), expected[seed], rtol=0, atol=1e-12)
    with pytest.raises(UserError, match="has no way back"):
        model.torch_decoder()


def test_a_context_that_is_overwritten_is_seen_anew(model):
    rng = np.random.default_rng(3)
    context, z = rng.uniform(-1.0, 1.0, size=(30, 7)), rng.uniform(-1.0, 1.0, size=(30, 2))
    decoder, here = model.decoder(), np.empty(7)
    expected = decoder.decode(z, context)
    for row, push, action in zip(context, z, expected, strict=True):
        here[:] = row
        for _ in range(2):
            np.testing.assert_allclose(decoder.decode(push, here), action, rtol=0, atol=1e-12)


def test_its_enclosure_holds_every_input(model):
    rng = np.random.default_rng(2)
    context = rng.uniform(-1.0, 1.0, size=(20, 7))
    decoder = model.decoder()
    enclosure = decoder.enclose(context)
    action = decoder.decode(rng.uniform(-1.0, 1.0, size=(3000, 1, 2)), context)
    direction = rng.normal(size=(20, 7))
    assert (np.linalg.norm(action, axis=-1) <= enclosure.largest()).all()
    assert (np.vecdot(action, direction) <= enclosure.furthest(direction)).all()


def test_it_leads_back_from_displaced_held_out_states(shown):
    model = MODELS["pca"](seeds=1, way_back_m=0.06).fit(shown)
    trained, rng = model.trained_, np.random.default_rng(5)
    chain = chain_of_tensors(trained.tensors)
    held_out = [shown.episodes[index].state[::4] for index in model.validation_episodes_]
    context = np.concatenate(held_out)
    there = displaced(chain, trained.layout, context, np.zeros((len(context), 0), dtype=bool), rng)
    way = WayBack(trained, 0).pull(there.context)[0]
    _, jacobian = places_and_jacobian(chain, there.context)
    before, after = (metric_length(jacobian, off).mean() for off in (there.way, there.way - way))
    assert after < 0.8 * before
    on_the_path = metric_length(places_and_jacobian(chain, context)[1], WayBack(trained, 0).pull(context)[0])
    assert on_the_path.mean() < 0.25 * NOISE_M


def test_where_it_leads_from_beside_a_place(model, chain):
    context = np.random.default_rng(7).uniform(-1.0, 1.0, size=(20, 7))
    offset = np.array([0.0, 0.03, 0.0])
    here, there = WayBack(model.trained_, 0).leads(context, offset)
    taken = here - chain.forward(context).position
    assert (np.linalg.norm(taken - offset, axis=1) < 0.2 * np.linalg.norm(offset)).mean() > 0.8
    assert (np.linalg.norm(there - here, axis=1) <= 1.5 * GATE_M).all()


def test_a_way_back_that_does_not_help_is_left_out(shown):
    rng = np.random.default_rng(6)
    # Motions without anything in common: what was demonstrated tells nothing of the others.
    episodes = tuple(
        replace(one, state=one.state + rng.uniform(-1.5, 1.5, size=7)) for one in shown.episodes[:3]
    )
    with pytest.warns(NoWayBackWarning, match="so the model has none"):
        model = MODELS["pca"](way_back_m=0.06).fit(replace(shown, episodes=episodes))
    assert model.trained_.dimensions.way_back == ()


def test_it_needs_a_known_arm(shown):
    with pytest.raises(UserError, match="with the context joints and a way back looks at the arm's tool"):
        MODELS["cae"](way_back_m=0.06).fit(replace(shown, robot=""))


def test_a_saved_model_that_lost_its_way_back_is_refused(model, tmp_path):
    model.save(tmp_path)
    config = (tmp_path / "config.json").read_text()
    (tmp_path / "config.json").write_text(config.replace('"way_back": [', '"way_back": [64, '))
    with pytest.raises(UserError):
        read_model(tmp_path)
