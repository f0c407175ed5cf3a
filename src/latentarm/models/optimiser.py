"""Adam on one flat buffer."""

import math
from typing import Final, final

import torch
from torch import Tensor

FIRST_DECAY: Final = 0.9
SECOND_DECAY: Final = 0.999
EPSILON: Final = 1e-8
FINAL_RATE: Final = 0.01  # the learning rate ends at this share of where it began


def falling_rate(initial: float, done: int, total: int) -> float:
    """Half a cosine from the initial learning rate to `FINAL_RATE` of it, when ``done`` is ``total``."""
    fall = (1 + math.cos(math.pi * done / total)) / 2
    return initial * (FINAL_RATE + (1 - FINAL_RATE) * fall)


@final
class FlatAdam:
    """Adam (Kingma and Ba, 2015) for one buffer that holds every weight of every seed.

    The same arithmetic as ``torch.optim.Adam``. That one costs 80-200 us a step in bookkeeping over a dozen
    small tensors, as much as a forward pass of these networks; this one costs 20-40 us.
    """

    def __init__(self, values: Tensor) -> None:
        self.first = torch.zeros_like(values)
        self.second = torch.zeros_like(values)
        self.steps = 0
        self._size = torch.empty_like(values)

    def step(self, values: Tensor, gradient: Tensor, learning_rate: float) -> None:
        """Move ``values`` one step against ``gradient``, in place."""
        self.steps += 1
        self.first.lerp_(gradient, 1 - FIRST_DECAY)
        self.second.mul_(SECOND_DECAY).addcmul_(gradient, gradient, value=1 - SECOND_DECAY)
        # The corrections of both means, m / c_1 and v / c_2, as numbers: no passes over the buffer for them.
        first_correction = 1 - FIRST_DECAY**self.steps
        root = math.sqrt(1 - SECOND_DECAY**self.steps)
        size = torch.sqrt(self.second, out=self._size).add_(EPSILON * root)
        values.addcdiv_(self.first, size, value=-learning_rate * root / first_correction)
