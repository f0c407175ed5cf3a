"""What the arm may not pass, all of it at once: joint limits, things, itself, the workspace."""

from dataclasses import dataclass
from typing import final

import numpy as np

from latentarm.core.types import FloatArray
from latentarm.safety.bounds import BUFFER_M, BUFFER_RAD, MAY_BEND_M
from latentarm.safety.filter import Situation
from latentarm.safety.halfspaces import slide, unbent
from latentarm.safety.small import largest, smallest, some


@final
@dataclass(frozen=True, slots=True, eq=False)
class Distances:
    """C distances of one kind that a velocity may not reduce too fast.

    Attributes:
        kind: what the person is told when they have changed a command.
        rows: (C, n), how joint velocities change them, m/s per rad/s.
        room: (C,), what each may still lose, m.
        curvature: (C, n, n), bound of their second derivatives, see `Body`.
    """

    kind: str
    rows: FloatArray
    room: FloatArray
    curvature: FloatArray


def past_barriers(velocity: FloatArray, situation: Situation, limited_by: list[str]) -> FloatArray:
    """Slow a velocity down before it passes a barrier, and keep what leads along it.

    The speed towards a barrier is at most the distance left times ``damping_per_s``, which ordinary motion
    can follow. Past it the arm may only move back. One after the other, what slides along one barrier could
    lead past another, and in their corner the guard would let nothing pass: so all of them count at once.

    Args:
        velocity: (n,), rad/s, within the joints' speeds.
        situation: what is known at this tick.
        limited_by: gets the names of what changed something.

    Returns:
        (n,), rad/s, ``velocity`` itself where nothing had to change.
    """
    bounds = situation.bounds
    near = [kind for kind in (_contacts(velocity, situation), _faces(situation)) if kind is not None]
    free = (situation.nearest_limit - BUFFER_RAD) * bounds.damping_per_s >= largest(np.abs(velocity))
    if free and not near:
        return velocity
    down = np.minimum((situation.room[0] + BUFFER_RAD) * bounds.damping_per_s, 0.0)
    up = np.maximum((situation.room[1] - BUFFER_RAD) * bounds.damping_per_s, 0.0)
    rows = np.concatenate([np.zeros((0, bounds.dof)), *(kind.rows for kind in near)])
    room = np.concatenate([np.zeros(0), *(kind.room for kind in near)])
    floor = -bounds.damping_per_s * np.maximum(room - BUFFER_M, 0.0)
    slid, acting = slide(velocity, (down, up), rows, floor, room <= 0.0)
    if some(acting[: bounds.dof]):
        limited_by.append("joint position")
    size, share, first = np.abs(slid), 1.0, bounds.dof
    for kind in near:
        first, after = first + len(kind.room), first
        bend = kind.curvature @ size @ size
        slow = unbent(slid, kind.rows, np.maximum(kind.room, MAY_BEND_M), bend, bounds.reach_s)
        if slow < 1.0 or some(acting[after:first]):
            limited_by.append(kind.kind)
        share = min(share, slow)
    return slid if share == 1.0 else share * slid


def _contacts(velocity: FloatArray, situation: Situation) -> Distances | None:
    """Distances to obstacles, and of the arm to itself."""
    bounds, proximity = situation.bounds, situation.surroundings.proximity
    contacts = situation.contacts(np.abs(velocity))
    if not contacts.pair.size:
        return None
    height = contacts.height if contacts.fresh else proximity.heights(contacts, np.zeros(bounds.dof))
    if not contacts.fresh and smallest(height.ravel()) <= bounds.nearest_m:
        # This close to the limit, a slightly conservative bound would block motion.
        contacts = situation.contacts_now()
        height = contacts.height
    curvature = np.repeat(proximity.curvature[contacts.pair], 2, axis=0)
    room = height.ravel() - bounds.config.clearance
    return Distances("clearance", contacts.row.reshape(-1, bounds.dof), room, curvature)


def _faces(situation: Situation) -> Distances | None:
    """Distances to the faces of the workspace box."""
    bounds, workspace = situation.bounds, situation.bounds.config.workspace
    if workspace is None:
        return None
    points = situation.placement.points
    # Room to the lower faces, then to the upper ones: (2, P, 3).
    room = np.stack([points - workspace.lower, workspace.upper - points])
    face, point, axis = near = np.nonzero(room < BUFFER_M + bounds.config.link_speed * bounds.horizon_s)
    if not len(face):
        return None
    rows = situation.placement.jacobian[:, axis, point].T * (1.0 - 2.0 * face)[:, None]
    return Distances("workspace", rows, room[near], situation.surroundings.body.point_curvature[point])
