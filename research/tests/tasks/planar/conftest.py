import numpy as np
import pytest

from latentarm_research.tasks.planar.catalogue import MOTIONS


@pytest.fixture(scope="module", params=MOTIONS)
def motion(request):
    """Each planar motion in turn."""
    return MOTIONS[request.param]()


@pytest.fixture(scope="module")
def shown(motion):
    """A few demonstrations of it."""
    return motion.demonstrate(6, np.random.default_rng(0))
