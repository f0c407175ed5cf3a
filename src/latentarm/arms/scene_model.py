"""A scene in a MuJoCo model: the table, things, food, bonds and grains about an arm."""

from typing import Final

import mujoco
import numpy as np
from scipy.spatial.transform import Rotation

from latentarm.core.types import FloatArray
from latentarm.robots.parts import add_parts
from latentarm.robots.scene.scene import TABLE, Scene
from latentarm.robots.scene.thing import Bond, Grains, Thing
from latentarm.robots.tines import TINES_BODY

SOLID: Final = 1  # bit of everything that collides with solids
TINE: Final = 2  # bit of tines: a thing without it lets them in
_GRAIN_DRAG_S: Final = 0.1  # a grain that nothing touches loses its speed within this time, s
_ROLLING: Final = (0.005, 0.0001)  # friction against turning on the spot and against rolling, m
_STIFF: Final = (0.005, 1.0)
"""A thing at 1 m/s enters another by 2 mm, less than a wall's thickness; with MuJoCo's 0.02 by 7 mm."""

_TABLE_FRICTION: Final = (0.8, 0.005, 0.0001)
_TABLE_COLOUR: Final = (0.72, 0.66, 0.58, 1.0)
_DRAWN_HALF_M: Final = 2.0
_SLEEP_TOLERANCE_M_S: Final = 2e-3


def thing_body(name: str) -> str:
    """Name of a thing's body in the model; its frame is the thing's."""
    return f"thing {name}"


def grain_body(name: str, index: int) -> str:
    """Name of a grain's body in the model."""
    return f"grain {name} {index}"


def bond_name(bond: Bond) -> str:
    """Name of a bond's constraint in the model."""
    return f"bond {bond.first} {bond.second}"


def stab_name(name: str) -> str:
    """Name of the constraint that holds a food on tines."""
    return f"stab {name}"


def add_scene(spec: mujoco.MjSpec, scene: Scene, *, tined: bool, grips: bool) -> None:
    """Add a scene to the model of a robot, which has tines, a gripper or neither."""
    if tined:
        for geom in spec.body(TINES_BODY).geoms:
            geom.contype, geom.conaffinity = TINE, 0
    spec.worldbody.add_geom(
        name=TABLE,
        type=mujoco.mjtGeom.mjGEOM_PLANE,
        size=[_DRAWN_HALF_M, _DRAWN_HALF_M, 0.1],
        pos=[0.0, 0.0, scene.table_m],
        friction=_TABLE_FRICTION,
        rgba=_TABLE_COLOUR,
        contype=SOLID,
        conaffinity=SOLID | TINE,
    )
    for thing in scene.things:
        _add_thing(spec, thing)
        if thing.food is not None and tined and not thing.fixed:
            _add_weld(spec, stab_name(thing.name), TINES_BODY, thing_body(thing.name), active=False)
    for bond in scene.bonds:
        _add_weld(spec, bond_name(bond), thing_body(bond.first), thing_body(bond.second), active=True)
        spec.add_exclude(bodyname1=thing_body(bond.first), bodyname2=thing_body(bond.second))
    for grains in scene.grains:
        _add_grains(spec, grains)
    if scene.grains and not grips:
        # Grains in motion with nothing pinched among them: 135 instead of 220 us per step. What fingers hold
        # makes conjugate gradients slower than Newton's method.
        spec.option.solver = mujoco.mjtSolver.mjSOL_CG
    spec.option.cone = mujoco.mjtCone.mjCONE_ELLIPTIC
    spec.option.impratio = 10.0
    spec.option.jacobian = mujoco.mjtJacobian.mjJAC_SPARSE
    spec.option.enableflags |= int(mujoco.mjtEnableBit.mjENBL_SLEEP)
    spec.option.sleep_tolerance = _SLEEP_TOLERANCE_M_S


def _add_thing(spec: mujoco.MjSpec, thing: Thing) -> None:
    turn = Rotation.from_matrix(thing.pose.rotation).as_quat(scalar_first=True)
    body = spec.worldbody.add_body(
        name=thing_body(thing.name), pos=list(thing.pose.position), quat=list(turn)
    )
    if not thing.fixed:
        body.add_freejoint(name=thing_body(thing.name))
    for geom in add_parts(body, thing.parts, thing.mass_kg):
        geom.friction = [thing.friction, *_ROLLING]
        geom.condim = 4
        geom.solref = _STIFF
        geom.contype, geom.conaffinity = SOLID, SOLID | TINE


def _add_grains(spec: mujoco.MjSpec, grains: Grains) -> None:
    """Frictionless balls: they never turn, so each slides along three axes only."""
    drag = grains.mass_kg / _GRAIN_DRAG_S
    for index, position in enumerate(grains.positions):
        name = grain_body(grains.name, index)
        body = spec.worldbody.add_body(name=name, pos=list(position))
        for axis in np.eye(3):
            body.add_joint(type=mujoco.mjtJoint.mjJNT_SLIDE, axis=list(axis), damping=[drag, 0.0, 0.0])
        body.add_geom(
            type=mujoco.mjtGeom.mjGEOM_SPHERE,
            size=[grains.radius_m * grains.sizes[index % len(grains.sizes)], 0.0, 0.0],
            rgba=list(grains.colour),
            mass=grains.mass_kg,
            condim=1,
            priority=2,
            solref=_STIFF,
            contype=SOLID,
            conaffinity=SOLID | TINE,
        )


def _add_weld(spec: mujoco.MjSpec, name: str, first: str, second: str, *, active: bool) -> None:
    weld = spec.add_equality(
        name=name,
        type=mujoco.mjtEq.mjEQ_WELD,
        name1=first,
        name2=second,
        objtype=mujoco.mjtObj.mjOBJ_BODY,
        active=active,
    )
    weld.solref = [0.004, 1.0]


def rotation_of(quaternion: FloatArray) -> FloatArray:
    """The rotation matrix (3, 3) of a quaternion (w, x, y, z)."""
    matrix = np.empty(9)
    mujoco.mju_quat2Mat(matrix, quaternion)
    return matrix.reshape(3, 3)
