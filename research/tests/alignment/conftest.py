import pytest
import torch

from aligned_arms import answered, arm, circles, columns, curved_model, linear_model, slides, swings

__all__ = ["answered", "arm", "circles", "columns", "curved_model", "linear_model", "slides", "swings"]


@pytest.fixture(autouse=True, scope="session")
def one_thread():
    torch.set_num_threads(1)
