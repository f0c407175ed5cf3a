"""A gripper with parallel fingers or a jaw, as its manufacturer states it."""

from dataclasses import dataclass
from typing import final


@final
@dataclass(frozen=True)
class Gripper:
    """Parallel fingers that move by the same amount, or one jaw that turns.

    Attributes:
        joints: of its fingers in the robot's model; empty where the model does not contain it. Where they
            slide, fingers meet at zero, and each moves by its share of the opening.
        width_m: the largest opening, m.
        speed_m_s: the fastest change of the opening, m/s.
        force_n: the largest force with which the fingers press together, N.
        travel: where each joint that turns is when the gripper is closed and when it is open, rad; the
            opening is taken to grow evenly between them. Empty where fingers slide.
    """

    joints: tuple[str, ...]
    width_m: float
    speed_m_s: float
    force_n: float
    travel: tuple[tuple[float, float], ...] = ()

    @property
    def slides(self) -> tuple[str, ...]:
        """The joints of fingers that slide."""
        return () if self.travel else self.joints

    @property
    def closed(self) -> tuple[float, ...]:
        """Where each joint is when the gripper is closed, rad (m where it slides)."""
        return tuple(closed for closed, _ in self.travel) or (0.0,) * len(self.joints)

    @property
    def per_m(self) -> float:
        """How far the first joint moves for each m of its share of the opening, rad/m (1 where it slides)."""
        if not self.travel:
            return 1.0
        closed, opened = self.travel[0]
        return (opened - closed) * len(self.joints) / self.width_m
