"""Finds a model's end-effector, and the joints that move it."""

import re
from dataclasses import dataclass
from typing import Final, final

import mujoco

from latentarm.core.errors import UserError

FINGER: Final = re.compile(r"finger|jaw|gripper|knuckle|thumb|claw", re.IGNORECASE)
"""Names of joints that open and close a gripper."""

FINGER_BODY: Final = re.compile(r"finger|jaw|knuckle|thumb|claw|mover", re.IGNORECASE)
"""Names of bodies that only a gripper's joint moves; "gripper" is often the whole hand."""

MOST_NAMED: Final = 12  # end-effectors in an error
_DRIVABLE: Final = (int(mujoco.mjtJoint.mjJNT_HINGE), int(mujoco.mjtJoint.mjJNT_SLIDE))
_JOINT: Final = int(mujoco.mjtEq.mjEQ_JOINT)


class AmbiguousEndEffectorError(UserError):
    """A model leaves several end-effectors to choose from."""

    def __init__(self, why: str, choices: str) -> None:
        super().__init__(f"{why}: name the end-effector with --end-effector, one of {choices}.")
        self.why = why  # why none was chosen, without a full stop
        self.choices = choices  # in words


@final
@dataclass(frozen=True)
class EndEffectorCandidate:
    """A site or body that could be the end-effector."""

    name: str
    joints: frozenset[int]  # ids of the arm's joints that move it
    fingers: frozenset[int]  # ids of a gripper's joints that move it


def choose_end_effector(model: mujoco.MjModel) -> str:
    """The only moving site, or else the only moving body without children.

    Every joint of the arm must move it, and none of a gripper's. If several qualify, or the only one leaves
    joints unused, raises AmbiguousEndEffectorError: the person must decide.
    """
    arm = arm_joints(model)
    if not arm and not finger_joints(model):
        others = [_joint_name(model, joint) for joint in range(model.njnt)]
        only = f": {', '.join(others)} can turn or move freely" if others else ""
        raise UserError(f"the model has no hinge or slide joint{only}, so nothing in it can be driven.")
    sites = [_moved(model, model.site(i).name, int(model.site_bodyid[i])) for i in range(model.nsite)]
    sites = [site for site in sites if site.joints or site.fingers]
    leaves = [
        leaf for leaf in (_moved(model, *leaf) for leaf in _leaves(model)) if leaf.joints or leaf.fingers
    ]
    choices = _choices(model, [*sites, *leaves])
    for found, what in ((sites, "site that moves"), (leaves, "last moving body")):
        if len(found) == 1 and found[0].name:
            (only,) = found
            if only.fingers:
                names = ", ".join(repr(_joint_name(model, joint)) for joint in sorted(only.fingers))
                why = (
                    f"{only.name!r}, the only {what}, is moved by {names}, which looks like a gripper's joint"
                )
                raise AmbiguousEndEffectorError(why, choices)
            if len(only.joints) < len(arm):
                why = f"only {len(only.joints)} of {len(arm)} joints move {only.name!r}, the only {what}"
                raise AmbiguousEndEffectorError(why, choices)
            return only.name
    raise AmbiguousEndEffectorError("several sites or bodies could be the end-effector", choices)


def arm_joints(model: mujoco.MjModel) -> frozenset[int]:
    """Ids of the joints that can be driven independently, without a gripper's."""
    joints = {joint for joint in range(model.njnt) if model.jnt_type[joint] in _DRIVABLE}
    return frozenset(joints - finger_joints(model) - set(followers(model)))


def finger_joints(model: mujoco.MjModel) -> frozenset[int]:
    """Ids of the joints that look like a gripper's, by their name or by that of the body they move."""
    return frozenset(
        joint
        for joint in range(model.njnt)
        if model.jnt_type[joint] in _DRIVABLE
        and (
            FINGER.search(model.joint(joint).name)
            or FINGER_BODY.search(model.body(int(model.jnt_bodyid[joint])).name)
        )
    )


def followers(model: mujoco.MjModel) -> dict[int, int]:
    """The equality by which each joint follows another (<mimic> in URDF, <equality><joint> in MJCF)."""
    return {
        int(model.eq_obj1id[i]): i
        for i in range(model.neq)
        if model.eq_type[i] == _JOINT and model.eq_active0[i]
    }


def _choices(model: mujoco.MjModel, found: list[EndEffectorCandidate]) -> str:
    """Candidates, those moved by the most joints first."""
    palms = {int(model.body_parentid[model.jnt_bodyid[joint]]) for joint in finger_joints(model)}
    found = [*found, *(_moved(model, model.body(palm).name, palm) for palm in sorted(palms))]
    named = {one.name: one for one in found if one.name and one.joints}
    ordered = sorted(named.values(), key=lambda one: (-len(one.joints), len(one.fingers), one.name))
    texts = [
        f"{one.name} ({_count(len(one.joints))}{' and a finger' if one.fingers else ''})" for one in ordered
    ]
    return (
        ", ".join([*texts[:MOST_NAMED], *(["..."] if len(texts) > MOST_NAMED else [])]) or "none with a name"
    )


def _count(joints: int) -> str:
    return f"{joints} joint{'' if joints == 1 else 's'}"


def _leaves(model: mujoco.MjModel) -> list[tuple[str, int]]:
    parents = {int(parent) for parent in model.body_parentid[1:]}
    return [(model.body(i).name, i) for i in range(1, model.nbody) if i not in parents]


def _moved(model: mujoco.MjModel, name: str, body: int) -> EndEffectorCandidate:
    joints: set[int] = set()
    while body > 0:
        first = int(model.body_jntadr[body])
        joints |= set(range(first, first + int(model.body_jntnum[body])))
        body = int(model.body_parentid[body])
    return EndEffectorCandidate(
        name, frozenset(joints) & arm_joints(model), frozenset(joints) & finger_joints(model)
    )


def _joint_name(model: mujoco.MjModel, joint: int) -> str:
    return str(model.joint(joint).name) or f"joint{joint}"
