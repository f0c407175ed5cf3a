"""sigma_h as a law: no input makes any decoder do more than its enclosure says, for every model."""

from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from latentarm.models.enclosure import Enclosure, curvature, linear_enclosure, network_enclosure
from latentarm.models.estimators import MODELS
from latentarm.models.numpy_networks import halve_hidden, propagate
from latentarm.testing.models import JOINTS, SMALL

CONTEXTS, INPUTS = 100, 1000
"""100,000 moments."""


@pytest.fixture(scope="module", params=list(MODELS))
def decoder(request, few):
    """Hardly trained: weights near their random start are as good as any here."""
    decoder = MODELS[request.param](**{**SMALL, "seeds": 1}).fit(few).decoder()
    if decoder.enclose(np.zeros(JOINTS)) is None:
        pytest.skip(f"no enclosure of {request.param} is known, so nothing is claimed about it")
    return decoder


def moments(d, seed=0):
    """Contexts near the demonstrations and far from them; inputs anywhere, at edges and at corners."""
    rng = np.random.default_rng(seed)
    context = rng.normal(scale=rng.choice([0.5, 1.0, 3.0], (CONTEXTS, 1)), size=(CONTEXTS, JOINTS))
    z = rng.uniform(-1, 1, (CONTEXTS, INPUTS, d))
    z[:, :200] /= np.abs(z[:, :200]).max(axis=-1, keepdims=True)
    z[:, 200:320] = np.sign(z[:, 200:320])
    return context, z


def test_no_input_in_100_000_moments_exceeds_sigma_h(decoder):
    context, z = moments(decoder.latent_dim)
    enclosure = decoder.enclose(context)
    done = decoder.decode(z, context[:, None])
    largest = np.linalg.norm(done, axis=-1).max(axis=1)
    sigma_h = enclosure.largest()
    assert (largest <= sigma_h).all()
    assert (decoder.enclose(context, 2).largest() >= largest).all()
    assert np.isfinite(sigma_h).all()
    # And in any one direction, as the certificate with the decoder known asks.
    way = np.random.default_rng(1).normal(size=(CONTEXTS, done.shape[-1]))
    assert (np.vecdot(done, way[:, None]).max(axis=1) <= enclosure.furthest(way)).all()


def test_one_moment_is_as_many_at_once(decoder):
    context, _ = moments(decoder.latent_dim)
    many, one = decoder.enclose(context[:3]).largest(), decoder.enclose(context[2]).largest()
    assert one == pytest.approx(many[2])


def layers_of(rng, widths, size):
    return [
        (size * rng.normal(size=(before, after)), size * rng.normal(size=after))
        for before, after in pairwise(widths)
    ]


@given(st.integers(0, 2**32 - 1), st.integers(1, 4), st.integers(0, 3), st.floats(0.05, 4.0))
def test_a_network_of_any_size_stays_in_its_enclosure(seed, d, hidden, size):
    rng = np.random.default_rng(seed)
    first, *rest = halve_hidden(layers_of(rng, [d, *[5] * hidden, 3], size))
    enclosure = network_enclosure(first[0], first[1], rest, 1)
    z = rng.uniform(-1, 1, (300, d))
    z[:100] = np.sign(z[:100])
    done = propagate(z @ first[0] + first[1], rest)
    assert np.linalg.norm(done, axis=-1).max() <= enclosure.largest()
    way = rng.normal(size=3)
    assert (done @ way).max() <= enclosure.furthest(way)


def test_finer_cells_leave_a_quarter_of_the_remainder():
    rng = np.random.default_rng(2)
    first, *rest = halve_hidden(layers_of(rng, [1, 12, 12, 3], 0.7))
    z = np.linspace(-1, 1, 4001)[:, None]
    most = np.linalg.norm(propagate(z @ first[0] + first[1], rest), axis=-1).max()
    slack = [network_enclosure(first[0], first[1], rest, fine).largest() - most for fine in (1, 2, 4)]
    assert slack[0] > 3 * slack[1] > 9 * slack[2] > 0


def test_a_linear_decoder_is_enclosed_exactly():
    """Columns (3, 4) and (0, -1), offset (1, 0): the corner (1, 1) gives (4, 3), (1, -1) gives (4, 5)."""
    enclosure = linear_enclosure(np.array([[3.0, 4.0], [0.0, -1.0]]), np.array([1.0, 0.0]))
    assert enclosure.largest() == pytest.approx(np.hypot(4.0, 5.0))
    assert enclosure.furthest(np.array([-1.0, 0.0])) == pytest.approx(2.0)
    assert enclosure.furthest(np.array([0.0, 1.0])) == pytest.approx(5.0)


def test_many_spreads_are_added():
    spread = np.ones((1, 9, 1))
    nothing = np.zeros((1, 1))
    assert Enclosure(nothing, spread, nothing).largest() == pytest.approx(9.0)


@given(st.floats(-6, 6), st.floats(0, 6))
def test_the_curvature_of_silu_is_bounded(centre, radius):
    h = np.linspace(centre - radius, centre + radius, 501)
    # s(h) = h + h tanh h; s'' by hand.
    second = 2.0 / np.cosh(h) ** 2 * (1.0 - h * np.tanh(h))
    assert np.abs(second).max() <= curvature(np.array(centre), np.array(radius)) + 1e-12
