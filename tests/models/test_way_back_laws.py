"""The laws of the way back for every kind of model, in 100,000 random contexts each."""

from dataclasses import replace

import numpy as np
import pytest

from latentarm.models.catalogue import KINDS
from latentarm.models.decoder import Decoder
from latentarm.models.estimators import MODELS
from latentarm.models.saved_chain import chain_tensors
from latentarm.models.tool_contexts import places_and_jacobian
from latentarm.models.way_back import training
from latentarm.models.way_back.runtime import DAMPING_M2, GATE_M, NETWORK, STRENGTH, metric_length
from latentarm.tasks.table_top import TableTop

CONTEXTS = 100_000
PROPORTIONAL = ("homogeneous", "low_turning", "scl")
ROUNDING = 2e-6
"""Of lengths near zero, by `NORM_FLOOR`, m/s."""

pytestmark = pytest.mark.slow


@pytest.fixture(scope="module")
def shown():
    return TableTop().demonstrate(10, np.random.default_rng(0))


@pytest.fixture(scope="module")
def way_back(shown):
    """Its tensors and sizes. It does not depend on the model that it is beside."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(training, "CONFIG", replace(training.CONFIG, epochs=4))
        trained = MODELS["pca"](way_back_m=0.06).fit(shown).trained_
    own = {name: one for name, one in trained.tensors.items() if name.startswith(NETWORK)}
    return own, trained.dimensions


@pytest.mark.parametrize("kind", list(KINDS))
def test_the_laws_hold_for_every_model(kind, shown, way_back):
    chain, limits, rng = TableTop().robot.chain, TableTop().robot.limits, np.random.default_rng(1)
    model = MODELS[kind](**({} if kind == "pca" else {"epochs": 1})).fit(shown)
    plain, (own, sizes) = model.trained_, way_back
    dimensions = replace(plain.dimensions, tools=sizes.tools, way_back=sizes.way_back)
    model.trained_ = replace(
        plain, dimensions=dimensions, tensors={**plain.tensors, **own, **chain_tensors(chain)}
    )
    alone, decoder = Decoder(plain), model.decoder()
    states = np.concatenate([one.state for one in shown.episodes])
    near = rng.choice(states, CONTEXTS // 2) + rng.normal(0.0, 0.1, (CONTEXTS // 2, 7))
    context = np.concatenate([near, rng.uniform(limits.lower, limits.upper, near.shape)])
    z = rng.uniform(-1.0, 1.0, (CONTEXTS, 2))

    action, person = decoder.decode(z, context), alone.decode(z, context)
    _, jacobian = places_and_jacobian(chain, context)
    length, of_person = (metric_length(jacobian, one)[:, 0] for one in (action, person))
    fastest = own[f"{NETWORK}.scale"][0] * np.linalg.norm(z, axis=1)
    np.testing.assert_array_equal(decoder.decode(0.0 * z, context), 0.0)
    assert (length <= fastest + ROUNDING).all()
    along = np.vecdot(np.matvec(jacobian, action), np.matvec(jacobian, person))
    along += DAMPING_M2 * np.vecdot(action, person)
    assert (along >= (1 - STRENGTH) / (1 + STRENGTH) * length * of_person - ROUNDING).all()

    beyond = metric_length(jacobian, decoder.way_back.pull(context)[0])[:, 0] >= 2.0 * GATE_M
    assert 0.1 < beyond.mean() < 0.9
    capped = person * np.minimum(1.0, fastest / of_person)[:, None]
    np.testing.assert_allclose(action[beyond], capped[beyond], rtol=0, atol=1e-12)
    if kind in PROPORTIONAL:
        np.testing.assert_allclose(decoder.decode(0.5 * z, context), 0.5 * action, rtol=1e-3, atol=1e-6)
