"""Pose estimate of one thing, and its update by sightings."""

import math
from dataclasses import dataclass, replace
from typing import Final, final

import numpy as np
from scipy.spatial.transform import Rotation

from latentarm.core.types import FloatArray, Pose
from latentarm.robots.kinematics.rotations import rotation_vector
from latentarm.surroundings.contract import Sighting

GATE: Final = 4.0
"""Standard deviations that a sighting may be off: beyond lie 0.1 % of errors in three coordinates."""

DRIFT_M_S: Final = 0.02
DRIFT_RAD_S: Final = 0.1
"""Growth of the standard deviations with age."""

MOVED_M_S: Final = 0.1
MOVED_RAD_S: Final = 0.5
MOST_MOVED_S: Final = 0.5
"""Things that nobody holds may move so fast, and after this time nobody believes more motion unconfirmed."""


@final
@dataclass(frozen=True, eq=False)
class PoseEstimate:
    """Estimated pose of a thing at the time of its newest sighting."""

    pose: Pose
    position_sd_m: float
    orientation_sd_rad: float
    time_s: float  # of that sighting, on the loop's clock
    hold_s: float  # how long it counts
    source: str  # that gave it

    @staticmethod
    def of(sighting: Sighting, source: str, hold_s: float) -> "PoseEstimate":
        """The estimate from a single sighting."""
        sd_m, sd_rad = sighting.position_sd_m, sighting.orientation_sd_rad
        return PoseEstimate(sighting.pose, sd_m, sd_rad, sighting.time_s, hold_s, source)

    def away(self, pose: Pose) -> float:
        """Distance to another pose, m."""
        return float(np.linalg.norm(pose.position - self.pose.position))

    def counts(self, now_s: float) -> bool:
        """Whether it is new enough to be used."""
        return now_s - self.time_s <= self.hold_s

    def agrees(self, sighting: Sighting) -> bool:
        """Whether a sighting is no farther off than both errors and a plausible motion allow."""
        moving_s = min(abs(sighting.time_s - self.time_s), MOST_MOVED_S)
        sd_m = math.hypot(self.position_sd_m, sighting.position_sd_m)
        sd_rad = math.hypot(self.orientation_sd_rad, sighting.orientation_sd_rad)
        turned = float(np.linalg.norm(self._turn(sighting)))
        return (
            self.away(sighting.pose) <= GATE * sd_m + MOVED_M_S * moving_s
            and turned <= GATE * sd_rad + MOVED_RAD_S * moving_s
        )

    def joined(self, sighting: Sighting, source: str, hold_s: float) -> "PoseEstimate":
        """Both weighted by their inverse variances: the surer counts more, and an older estimate less.

        It holds as long as the newer of both does, and by the source of the newer.
        """
        age_s = max(sighting.time_s - self.time_s, 0.0)
        older_m = math.hypot(self.position_sd_m, DRIFT_M_S * age_s)
        older_rad = math.hypot(self.orientation_sd_rad, DRIFT_RAD_S * age_s)
        share, sd_m = _weighed(older_m, sighting.position_sd_m)
        turned, sd_rad = _weighed(older_rad, sighting.orientation_sd_rad)
        before = self.pose
        pose = Pose(
            before.position + share * (sighting.pose.position - before.position),
            Rotation.from_rotvec(turned * self._turn(sighting)).as_matrix() @ before.rotation,
        )
        if sighting.time_s < self.time_s:
            return replace(self, pose=pose, position_sd_m=sd_m, orientation_sd_rad=sd_rad)
        return PoseEstimate(pose, sd_m, sd_rad, sighting.time_s, hold_s, source)

    def _turn(self, sighting: Sighting) -> FloatArray:
        return rotation_vector(sighting.pose.rotation @ self.pose.rotation.T)


def _weighed(believed: float, seen: float) -> tuple[float, float]:
    """The share of a sighting in the mean, and the standard deviation of the mean."""
    share = believed**2 / (believed**2 + seen**2)
    return share, believed * math.sqrt(1.0 - share)
