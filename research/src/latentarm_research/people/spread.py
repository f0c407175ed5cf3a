"""How a figure is spread over people."""

from abc import ABC, abstractmethod
from dataclasses import dataclass
from typing import final

import numpy as np
from scipy.special import ndtr, ndtri


@dataclass(frozen=True)
class Spread(ABC):
    """A distribution over people, cut off at both ends."""

    middle: float  # median before it is cut off
    width: float  # how wide it is; see the kinds
    lowest: float  # nobody has less
    highest: float  # nobody has more

    def at(
        self,
        quantile: float,  # in [0, 1]
    ) -> float:
        """What so large a share of people stay below."""
        low, high = ndtr(self._standard(self.lowest)), ndtr(self._standard(self.highest))
        value = self._figure(float(ndtri(low + quantile * (high - low))))
        return float(np.clip(value, self.lowest, self.highest))

    @property
    @abstractmethod
    def shape(self) -> str:
        """The distribution in words and figures, without its ends."""

    @abstractmethod
    def _standard(self, value: float) -> float:
        """A figure as a standard normal one."""

    @abstractmethod
    def _figure(self, standard: float) -> float:
        """The reverse."""


@final
class Normal(Spread):
    """Normal: `width` is the SD."""

    @property
    def shape(self) -> str:
        """See the base class."""
        return f"normal, {self.middle:.3g} ± {self.width:.3g}"

    def _standard(self, value: float) -> float:
        return (value - self.middle) / self.width

    def _figure(self, standard: float) -> float:
        return self.middle + self.width * standard


@final
class LogNormal(Spread):
    """Log-normal: `width` is the SD of the natural logarithm. The range is positive."""

    @property
    def shape(self) -> str:
        """See the base class."""
        return f"log-normal, median {self.middle:g}, SD of the logarithm {self.width:g}"

    def _standard(self, value: float) -> float:
        return float(np.log(value / self.middle)) / self.width

    def _figure(self, standard: float) -> float:
        return self.middle * float(np.exp(self.width * standard))
