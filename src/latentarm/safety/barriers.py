"""The barriers that the arm may not pass, all at once: joint limits, things, itself, the workspace."""

from dataclasses import dataclass
from typing import TYPE_CHECKING, final

import numpy as np

from latentarm.core.types import FloatArray
from latentarm.safety.halfspaces import slide, unbent, within
from latentarm.safety.limits import BUFFER_M, BUFFER_RAD, MAY_BEND_M
from latentarm.safety.small import any_nonzero, largest, smallest

if TYPE_CHECKING:
    from latentarm.safety.filter import Situation

_HELD = (
    1000.0  # weighs the squared twist of what is held, in m/s and rad/s, against that of the joints, rad/s
)
_TURN_M = 0.3  # at a joint's limit a turn of the tool by 1 rad counts as much as a way of this length, m


@final
@dataclass(frozen=True, slots=True, eq=False)
class Distances:
    """C distances of one kind that a velocity may not reduce too fast."""

    kind: str  # the name that `Passed.limited_by` gets
    rows: FloatArray  # (C, n), m/s per rad/s: how joint velocities change them
    room: FloatArray  # (C,), m: what each may still lose
    curvature: FloatArray  # (C, n, n): bound of their second derivatives, see `Body`


def past_barriers(velocity: FloatArray, situation: "Situation", limited_by: list[str]) -> FloatArray:
    """Slow a velocity (n,), rad/s, before it passes a barrier, and keep its part along the barrier.

    The speed towards a barrier is at most the distance left times ``damping_per_s``, which ordinary motion
    can follow. Past it the arm may only move back. All barriers count at once, because sliding along one
    could lead past another, and in their corner the guard would let nothing pass.

    ``limited_by`` gets the names of the barriers that act; without any, ``velocity`` itself is returned.
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
    others = velocity if free else within(velocity, (down, up), _way(situation))
    slid, acting = slide(others, (down, up), rows, floor, room <= 0.0, _metric(situation))
    if others is not velocity or any_nonzero(acting[: bounds.dof]):
        limited_by.append("joint position")
    size, share, first = np.abs(slid), 1.0, bounds.dof
    for kind in near:
        first, after = first + len(kind.room), first
        bend = kind.curvature @ size @ size
        slow = unbent(slid, kind.rows, np.maximum(kind.room, MAY_BEND_M), bend, bounds.reach_s)
        if slow < 1.0 or any_nonzero(acting[after:first]):
            limited_by.append(kind.kind)
        share = min(share, slow)
    return slid if share == 1.0 else share * slid


def _way(situation: "Situation") -> FloatArray:
    """(n, n), how the size of a change of a velocity counts at the limit of a joint.

    Were that joint alone slowed, the tool would leave its way. So the others keep tools on their way.
    """
    dof, ends = situation.bounds.dof, 2 * situation.surroundings.body.count
    tools = situation.placement.jacobian[:, :, ends:]
    way, turn = tools[:, :3].reshape(dof, -1) / _TURN_M, tools[:, 3:].reshape(dof, -1)
    metric = np.eye(dof) + _HELD * (way @ way.T + turn @ turn.T)
    return metric / metric.trace()


def _metric(situation: "Situation") -> FloatArray:
    """(n, n), how the size of a change of a velocity counts.

    The joints' nearest velocity along a table turns the hand: a cup would tilt, not come down. So what
    is held is kept on its way rather than the joints.
    """
    body, still = situation.surroundings.body, np.eye(situation.bounds.dof)
    if not body.held.any():
        return still
    tool = situation.placement.jacobian[:, :, 2 * body.count]
    metric = still + _HELD * tool @ tool.T
    return metric / metric.trace()


def _contacts(velocity: FloatArray, situation: "Situation") -> Distances | None:
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


def _faces(situation: "Situation") -> Distances | None:
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
