"""The box that the arm stays in."""

from typing import final

import numpy as np

from latentarm.control.safety.bounds import BUFFER_M
from latentarm.control.safety.filter import SafetyFilter, Situation
from latentarm.control.safety.halfspaces import slide, unbent
from latentarm.types import FloatArray


@final
class WorkspaceBox(SafetyFilter):
    """Damps motion towards the faces of the workspace box; without a box it changes nothing."""

    @property
    def name(self) -> str:
        """See the base class."""
        return "workspace"

    def apply(self, velocity: FloatArray, situation: Situation) -> FloatArray:
        """See the base class."""
        bounds = situation.bounds
        workspace = bounds.config.workspace
        if workspace is None:
            return velocity
        points = situation.placement.points
        # Room to the lower faces, then to the upper ones: (2, P, 3).
        room = np.stack([points - workspace.lower, workspace.upper - points])
        near = np.nonzero(room < BUFFER_M + bounds.config.link_speed * bounds.horizon_s)
        if not len(near[0]):
            return velocity
        face, point, axis = near
        outward = 1.0 - 2.0 * face
        rows = situation.placement.jacobian[:, axis, point].T * outward[:, None]
        left = np.maximum(room[near], 0.0)
        floor = -bounds.damping_per_s * np.maximum(left - BUFFER_M, 0.0)
        velocity = slide(velocity, rows, floor, left == 0.0)
        speed = np.abs(velocity)
        bend = situation.surroundings.body.point_curvature[point] @ speed @ speed
        share = unbent(velocity, rows, left, bend, bounds.reach_s)
        return velocity if share == 1.0 else share * velocity
