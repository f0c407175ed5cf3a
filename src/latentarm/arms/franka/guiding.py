"""Guiding a Franka by hand: torque control without stiffness; the arm carries its own weight."""

from typing import Any, Final, Literal, final

import numpy as np

from latentarm.arms.franka.limits import FrankaLimits
from latentarm.arms.franka.link import Link
from latentarm.core.types import FloatArray

LASTS_S: Final = 1.0  # the arm comes to rest if guiding is not renewed within this time
_RENEWED_S: Final = 0.4
_DAMPING: Final = (1.0, 1.0, 1.0, 1.0, 0.5, 0.5, 0.5)
"""N m s/rad, against the hand, so that a released arm comes to rest."""


@final
class Guiding:
    """Guiding for the arm's worker, in its thread.

    Franky's control thread bounds each motion, at 1 kHz: if the worker does not renew it, a
    `TorqueStopMotion` brings the arm to rest, and it then holds its position. Near the ends of its joints it
    pushes back.
    """

    def __init__(self, franky: Any, limits: FrankaLimits) -> None:
        self._franky, self._limits = franky, limits
        self._began_s = 0.0
        self.phase: Literal["no", "on", "ending"] = "no"

    def follow(self, link: Link, q: FloatArray, now_s: float, *, wanted: bool) -> None:
        """Begin, renew or end guiding; joints are at ``q``, (7,), rad."""
        if wanted and (self.phase == "no" or (self.phase == "on" and now_s - self._began_s > _RENEWED_S)):
            link.arm.move(self._motion(q), asynchronous=True)
            self.phase, self._began_s = "on", now_s
        elif not wanted and self.phase == "on":
            link.arm.move(self._franky.TorqueStopMotion(), asynchronous=True)
            self.phase = "ending"

    def ended(self, link: Link) -> bool:
        """True once the arm has ended guiding by itself and rests. Raises what franky raised meanwhile."""
        if self.phase == "no" or not link.arm.join_motion(timeout=0.0):
            return False
        by_itself, self.phase = self.phase == "on", "no"
        return by_itself

    def _motion(self, q: FloatArray) -> Any:
        franky = self._franky
        motion = franky.JointImpedanceMotion(
            q,
            stiffness=np.zeros(7),
            damping=np.array(_DAMPING),
            lower_joint_limits=self._limits.lower,
            upper_joint_limits=self._limits.upper,
        )
        runs_out = franky.Measure.REL_TIME >= LASTS_S
        motion.add_reaction(franky.TorqueReaction(runs_out, franky.TorqueStopMotion()))
        return motion
