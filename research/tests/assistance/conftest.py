import numpy as np
import pytest

from latentarm.assistance.catalogue import BELIEFS


@pytest.fixture(params=sorted(BELIEFS))
def rule(request):
    return BELIEFS[request.param]


@pytest.fixture
def rng():
    return np.random.default_rng(0)
