"""Any robot from a MuJoCo (MJCF) or URDF file."""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import final

import mujoco
import numpy as np

from latentarm.core.errors import UserError
from latentarm.core.types import FloatArray
from latentarm.core.untrusted.memory import bounded_memory
from latentarm.robots.assemble import assemble
from latentarm.robots.end_effector import AmbiguousEndEffectorError, choose_end_effector
from latentarm.robots.kinematics.chain import Chain
from latentarm.robots.kinematics.reader import ModelChain, read
from latentarm.robots.limits import JointLimits, Source
from latentarm.robots.model_xml import read_model_xml
from latentarm.robots.robot import Robot
from latentarm.robots.urdf import Urdf, prepare_urdf

MOST_JOINTS = 64  # longer chains are no arms, and their pairs of links take minutes
SINGULAR = 0.05  # a start with a smaller share of the best least singular value is moved


@final
@dataclass(frozen=True)
class Defaults:
    """Assumptions about a joint where the file is silent.

    MJCF has no place for velocity, acceleration and jerk; URDF has one for velocity alone.
    """

    range: float  # half of the range, about zero, rad or m
    velocity: float  # rad/s or m/s
    acceleration: float  # rad/s² or m/s²
    jerk: float  # rad/s³ or m/s³


HINGE = Defaults(range=2.0 * np.pi, velocity=1.0, acceleration=10.0, jerk=1000.0)
SLIDE = Defaults(range=1.0, velocity=0.25, acceleration=2.5, jerk=250.0)
LONGEST_LINK_M = 5.0  # a link is shorter, unless its mesh is in mm
TOOL_SPEED_LIMIT = 1.0  # assumed largest speed of the tool, m/s


def load_model_file(path: Path, end_effector: str | None = None) -> Robot:
    """Load a robot from an MJCF or URDF file.

    It starts at the key frame "home" if there is one, else in the middle of its joints' ranges, or near there
    where that is singular. `Defaults` fill gaps in the file. Its name is the file's absolute path: datasets
    remember it and are read from other folders. Raises AmbiguousEndEffectorError where an end-effector must
    be named.

    ``end_effector`` is the name of a site or body, needed where `choose_end_effector` chooses none. Joints
    that do not move it stay still, see `Robot.still_joints`.
    """
    root, size = read_model_xml(path)
    if root.tag not in ("robot", "mujoco"):
        raise UserError(
            f"{path} is neither MJCF nor URDF: its outermost element is <{root.tag}>,"
            " not <mujoco> or <robot>."
        )
    urdf = prepare_urdf(path, root) if root.tag == "robot" else None
    with bounded_memory(str(path), size + (0 if urdf is None else urdf.mesh_bytes)):
        return _loaded(path, urdf, end_effector)


def _loaded(path: Path, urdf: Urdf | None, end_effector: str | None) -> Robot:
    try:
        spec = mujoco.MjSpec.from_file(str(path)) if urdf is None else mujoco.MjSpec.from_string(urdf.text)
        mjcf = _as_mjcf(spec, path)
        model = mujoco.MjModel.from_xml_string(mjcf)
    except (ValueError, RuntimeError) as error:  # MuJoCo's for what is wrong, and for what it did not foresee
        hint = " Leave the model in its folder, with its meshes." if "opening file" in str(error) else ""
        raise UserError(f"{path} cannot be used as a robot: {_one_line(error)}{hint}") from error
    try:
        tool = choose_end_effector(model) if end_effector is None else end_effector
        reading = read(model, [tool])
        if reading.chain.dof > MOST_JOINTS:
            raise UserError(f"it has {reading.chain.dof} joints, but an arm may have at most {MOST_JOINTS}.")
        _check_meshes(model)
        limits = _limits(model, reading, {} if urdf is None else urdf.velocity)
        home = _home(model, reading, limits)
        whole_path = str(path.resolve())
        return assemble(whole_path, mjcf, [tool], limits, home, TOOL_SPEED_LIMIT, whole_path, model)
    except AmbiguousEndEffectorError as error:
        raise AmbiguousEndEffectorError(f"{path}: {error.why}", error.choices) from error
    except UserError as error:
        raise UserError(f"{path}: {error}") from error


def _check_meshes(model: mujoco.MjModel) -> None:
    """Refuse links too long for any arm: their meshes are in mm."""
    for geom in np.flatnonzero(
        (model.geom_type == mujoco.mjtGeom.mjGEOM_MESH) & (model.body_weldid[model.geom_bodyid] > 0)
    ):
        mesh = model.mesh(int(model.geom_dataid[geom]))
        points = model.mesh_vert[int(mesh.vertadr[0]) :][: int(mesh.vertnum[0])]
        length_m = float(np.ptp(points, axis=0).max())
        if length_m > LONGEST_LINK_M:
            link = model.body(int(model.geom_bodyid[geom])).name
            raise UserError(
                f"the mesh {mesh.name} of link {link} is {length_m:.4g} m long: if its file is in mm, give"
                ' it scale="0.001 0.001 0.001".'
            )


def _as_mjcf(spec: mujoco.MjSpec, path: Path) -> str:
    folder = path.resolve().parent
    spec.compiler.meshdir = str(folder / spec.compiler.meshdir)
    spec.compiler.texturedir = str(folder / spec.compiler.texturedir)
    # Merging a body into its parent would lose the end-effector's name.
    spec.compiler.fusestatic = False
    # Only the kinematics are used: a moving link without inertia is no reason to refuse a robot.
    spec.compiler.boundmass = 1e-6
    spec.compiler.boundinertia = 1e-9
    spec.compiler.balanceinertia = True
    for i, joint in enumerate(spec.joints):
        if not joint.name:
            joint.name = f"joint{i}"
    spec.compile()
    return spec.to_xml()


def _limits(model: mujoco.MjModel, reading: ModelChain, velocity: Mapping[str, float]) -> JointLimits:
    assumed = [SLIDE if slide else HINGE for slide in reading.chain.slide]
    ratio, names = reading.chain.ratio, reading.chain.joint_names
    lower, upper, fastest = np.full((3, len(names)), [[-np.inf], [np.inf], [np.inf]])
    # A joint goes as far and as fast as it and each joint that follows it may.
    for link, joint in enumerate(reading.link_joints):
        led = int(np.abs(ratio[link]).argmax())
        low, high = given = model.jnt_range[joint]
        # MuJoCo ignores a reversed range; here it is an error.
        if model.jnt_limited[joint] or low > high:
            low, high = (given - reading.rest[link]) / ratio[link, led]
            if ratio[link, led] < 0.0:
                low, high = high, low
            lower[led], upper[led] = max(lower[led], low), min(upper[led], high)
        stated = velocity.get(model.joint(int(joint)).name, np.inf) / abs(ratio[link, led])
        fastest[led] = np.minimum(fastest[led], stated)
    limited, known = np.isfinite(lower), fastest != np.inf
    ranges = np.array([defaults.range for defaults in assumed])
    return JointLimits(
        lower=np.where(limited, lower, -ranges),
        upper=np.where(limited, upper, ranges),
        velocity=np.where(known, fastest, [defaults.velocity for defaults in assumed]),
        acceleration=np.array([defaults.acceleration for defaults in assumed]),
        jerk=np.array([defaults.jerk for defaults in assumed]),
        sources={
            "position": tuple(_source(bool(one)) for one in limited),
            "velocity": tuple(_source(bool(one)) for one in known),
        },
    )


def _source(known: bool) -> Source:
    return "model" if known else "assumed"


def _home(model: mujoco.MjModel, reading: ModelChain, limits: JointLimits) -> FloatArray:
    key = mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_KEY, "home")
    if key >= 0:
        home = np.array(model.key_qpos[key][model.jnt_qposadr[reading.joints]])
        return np.clip(home, limits.lower, limits.upper)
    middle = 0.5 * (limits.lower + limits.upper)
    # At most a quarter turn to either side, so that a joint with several turns does not start wound up.
    around = np.minimum(0.25 * (limits.upper - limits.lower), np.pi / 4)
    samples = middle + around * np.random.default_rng(0).uniform(-1.0, 1.0, size=(256, limits.dof))
    candidates = np.concatenate([middle[None], samples])
    freedom = _least_singular_value(reading.chain, candidates)
    if freedom[0] >= SINGULAR * freedom.max():
        return candidates[0]
    # Well away from singularities, as high above the table as possible.
    height = np.where(freedom >= 0.5 * freedom.max(), _lowest_point(reading.chain, candidates), -np.inf)
    return candidates[np.argmax(height)]


def _lowest_point(chain: Chain, q: FloatArray) -> FloatArray:
    transforms = chain.link_transforms(q)
    _, origins = chain.joint_axes(transforms)
    return np.minimum(origins[..., 2].min(axis=-1), chain.tool_pose(transforms).position[..., 2])


def _least_singular_value(chain: Chain, q: FloatArray) -> FloatArray:
    """(N,), the tool's distance from losing a direction in which it could move."""
    values = np.asarray(np.linalg.svd(chain.jacobian(q), compute_uv=False), dtype=np.float64)
    # A robot of few joints lacks some directions everywhere; those are not held against a start.
    rank = int((values > 1e-9).sum(axis=-1).max())
    return values[:, rank - 1]


def _one_line(error: Exception) -> str:
    return " ".join(str(error).split()).removeprefix("Error: ").rstrip(".") + "."
