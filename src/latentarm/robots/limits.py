"""What a robot's joints can do: its hardware limits."""

from dataclasses import dataclass, fields
from typing import final

import numpy as np

from latentarm.errors import UserError
from latentarm.types import FloatArray


@final
@dataclass(frozen=True, eq=False)
class JointLimits:
    """Hardware limits of n joints; a limit that is not a limit is refused at construction.

    Prismatic joints have the same fields in m instead of rad.

    Attributes:
        lower: (n,), lowest position, rad.
        upper: (n,), highest position, rad.
        velocity: (n,), largest speed, rad/s.
        acceleration: (n,), largest acceleration, rad/s².
        jerk: (n,), largest jerk, rad/s³.

    Raises:
        UserError: a limit is missing, not finite, not positive, or lower is not below upper.
    """

    lower: FloatArray
    upper: FloatArray
    velocity: FloatArray
    acceleration: FloatArray
    jerk: FloatArray

    def __post_init__(self) -> None:
        for field in fields(self):
            given = np.asarray(getattr(self, field.name))
            if given.dtype.kind not in "iuf":
                raise UserError(f"The joint limits' {field.name} must be numbers.")
            value = np.array(given, dtype=np.float64)
            if value.ndim != 1 or value.shape != np.shape(self.lower):
                raise UserError(
                    f"The joint limits' {field.name} has shape {value.shape}: give one figure for each joint,"
                    " as many as for lower."
                )
            for joint in np.flatnonzero(~np.isfinite(value)):
                raise UserError(
                    f"The limit {field.name} of joint {joint + 1} is {value[joint]}: give a finite one."
                )
            value.flags.writeable = False
            object.__setattr__(self, field.name, value)
        for joint in np.flatnonzero(self.lower >= self.upper):
            raise UserError(
                f"Joint {joint + 1} may move from {self.lower[joint]:g} to {self.upper[joint]:g}:"
                " its lower limit must be below its upper limit."
            )
        for name in ("velocity", "acceleration", "jerk"):
            value = getattr(self, name)
            for joint in np.flatnonzero(value <= 0.0):
                raise UserError(
                    f"The limit {name} of joint {joint + 1} is {value[joint]:g}: it must be above zero."
                )

    @property
    def dof(self) -> int:
        """Number of joints n."""
        return len(self.lower)

    def violation(self, q: FloatArray) -> FloatArray:
        """How far positions lie outside the limits.

        Args:
            q: (..., n), rad.

        Returns:
            (..., n), rad, zero inside.
        """
        return np.maximum(np.maximum(self.lower - q, q - self.upper), 0.0)
