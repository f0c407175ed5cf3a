"""Clearance between the arm and everything else, itself included."""

from typing import final

import numpy as np

from latentarm.control.safety.bounds import BUFFER_M
from latentarm.control.safety.filter import SafetyFilter, Situation
from latentarm.control.safety.halfspaces import slide, unbent
from latentarm.control.safety.small import smallest
from latentarm.types import FloatArray


@final
class Clearance(SafetyFilter):
    """Limits the speed towards obstacles, and of the arm towards itself, by the remaining distance.

    Where a distance is already too small, only motion that does not reduce it is allowed.
    """

    @property
    def name(self) -> str:
        """See the base class."""
        return "clearance"

    def apply(self, velocity: FloatArray, situation: Situation) -> FloatArray:
        """See the base class."""
        contacts = situation.contacts(np.abs(velocity))
        if not contacts.pair.size:
            return velocity
        bounds, proximity = situation.bounds, situation.surroundings.proximity
        height = contacts.height
        if not contacts.fresh:
            height = proximity.heights(contacts, np.zeros(bounds.dof))
            if smallest(height.ravel()) <= bounds.nearest_m:
                # This close to the limit, a slightly conservative bound would block motion.
                contacts = situation.contacts_now()
                if not contacts.pair.size:
                    return velocity
                height = contacts.height
        rows = contacts.row.reshape(-1, bounds.dof)
        room = np.maximum(height.ravel() - bounds.config.clearance, 0.0)
        floor = -bounds.damping_per_s * np.maximum(room - BUFFER_M, 0.0)
        velocity = slide(velocity, rows, floor, room == 0.0)
        speed = np.abs(velocity)
        bend = proximity.curvature[contacts.pair] @ speed @ speed
        share = unbent(velocity, rows, room, np.repeat(bend, 2), bounds.reach_s)
        return velocity if share == 1.0 else share * velocity
