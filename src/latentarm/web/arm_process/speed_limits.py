"""Limits of speed on the page: the safety limits, or lower ones."""

import math
from dataclasses import dataclass
from typing import Final, Self, final

from latentarm.core.errors import UserError
from latentarm.safety.config import SafetyConfig

SLOWEST: Final = 0.01  # a slower arm hardly moves, rad/s or m/s


@final
@dataclass(frozen=True)
class Speeds:
    """Limits of speed. Raises UserError if one is higher than the safety limits allow, or hardly a motion."""

    joint: float = SafetyConfig.joint_speed  # of joints that turn, rad/s
    link: float = SafetyConfig.link_speed  # of any point of the arm, and of joints that slide, m/s

    def __post_init__(self) -> None:
        _check("--joint-speed", self.joint, SafetyConfig.joint_speed, "rad/s")
        _check("--link-speed", self.link, SafetyConfig.link_speed, "m/s")

    @classmethod
    def asked(cls, joint: float | None, link: float | None) -> Self:
        """Limits with the usual ones for None."""
        usual = cls()
        return cls(usual.joint if joint is None else joint, usual.link if link is None else link)


def _check(option: str, value: float, most: float, unit: str) -> None:
    if not (math.isfinite(value) and SLOWEST <= value <= most):
        raise UserError(f"{option} is {value:g} {unit}: it must be from {SLOWEST:g} to {most:g} {unit}.")
