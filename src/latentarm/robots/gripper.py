"""A gripper with parallel fingers or a jaw, by its manufacturer's figures."""

from dataclasses import dataclass
from typing import final


@final
@dataclass(frozen=True)
class Gripper:
    """Parallel fingers that move by the same amount, or one jaw that turns."""

    # Of its fingers in the robot's model; empty where the model lacks it. Sliding fingers meet at zero, and
    # each moves by its share of the opening.
    joints: tuple[str, ...]
    width_m: float  # largest opening, m
    speed_m_s: float  # largest rate of the opening, m/s
    force_n: float  # largest force between the fingers, N
    # Closed and open position of each turning joint, rad; the opening is assumed to grow evenly between them.
    # Empty where fingers slide.
    travel: tuple[tuple[float, float], ...] = ()

    @property
    def slides(self) -> tuple[str, ...]:
        """Joints of sliding fingers."""
        return () if self.travel else self.joints

    @property
    def closed(self) -> tuple[float, ...]:
        """Position of each joint with the gripper closed, rad (m where it slides)."""
        return tuple(closed for closed, _ in self.travel) or (0.0,) * len(self.joints)

    @property
    def per_m(self) -> float:
        """Travel of the first joint per m of its share of the opening, rad/m (1 where it slides)."""
        if not self.travel:
            return 1.0
        closed, opened = self.travel[0]
        return (opened - closed) * len(self.joints) / self.width_m
