"""Equations 6 to 8, worked by hand."""

import math

import numpy as np
import pytest
import torch

from latentarm.demonstrations.pairs import make_pairs
from latentarm.models.estimators import MODELS
from latentarm.models.losses import kl_divergence, reconstruction_error, sample_latent
from latentarm.models.scaling import find_collapsed


def test_kl_of_the_prior_itself_is_zero():
    assert kl_divergence(torch.zeros(1, 3, 2), torch.zeros(1, 3, 2)).item() == 0


def test_kl_by_hand():
    # Two dimensions: N(1, 2^2) and N(-3, 0.5^2). Per dimension (mu^2 + sigma^2 - 1) / 2 - log sigma:
    # (1 + 4 - 1) / 2 - log 2 and (9 + 0.25 - 1) / 2 + log 2, together 6.125.
    mean = torch.tensor([[[1.0, -3.0]]], dtype=torch.float64)
    log_variance = 2 * torch.log(torch.tensor([[[2.0, 0.5]]], dtype=torch.float64))
    assert kl_divergence(mean, log_variance).item() == pytest.approx(6.125, abs=1e-12)


def test_kl_agrees_with_torch_and_averages_over_the_batch():
    generator = torch.Generator().manual_seed(0)
    mean = torch.randn(2, 5, 3, generator=generator, dtype=torch.float64)
    log_variance = torch.randn(2, 5, 3, generator=generator, dtype=torch.float64)
    posterior = torch.distributions.Normal(mean, (log_variance / 2).exp())
    prior = torch.distributions.Normal(torch.zeros_like(mean), torch.ones_like(mean))
    expected = torch.distributions.kl_divergence(posterior, prior).sum(-1).mean(-1)
    np.testing.assert_allclose(kl_divergence(mean, log_variance), expected, rtol=1e-7, atol=1e-7)


def test_reconstruction_error_by_hand():
    # ‖(1, 2) - (0, 0)‖^2 = 5 and ‖(1, 0) - (1, 3)‖^2 = 9: mean 7, whatever the other seed does.
    action = torch.tensor([[[1.0, 2.0], [1.0, 0.0]], [[0.0, 0.0], [0.0, 0.0]]])
    rebuilt = torch.tensor([[[0.0, 0.0], [1.0, 3.0]], [[0.0, 0.0], [0.0, 0.0]]])
    assert reconstruction_error(action, rebuilt).tolist() == [7.0, 0.0]


def test_samples_have_the_mean_and_spread_asked_for():
    noise = torch.randn(1, 100_000, 1, generator=torch.Generator().manual_seed(1))
    drawn = sample_latent(torch.full_like(noise, 2.0), torch.full_like(noise, 2 * math.log(3.0)), noise)
    assert drawn.mean().item() == pytest.approx(2.0, abs=0.05)
    assert drawn.std().item() == pytest.approx(3.0, abs=0.05)


@pytest.mark.parametrize("name", list(MODELS))
def test_the_loss_that_is_reported_is_the_models_equation(name, few):
    """The validation loss, computed again from what the model encodes and decodes."""
    unseen = {  # prices of what is not to be seen from outside
        "isometric": {"bend_weight": 0.0},
        "homogeneous": {"smoothness_weight": 0.0},
        "odd_cae": {"smoothness_weight": 0.0},
        "cae_jacobian": {"jacobian_weight": 0.0},
        "cvae_jacobian": {"jacobian_weight": 0.0},
        "low_turning": dict.fromkeys(
            ("smoothness_weight", "turning_weight", "spread_weight", "context_noise"), 0.0
        ),
    }
    model = MODELS[name](seeds=2, epochs=3, hidden=(8,), window=2, **unseen.get(name, {})).fit(few)
    pairs = make_pairs(few, 2, 0.0, "state", np.random.default_rng(0))
    validation = np.isin(pairs.episode, model.validation_episodes_)
    context, action = pairs.context[validation], pairs.action[validation]
    tensors = model.trained_.tensors
    speed = tensors["action.scale"]

    def error(wanted, given):
        return np.square((wanted - given) / speed).sum(-1).mean(-1)

    loss = error(action, model.decode(model.encode(context, action), context))
    if name in ("vae", "cvae", "cvae_jacobian"):
        seen = np.concatenate(
            [(context - tensors["context.centre"]) / tensors["context.scale"], action / speed], -1
        )
        hidden = seen @ tensors["encoder.0.weight"] + tensors["encoder.0.bias"]
        hidden = hidden / (1 + np.exp(-hidden))
        mu, log_variance = np.split(
            hidden @ tensors["encoder.1.weight"] + tensors["encoder.1.bias"], 2, axis=-1
        )
        kl = 0.5 * (mu**2 + np.exp(log_variance) - 1 - log_variance).sum(-1).mean(-1)
        loss = loss + model.kl_weight * kl
    if name == "cae_zero":
        at_rest = model.decode(np.zeros((len(context), 2)), context)
        loss = loss + model.zero_weight * error(0.0, at_rest)
    if name == "cae_reversal":
        z = model.encode(context, action)
        loss = loss + model.reversal_weight * error(model.decode(z, context), -model.decode(-z, context))
    np.testing.assert_allclose(model.validation_loss_, loss, rtol=1e-4)


def test_a_gaussian_dimension_that_says_nothing_is_dead_however_much_it_would_move():
    """Its posterior mean hardly leaves the prior's; scaling it up to span u would only span noise."""
    rng = np.random.default_rng(0)
    latents = rng.normal(size=(1, 500, 2)) * [1.0, 0.05]
    effect = np.full((1, 2), 0.5)
    assert find_collapsed(effect, latents, gaussian=True).tolist() == [[False, True]]
    assert find_collapsed(effect, latents, gaussian=False).tolist() == [[False, False]]
    assert find_collapsed(effect * [1.0, 0.001], latents, gaussian=False).tolist() == [[False, True]]
