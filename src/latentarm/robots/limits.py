"""Limits of a robot's joints, and the source of each figure."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Final, Literal, final

import numpy as np

from latentarm.core.errors import UserError
from latentarm.core.types import FloatArray

Source = Literal["model", "manufacturer", "limits_file", "assumed"]  # source of a limit
Quantity = Literal["position", "velocity", "acceleration", "jerk"]
QUANTITIES: Final[tuple[Quantity, ...]] = ("position", "velocity", "acceleration", "jerk")
LIMIT_NAMES: Final = ("lower", "upper", "velocity", "acceleration", "jerk")


LimitSources = Mapping[Quantity, tuple[Source, ...]]
"""Sources of the limits of n joints, "assumed" where not named; ``position`` is for lower and upper."""


def same_source(source: Source, dof: int) -> LimitSources:
    """One source for every limit of every joint."""
    return dict.fromkeys(QUANTITIES, (source,) * dof)


@final
@dataclass(frozen=True, eq=False)
class JointLimits:
    """Limits of n joints, validated at construction. Sliding joints have m instead of rad."""

    lower: FloatArray  # (n,), rad
    upper: FloatArray  # (n,), rad
    velocity: FloatArray  # (n,), rad/s
    acceleration: FloatArray  # (n,), rad/s²
    jerk: FloatArray  # (n,), rad/s³
    sources: LimitSources = field(default_factory=dict[Quantity, tuple[Source, ...]])

    def __post_init__(self) -> None:
        for name in LIMIT_NAMES:
            given = np.asarray(getattr(self, name))
            if given.dtype.kind not in "iuf":
                raise UserError(f"The joint limits' {name} must be numbers.")
            value = np.array(given, dtype=np.float64)
            if value.ndim != 1 or value.shape != np.shape(self.lower):
                raise UserError(
                    f"The joint limits' {name} has shape {value.shape}: give one figure for each joint,"
                    " as many as for lower."
                )
            for joint in np.flatnonzero(~np.isfinite(value)):
                raise UserError(
                    f"The limit {name} of joint {joint + 1} is {value[joint]}: give a finite one."
                )
            value.flags.writeable = False
            object.__setattr__(self, name, value)
        sources = {**same_source("assumed", self.dof), **self.sources}
        for quantity, each in sources.items():
            if len(each) != self.dof:
                raise UserError(
                    f"The sources of the joint limits' {quantity} are {len(each)}: give one for each joint."
                )
        object.__setattr__(self, "sources", sources)
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

    @property
    def assumed(self) -> dict[Quantity, tuple[int, ...]]:
        """Joints with assumed limits, by quantity, for quantities that have any."""
        found: dict[Quantity, tuple[int, ...]] = {
            one: tuple(joint for joint, source in enumerate(self.sources[one]) if source == "assumed")
            for one in QUANTITIES
        }
        return {quantity: joints for quantity, joints in found.items() if joints}

    def violation(self, q: FloatArray) -> FloatArray:
        """Distance of positions (..., n) beyond the limits, rad, zero inside."""
        return np.maximum(np.maximum(self.lower - q, q - self.upper), 0.0)
