import numpy as np
import pytest

from latentarm.tasks.table_top import TableTop


@pytest.fixture(scope="session")
def table_top():
    return TableTop()


@pytest.fixture(scope="session")
def shown(table_top):
    """Sixty demonstrations: every goal and manner ten times."""
    return table_top.demonstrate(60, np.random.default_rng(0))
