"""Reads a `Chain` from a MuJoCo model."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import final

import mujoco
import numpy as np

from latentarm.core.errors import UserError
from latentarm.core.types import BoolArray, FloatArray, IntArray
from latentarm.robots.end_effector import followers
from latentarm.robots.kinematics.chain import Chain, Coupling, Frame

_HINGE = int(mujoco.mjtJoint.mjJNT_HINGE)
_SLIDE = int(mujoco.mjtJoint.mjJNT_SLIDE)
_EQ_CONNECT = int(mujoco.mjtEq.mjEQ_CONNECT)
_EQ_WELD = int(mujoco.mjtEq.mjEQ_WELD)
_SITE = int(mujoco.mjtObj.mjOBJ_SITE)


@final
@dataclass(frozen=True, eq=False)
class ModelChain:
    """A chain, and its parts in the model."""

    chain: Chain
    joints: IntArray  # (n,), the model's id of each joint of the chain
    link_joints: IntArray  # (L,), the model's id of the joint of each link; others than `joints` follow one
    rest: FloatArray  # (L,), where each link's joint is at q = 0, rad (m where it slides)
    body_link: IntArray  # (nbody,), link of each body, -1 for the base
    body_transform: FloatArray  # (nbody, 4, 4), body frame -> its link's frame, m
    # ids of the fixed bodies, without the world, that carry the first moving links
    base_bodies: tuple[int, ...]

    def model_positions(self, q: FloatArray) -> FloatArray:
        """Positions (L,) of the links' joints at positions (n,) of the arm's, rad (m where they slide)."""
        return self.chain.ratio @ q + self.rest


def read(model: mujoco.MjModel, end_effectors: Sequence[str]) -> ModelChain:
    """Read the joints between the world and the end-effectors, which are sites or bodies.

    Joints off that path (fingers, say) stay at the model's "home" key frame, or at its start if it has none.
    The base frame is the model's world frame.
    """
    tools = [_find(model, name) for name in end_effectors]
    joints, links, ratio, rest = _joints_on_the_way(model, [body for _, body, _ in tools])
    _check_open(model, links)
    index = {int(joint): link for link, joint in enumerate(links)}
    data = mujoco.MjData(model)
    data.qpos[:] = reference_positions(model)
    zero = model.qpos0[model.jnt_qposadr[joints]]
    link_zero = ratio @ zero + rest
    data.qpos[model.jnt_qposadr[links]] = link_zero
    mujoco.mj_kinematics(model, data)
    placed = _homogeneous(data.xpos, data.xmat)
    body_link = np.full(model.nbody, -1, dtype=np.int64)
    for body in range(1, model.nbody):
        body_link[body] = body_link[model.body_parentid[body]]
        for joint in _joints_of(model, body):
            body_link[body] = index.get(joint, int(body_link[body]))
    link_placed = placed[model.jnt_bodyid[links]]
    parent = np.empty(len(links), dtype=np.int64)
    offset = np.empty((len(links), 4, 4))
    axis = model.jnt_axis[links].copy()
    anchor = model.jnt_pos[links].copy()
    slide = model.jnt_type[links] == _SLIDE
    for link, joint in enumerate(links):
        body = model.jnt_bodyid[joint]
        siblings = [index[other] for other in _joints_of(model, body) if other in index and other < joint]
        parent[link] = siblings[-1] if siblings else body_link[model.body_parentid[body]]
        base = link_placed[parent[link]] if parent[link] >= 0 else np.eye(4)
        offset[link] = np.linalg.inv(base) @ link_placed[link]
    chain = Chain(
        joint_names=tuple(model.joint(int(joint)).name or f"joint{joint}" for joint in joints),
        parent=parent,
        # The model was placed at `zero`; the chain's zero displacement is at q = 0.
        offset=offset @ _displacement(axis, anchor, slide, rest - link_zero),
        axis=axis,
        anchor=anchor,
        slide=model.jnt_type[joints] == _SLIDE,
        tools=(),
        coupling=None if len(links) == len(joints) else Coupling(ratio, slide),
    )
    at_zero = chain.link_transforms(zero)
    carriers = np.where(body_link[:, None, None] >= 0, at_zero[body_link], np.eye(4))
    body_transform = np.linalg.inv(carriers) @ placed
    frames = tuple(Frame(name, int(body_link[at]), body_transform[at] @ local) for name, at, local in tools)
    return ModelChain(
        chain=replace(chain, tools=frames),
        joints=joints,
        link_joints=links,
        rest=rest,
        body_link=body_link,
        body_transform=body_transform,
        base_bodies=_base_bodies(model, body_link, [body for _, body, _ in tools]),
    )


def reference_positions(model: mujoco.MjModel) -> FloatArray:
    """(nq,), the model's "home" key frame, or its start."""
    key = mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_KEY, "home")
    return np.array(model.key_qpos[key] if key >= 0 else model.qpos0, dtype=np.float64)


def _find(model: mujoco.MjModel, name: str) -> tuple[str, int, FloatArray]:
    """Name, body and (4, 4) frame in that body of a site, or else of a body."""
    site = mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_SITE, name)
    if site >= 0:
        rotation = np.empty(9)
        mujoco.mju_quat2Mat(rotation, model.site_quat[site])
        local = _homogeneous(model.site_pos[site][None], rotation[None])[0]
        return name, int(model.site_bodyid[site]), local
    body = mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_BODY, name)
    if body >= 0:
        return name, body, np.eye(4)
    sites = [model.site(i).name for i in range(model.nsite) if model.site(i).name]
    bodies = [model.body(i).name for i in range(1, model.nbody) if model.body(i).name]
    known = ", ".join([*sites, *bodies][:40]) or "none"
    raise UserError(f"The robot's model has no site or body named {name!r}; it has: {known}.")


def _joints_of(model: mujoco.MjModel, body: int) -> range:
    first = int(model.body_jntadr[body])
    return range(first, first + int(model.body_jntnum[body]))


def _joints_on_the_way(
    model: mujoco.MjModel, bodies: Sequence[int]
) -> tuple[IntArray, IntArray, FloatArray, FloatArray]:
    """Ids of the joints to drive (n,), and of those that move links (L,), with their ratio and rest.

    A link's joint that follows another one is at ``ratio @ q + rest``; its leader is one of those to drive,
    wherever it is.
    """
    found: set[int] = set()
    for body in bodies:
        mine = _joints_above(model, body)
        if not mine:
            raise UserError(f"No joint moves {model.body(body).name!r}: name an end-effector that does move.")
        found |= mine
    for joint in sorted(found):
        if model.jnt_type[joint] not in (_HINGE, _SLIDE):
            kind = mujoco.mjtJoint(int(model.jnt_type[joint])).name.removeprefix("mjJNT_").lower()
            raise UserError(
                f"Joint {model.joint(joint).name or joint!r} is a {kind} joint: only hinge and slide joints"
                " can be driven between the world and the end-effector."
            )
    led = followers(model)
    rules = {joint: _rule(model, joint, led) for joint in found}
    links = sorted(found | {leader for leader, _, _ in rules.values()})
    joints = [joint for joint in links if joint not in led]
    ratio, rest = np.zeros((len(links), len(joints))), np.zeros(len(links))
    for link, joint in enumerate(links):
        leader, ratio_, rest[link] = rules.get(joint, (joint, 1.0, 0.0))
        ratio[link, joints.index(leader)] = ratio_
    return np.array(joints, dtype=np.int64), np.array(links, dtype=np.int64), ratio, rest


def _rule(model: mujoco.MjModel, joint: int, led: Mapping[int, int]) -> tuple[int, float, float]:
    """The joint that drives a joint, and the ratio and rest with which this one follows it."""
    ratio, rest, at, left = 1.0, 0.0, joint, dict(led)
    while at in left:
        equality = left.pop(at)
        leader, (shift, slope, *bends) = int(model.eq_obj2id[equality]), model.eq_data[equality, :5].tolist()
        in_a_ring = leader in led and leader not in left
        if leader < 0 or in_a_ring or not slope or any(bends):
            what = f"joint {model.joint(leader).name!r} in no fixed ratio" if leader >= 0 else "no joint"
            raise UserError(
                f"Joint {model.joint(at).name!r} follows {what}, so it cannot be driven: name an end-effector"
                " that it does not move."
            )
        here, there = (float(model.qpos0[model.jnt_qposadr[one]]) for one in (at, leader))
        rest += ratio * (here + shift - slope * there)
        ratio *= slope
        at = leader
    return at, ratio, rest


def _check_open(model: mujoco.MjModel, links: IntArray) -> None:
    moving = {int(joint) for joint in links}
    for i in np.flatnonzero(model.eq_active0):
        kind, first, second = int(model.eq_type[i]), int(model.eq_obj1id[i]), int(model.eq_obj2id[i])
        if kind in (_EQ_CONNECT, _EQ_WELD):
            if model.eq_objtype[i] == _SITE:
                first, second = int(model.site_bodyid[first]), int(model.site_bodyid[second])
            if model.body_mocapid[first] >= 0 or model.body_mocapid[second] >= 0:
                continue  # a handle for dragging the simulated arm, not part of it
            loop = (_joints_above(model, first) ^ _joints_above(model, second)) & moving
            if loop:
                raise UserError(
                    f"Joint {model.joint(min(loop)).name!r} is part of a closed chain (<equality>): only arms"
                    " whose joints move each by itself can be driven."
                )


def _joints_above(model: mujoco.MjModel, body: int) -> set[int]:
    found: set[int] = set()
    while body > 0:
        found.update(_joints_of(model, body))
        body = int(model.body_parentid[body])
    return found


def _base_bodies(model: mujoco.MjModel, body_link: IntArray, tools: Sequence[int]) -> tuple[int, ...]:
    found: set[int] = set()
    for body in tools:
        at = body
        while at > 0:
            if body_link[at] < 0:
                found.add(at)
            at = int(model.body_parentid[at])
    return tuple(sorted(found))


def _homogeneous(position: FloatArray, rotation: FloatArray) -> FloatArray:
    frames = np.zeros((len(position), 4, 4))
    frames[:, :3, :3] = rotation.reshape(-1, 3, 3)
    frames[:, :3, 3] = position
    frames[:, 3, 3] = 1.0
    return frames


def _displacement(axis: FloatArray, anchor: FloatArray, slide: BoolArray, by: FloatArray) -> FloatArray:
    """(n, 4, 4), motion of each link's frame when its joint moves by ``by``."""
    alone = Chain(
        joint_names=tuple(str(i) for i in range(len(by))),
        parent=np.full(len(by), -1, dtype=np.int64),
        offset=np.broadcast_to(np.eye(4), (len(by), 4, 4)),
        axis=axis,
        anchor=anchor,
        slide=slide,
        tools=(),
    )
    return alone.link_transforms(by)
