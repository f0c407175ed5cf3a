"""What the isometric model promises for every context and all weights, and what it needs."""

import json
from dataclasses import replace

import numpy as np
import pytest
import torch
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from safetensors.numpy import load, save

from latentarm.core.errors import UserError
from latentarm.models.batches import Batch
from latentarm.models.estimators import MODELS
from latentarm.models.isometric.runtime import DAMPING_M2
from latentarm.models.isometric.training import Isometric, _geometry
from latentarm.models.networks import group_layers
from latentarm.models.saving import load_decoder
from latentarm.models.scaling import context_normaliser
from latentarm.models.tool_contexts import ROTATION_WEIGHT_M, ToolContexts
from latentarm.robots.catalogue import load_robot
from latentarm.robots.planar import planar
from latentarm_research.tasks.planar.catalogue import MOTIONS

SMALL = {"seeds": 2, "epochs": 3, "hidden": (12, 12), "window": 2}
SCATTERED = {"epochs": 1, "hidden": (12, 12), "window": 2, "bend_weight": 0.0}

coordinate = st.floats(-2.5, 2.5, allow_nan=False, width=32)
push = st.floats(-1, 1, allow_nan=False, width=32)


@pytest.fixture(scope="module")
def model(few):
    return Isometric(**SMALL).fit(few)


@pytest.fixture(scope="module", params=[1, 2, 3])
def rough(request, few):
    """Decoders with random weights and a large bend: the promises do not hang on training."""
    model = Isometric(**SCATTERED, latent_dim=request.param).fit(few)
    rng = np.random.default_rng(request.param)
    tensors = {
        name: values + rng.normal(0.0, 0.8, values.shape)
        if name.startswith(("decoder.", "posture.", "gain."))
        else values
        for name, values in model.trained_.tensors.items()
    }
    model.trained_ = replace(model.trained_, tensors=tensors)
    return model


def metric(chain, state):
    """G(s) by its definition, from the chain alone."""
    weight = np.diag([1.0] * 3 + [ROTATION_WEIGHT_M**2] * 3)
    jacobians = [chain.jacobian(state, tool) for tool in range(len(chain.tools))]
    tools = sum(jacobian.T @ weight @ jacobian for jacobian in jacobians) / len(jacobians)
    return tools + DAMPING_M2 * np.eye(chain.dof)


def saturation(model):
    """kappa, (S,)."""
    tensors = model.trained_.tensors
    return np.log1p(np.exp(tensors["gain.0.weight"] + tensors["gain.0.bias"]))[:, 0, 0]


def tool_speed(model, action, state, arm):
    return np.sqrt(action @ metric(arm.chain, state) @ action) / model.trained_.tensors["action.scale"][0]


@settings(max_examples=30)
@given(
    state=arrays(np.float64, 4, elements=coordinate),
    other=arrays(np.float64, 4, elements=coordinate),
    data=st.data(),
)
def test_the_same_push_moves_the_tool_equally_fast_everywhere_and_in_every_direction(
    rough, state, other, data
):
    arm = planar(4)
    d = rough.latent_dim
    z = data.draw(arrays(np.float64, d, elements=push).filter(lambda z: np.linalg.norm(z) > 1e-3))
    turned = np.linalg.qr(np.random.default_rng(0).normal(size=(d, d)))[0] @ z
    decoder = rough.decoder(0)
    here = tool_speed(rough, decoder.decode(z, state), state, arm)
    there = tool_speed(rough, decoder.decode(turned, other), other, arm)
    assert here == pytest.approx(there, rel=1e-5)
    assert tool_speed(rough, decoder.decode(0.5 * z, state), state, arm) < here


@settings(max_examples=30)
@given(state=arrays(np.float64, 4, elements=coordinate), data=st.data())
def test_rest_is_rest_and_the_opposite_input_is_the_opposite_motion(rough, state, data):
    z = data.draw(arrays(np.float64, rough.latent_dim, elements=push))
    decoder = rough.decoder(0)
    np.testing.assert_array_equal(decoder.decode(0 * z, state), 0.0)
    np.testing.assert_array_equal(decoder.decode(-z, state), -decoder.decode(z, state))


@settings(max_examples=20)
@given(state=arrays(np.float64, 4, elements=coordinate))
def test_the_axes_are_at_right_angles_in_the_metric_where_nothing_bends(rough, state):
    """At half a push the bend is zero, whatever the weights."""
    arm, d = planar(4), rough.latent_dim
    columns = rough.decoder(0).decode(0.5 * np.eye(d), state)
    gram = columns @ metric(arm.chain, state) @ columns.T
    np.testing.assert_allclose(gram, gram[0, 0] * np.eye(d), atol=2e-5 * gram[0, 0])


def test_the_encoder_finds_the_latent_action_again(rough, samples):
    context = samples[0]
    rng = np.random.default_rng(7)
    z = rng.normal(size=(len(context), rough.latent_dim))
    z *= rng.uniform(0.1, 0.95, (len(z), 1)) / np.linalg.norm(z, axis=1, keepdims=True)
    action = rough.decode(z, context)[0]
    found = rough.encode(context, action)
    again = rough.decode(found, context)[0]
    lost = np.linalg.norm(again - action, axis=1) / np.linalg.norm(action, axis=1)
    assert np.median(lost) < 0.02


def test_no_latent_action_is_nearer_than_the_encoders(few, samples):
    """Against a dense search, for any action; with one dimension the encoder's search is exact."""
    model = Isometric(**SMALL, latent_dim=1).fit(few)
    context = samples[0]
    action = np.random.default_rng(5).normal(0.0, 0.3, context.shape)
    rebuilt = model.decode(model.encode(context, action), context)
    error = np.linalg.norm(rebuilt - action, axis=-1)
    for seed in range(2):
        decoded = model.decoder(seed).decode(np.linspace(-1.5, 1.5, 2000)[:, None], context[:, None])
        nearest = np.linalg.norm(decoded - action[:, None], axis=-1).min(axis=1)
        assert (error[seed] <= nearest * 1.005).all()


def test_the_loss_is_the_distance_to_what_was_decoded_plus_the_price_of_bending(model, demonstrations):
    trained = model.trained_
    context = demonstrations.episodes[0].state[:20]
    action = np.random.default_rng(0).normal(0.0, 0.5, context.shape)
    observed = torch.from_numpy(trained.contexts.apply(context)).expand(2, -1, -1)
    wanted = torch.from_numpy(trained.actions.apply(action)).expand(2, -1, -1)
    networks = group_layers({name: torch.from_numpy(value) for name, value in trained.tensors.items()})
    loss = model._loss(networks, Batch(observed, wanted, *[torch.zeros(2, 20, 0)] * 3))
    rebuilt = trained.actions.apply(model.decode(model.encode(context, action), context))
    error = np.square(rebuilt - wanted.numpy()).sum(axis=(1, 2)) / 20
    geometry = _geometry(networks, observed, 2)
    bend = geometry.bend_twist.square().sum((1, 2, 3)).numpy() / 20
    np.testing.assert_allclose(loss.numpy(), error + 1e-3 * (bend + saturation(model) ** 2), rtol=1e-6)


def test_the_gradient_is_that_of_the_whole_loss_though_none_flows_through_the_search(few, demonstrations):
    """The envelope theorem, against finite differences of the loss with its search."""
    model = Isometric(**{**SMALL, "seeds": 1}, latent_dim=1, bend_weight=0.0).fit(few)
    trained = model.trained_
    context = demonstrations.episodes[1].state[5:45]
    wanted = model.decode(np.random.default_rng(1).uniform(-0.5, 0.5, (40, 1)), context)
    wanted = torch.from_numpy(trained.actions.apply(wanted * 0.9 + 0.02))
    observed = torch.from_numpy(trained.contexts.apply(context))[None]
    tensors = {name: torch.from_numpy(value.copy()) for name, value in trained.tensors.items()}
    name = "decoder.1.bias"

    def loss(values):
        return model._loss(
            group_layers({**tensors, name: values}), Batch(observed, wanted, *[wanted[..., :0]] * 3)
        )

    leaf = tensors[name].clone().requires_grad_()
    (gradient,) = torch.autograd.grad(loss(leaf).sum(), [leaf])
    direction = torch.from_numpy(np.random.default_rng(2).normal(size=leaf.shape))
    step = 1e-3
    numeric = (loss(tensors[name] + step * direction) - loss(tensors[name] - step * direction)) / (2 * step)
    assert float((gradient * direction).sum()) == pytest.approx(float(numeric), rel=0.02, abs=1e-4)


def test_seeds_agree_on_which_way_is_forward(demonstrations):
    task = MOTIONS["sine"]()
    shown = task.demonstrate(15, np.random.default_rng(0))
    model = Isometric(latent_dim=1, seeds=4, epochs=6, actions="recorded", hidden=(16, 16)).fit(shown)
    state = np.concatenate([episode.state for episode in shown.episodes])[::50]
    for seed in range(4):
        velocity = np.einsum(
            "nij,nj->ni",
            task.robot.chain.jacobian(state),
            model.decoder(seed).decode(np.ones((len(state), 1)), state),
        )
        assert len(np.unique(np.sign(velocity[:, 0]))) == 1


def test_two_arms_count_both_tools(samples):
    task = MOTIONS["rotate"]()
    shown = task.demonstrate(4, np.random.default_rng(0))
    model = Isometric(latent_dim=1, actions="recorded", epochs=2, hidden=(8,)).fit(shown)
    assert model.trained_.dimensions.tools == 2
    state = shown.episodes[0].state[0]
    slow, fast = (model.decoder(0).decode(np.array([push]), state) for push in (0.5, 1.0))
    ratio = [tool_speed(model, action, state, task.robot) for action in (slow, fast)]
    gain = saturation(model)[0]
    assert ratio[0] / ratio[1] == pytest.approx(np.tanh(0.5 * gain) / np.tanh(gain), rel=1e-6)


def test_an_observation_is_what_its_chain_says(demonstrations):
    arm = planar(4)
    context = demonstrations.episodes[0].state[:7]
    contexts = ToolContexts.fitted(arm.chain, context, context_normaliser(context), DAMPING_M2)
    again = ToolContexts.of_tensors(contexts.tensors(), DAMPING_M2)
    np.testing.assert_array_equal(again.apply(context), contexts.apply(context))
    sizes = contexts.sizes
    jacobian = contexts.apply(context)[:, sizes.jacobian].reshape(7, 6, 4)
    weight = np.repeat([1.0, ROTATION_WEIGHT_M], 3)[:, None]
    np.testing.assert_allclose(jacobian, arm.chain.jacobian(context) * weight)
    lift = contexts.apply(context)[:, sizes.lift].reshape(7, 4, 6)
    for state, up, down in zip(context, lift, jacobian, strict=True):
        np.testing.assert_allclose(metric(arm.chain, state) @ up, down.T, atol=1e-12)


def test_it_needs_to_know_the_arm(few):
    with pytest.raises(UserError, match="which arm"):
        Isometric(**SMALL).fit(replace(few, robot=""))
    with pytest.raises(UserError, match="5 joints and the demonstrations 4"):
        Isometric(**SMALL).fit(few, chain=planar(5).chain)
    given_arm = Isometric(**SMALL).fit(replace(few, robot=""), chain=load_robot(few.robot).chain)
    assert given_arm.trained_.dimensions.tools == 1


def test_a_model_of_another_metric_is_refused(demonstrations):
    context = demonstrations.episodes[0].state
    contexts = ToolContexts.fitted(planar(4).chain, context, context_normaliser(context), DAMPING_M2)
    with pytest.raises(UserError, match="train it again"):
        ToolContexts.of_tensors(
            {**contexts.tensors(), "metric.scale": np.array([0.1, DAMPING_M2])},
            DAMPING_M2,
        )
    with pytest.raises(UserError, match="train it again"):
        ToolContexts.of_tensors(contexts.tensors(), 2 * DAMPING_M2)


@pytest.mark.parametrize(
    ("tensor", "value"), [("chain.parent", 7.0), ("chain.parent", 0.5), ("chain.tool_link", -3.0)]
)
def test_a_saved_arm_that_is_none_is_refused(model, tmp_path, tensor, value):
    import hashlib

    model.save(tmp_path)
    tensors = load((tmp_path / "model.safetensors").read_bytes())
    tensors[tensor][0] = value
    content = save(tensors)
    (tmp_path / "model.safetensors").write_bytes(content)
    config = json.loads((tmp_path / "config.json").read_text())
    config["model"]["sha256"] = hashlib.sha256(content).hexdigest()
    (tmp_path / "config.json").write_text(json.dumps(config))
    with pytest.raises(UserError, match=r"model\.safetensors.*" + tensor.replace(".", r"\.")):
        load_decoder(tmp_path)


def test_decoding_loads_no_torch_and_takes_the_arm_along(model, tmp_path, samples):
    context, z = samples
    model.save(tmp_path)
    np.testing.assert_allclose(
        load_decoder(tmp_path, 1).decode(z, context), model.decode(z, context)[1], atol=1e-12
    )
    assert "isometric" in MODELS
