"""A simulated person who pushes the stick less far than they could."""

from dataclasses import dataclass
from typing import final

import numpy as np

from latentarm.core.errors import UserError
from latentarm.core.types import FloatArray
from latentarm_research.people.loop_limits import LoopLimits


@final
@dataclass(frozen=True)
class OwnSpeed:
    """How fast a simulated person likes to go.

    Raises:
        UserError: the share is out of its range.
    """

    share: float = 1.0  # of the speed of somebody who pushes as far as it takes, in (0, 1]

    def __post_init__(self) -> None:
        if not 0 < self.share <= 1:
            raise UserError(f"A person's own speed must be a share in (0, 1], not {self.share}.")

    def pushed(self, u: FloatArray, limits: LoopLimits) -> FloatArray:
        """Where they push the stick (d,), where somebody who goes full speed would push it to u (d,).

        Pushes shrink in proportion beyond the dead zone, so that what is a push remains one.
        """
        if self.share == 1.0 or not limits.is_push(u):
            return u
        length = float(np.linalg.norm(u))
        return u * ((limits.dead_zone + self.share * (length - limits.dead_zone)) / length)
