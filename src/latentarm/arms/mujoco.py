"""An arm in MuJoCo: inertia, torque limits and a velocity servo."""

from collections import deque
from collections.abc import Callable
from dataclasses import dataclass
from typing import Final, final

import mujoco
import numpy as np

from latentarm.arms.contact_torque import ContactTorque
from latentarm.arms.contract import SceneArm
from latentarm.arms.finger_servo import FingerServo, add_finger_servos
from latentarm.arms.scene_model import add_scene
from latentarm.arms.scene_watch import SceneWatch
from latentarm.arms.servo import Servo, add_servos, drop_actuators, hold_still_joints, torque_limits
from latentarm.arms.simulated import SETTLED_S, SimulatedArm, check_start
from latentarm.arms.tines import TinesInFood
from latentarm.core.errors import UserError
from latentarm.core.types import FloatArray, IntArray
from latentarm.robots.kinematics.reader import ModelChain, read, reference_positions
from latentarm.robots.robot import Robot
from latentarm.robots.scene.scene import Scene, SceneState

STEP_S: Final = 0.001  # time step of the physics and of the servo, s
_HARD_STOP: Final = (2.0 * STEP_S, 1.0)  # stops of metal: as stiff as the time step allows
RATE_HZ: Final = 1000.0  # of the servo
LOOK_STEPS: Final = 4  # time steps between checks of contacts, forces, stabs and cuts
SCENE_SETTLED_S: Final = 10.0  # without a command, things about an arm are at rest by then


@final
@dataclass(frozen=True)
class Imperfections:
    """Imperfections of a simulated arm, besides inertia; UserError where one is negative or not finite."""

    position_noise_rad: float = 0.0  # SD of the noise on positions, rad
    velocity_noise_rad_s: float = 0.0  # SD of the noise on velocities, rad/s
    delay_s: float = 0.0  # age of every reading, s
    payload_kg: float = 0.0  # mass at the end-effector that gravity compensation ignores, kg
    seed: int = 0  # of the noise

    def __post_init__(self) -> None:
        for name in ("position_noise_rad", "velocity_noise_rad_s", "delay_s", "payload_kg"):
            if not 0.0 <= getattr(self, name) < np.inf:
                raise UserError(f"A simulated arm's {name} is {getattr(self, name)}: it must be 0 or more.")


@final
class MujocoArm(SimulatedArm, SceneArm):
    """A robot in MuJoCo, driven by torques, alone or with a scene about it.

    Each joint has a velocity servo at 1 kHz: a torque in proportion to the error of the velocity and to that
    of its integral. Gravity is compensated for the robot's own bodies. The servo follows a command no faster
    than the joint may accelerate, and slows down equally fast once a command has run out or was taken back.
    Torques end at the limits of the robot's model. A gripper begins open, and holds by contact alone; see
    `FingerServo`. Joints that nothing drives stay in place.

    Args:
        robot: whose model is simulated.
        state: (n,), start, rad.
        now_s: the clock, s; never goes back.
        imperfections: of the arm and its sensors.
        scene: things about the arm, in its base frame; None for none, not even a table.

    Raises UserError where ``state`` has the wrong shape, is not finite, or lies outside the limits; the model
    states no torque limit for a joint; or the gripper has no joints in it.
    """

    def __init__(
        self,
        robot: Robot,
        state: FloatArray,
        now_s: Callable[[], float],
        imperfections: Imperfections | None = None,
        scene: Scene | None = None,
    ) -> None:
        check_start(robot, state)
        if robot.gripper is not None and not robot.gripper.joints:
            raise UserError(
                f"The gripper of {robot.name} has no joints in the model, so physics cannot move it: choose"
                " --arm kinematic, or leave [gripper] out of the limits file."
            )
        self._imperfections = imperfections or Imperfections()
        # The arm and its scene, and their state after the last time step, for drawing; do not change them.
        self.model, found = _world(robot, state, self._imperfections.payload_kg, scene)
        self._positions = self.model.jnt_qposadr[found.joints]
        self._speeds = self.model.jnt_dofadr[found.joints]
        self.data = mujoco.MjData(self.model)
        reference = reference_positions(robot.model())
        self.data.qpos[: len(reference)] = reference
        self.data.qpos[self.model.jnt_qposadr[found.link_joints]] = found.model_positions(state)
        self._touch = ContactTorque(self.model, self.data, found)
        self._servo = Servo(self.model, self.data, found.joints, robot.limits.acceleration * STEP_S)
        self._fingers = None
        if robot.gripper is not None:
            delay_s = self._imperfections.delay_s
            self._fingers = FingerServo(robot.gripper, self.model, self.data, 2 * robot.dof, delay_s)
        super().__init__(
            robot,
            state,
            now_s,
            rate_hz=RATE_HZ,
            stops_after_s=STEP_S,
            gripper=self._fingers,
            settles_s=SETTLED_S if scene is None else SCENE_SETTLED_S,
        )
        self._watch = self._tines = None
        self._bonds = frozenset((one.first, one.second) for one in (() if scene is None else scene.bonds))
        if scene is not None:
            self._watch = SceneWatch(self.model, self.data, robot, found.body_link, scene)
            if robot.tines is not None:
                self._tines = TinesInFood(self.model, self.data, robot.tines, scene)
        self._state: SceneState | None = None
        self._steps = 0
        self._behind_s = 0.0
        self._rng = np.random.default_rng(self._imperfections.seed)
        self._measured: deque[tuple[float, FloatArray, FloatArray, FloatArray]] = deque()
        self._note()

    def truth(self) -> tuple[FloatArray, FloatArray]:
        """True positions, (n,), rad, and velocities, (n,), rad/s, of the joints, independent of readings."""
        self._elapse()
        return self.data.qpos[self._positions].copy(), self.data.qvel[self._speeds].copy()

    def scene_state(self) -> SceneState:
        """The true state of the scene.

        Forces are sampled every `LOOK_STEPS` time steps; one that rises and falls in between is missed.
        Things at rest sleep: the forces between them are omitted.
        """
        if self._watch is None:
            raise RuntimeError("an arm without a scene has no state of it")
        self._elapse()
        if self._state is None or self._state.time_s != self.data.time:
            q = self.data.qpos[self._positions].copy()
            stabbed, bonds = frozenset[str](), self._bonds
            if self._tines is not None:
                stabbed, bonds = self._tines.stabbed, self._tines.bonds
            self._state = self._watch.state(q, stabbed, bonds)
        return self._state

    def _pass(self, span_s: float, commanded: FloatArray) -> None:
        self._behind_s += span_s
        steps = int((self._behind_s + 1e-9) / STEP_S)
        self._behind_s -= steps * STEP_S
        if steps:
            self._run(steps, commanded)
            self._note()

    def _run(self, steps: int, commanded: FloatArray) -> None:
        """Let time steps pass: one by one while a servo needs that."""
        fingers, watch = self._fingers, self._watch
        while steps:
            anew = self._servo.prepare(commanded)
            if fingers is not None:
                anew |= fingers.prepare()
            taken = 1 if anew else steps
            if watch is not None:
                taken = min(taken, LOOK_STEPS - self._steps % LOOK_STEPS)
            mujoco.mj_step(self.model, self.data, taken)
            self._servo.unwind()
            self._steps += taken
            steps -= taken
            if watch is not None and self._steps % LOOK_STEPS == 0:
                watch.look()
                self._touch.look()
                if self._tines is not None:
                    self._tines.look()

    def _note(self) -> None:
        """Store the present measurement until its delay has passed."""
        time_s = float(self.data.time)
        q, dq = self.data.qpos[self._positions].copy(), self.data.qvel[self._speeds].copy()
        self._measured.append((time_s, q, dq, self._touch.estimate()))
        while len(self._measured) > 1 and time_s - self._measured[1][0] >= self._imperfections.delay_s - 1e-9:
            self._measured.popleft()
        if self._fingers is not None:
            self._fingers.note()

    def _measure(self) -> tuple[FloatArray, FloatArray, float]:
        time_s, q, dq, _ = self._measured[0]
        noise = self._imperfections
        q = q + self._rng.normal(0.0, noise.position_noise_rad, q.shape)
        dq = dq + self._rng.normal(0.0, noise.velocity_noise_rad_s, dq.shape)
        return q, dq, float(self.data.time) - time_s + max(self._behind_s, 0.0)

    def _external_torque(self) -> FloatArray:
        return self._measured[0][3]

    def _halt(self) -> None:
        """Nothing: without a command the servo slows down from the next step on."""


def _world(
    robot: Robot, state: FloatArray, payload_kg: float, scene: Scene | None
) -> tuple[mujoco.MjModel, ModelChain]:
    """The robot's model with servos and a scene, and the places of the robot's parts in it."""
    spec = mujoco.MjSpec.from_string(robot.mjcf)
    bare = spec.compile()
    found = read(bare, [tool.name for tool in robot.chain.tools])
    fingers = () if robot.gripper is None else robot.gripper.joints
    torque = torque_limits(bare, found.joints, robot)
    inertia = _inertia(bare, found, state, found.link_joints, found.chain.ratio)
    drop_actuators(spec)
    hold_still_joints(spec, bare, found.joints, fingers)
    add_servos(spec, bare, found.joints, torque, inertia)
    if robot.gripper is not None:
        slides = np.array([bare.joint(name).id for name in fingers])
        moved = _inertia(bare, found, state, slides, np.eye(len(slides)))
        add_finger_servos(spec, robot.gripper, moved)
    _let_first_links_turn(spec, bare, found.link_joints)
    for joint in spec.joints:
        joint.solref_limit[:] = _HARD_STOP
    for body in spec.bodies:
        body.gravcomp = 1.0
    if payload_kg > 0.0:
        _hang(spec, robot, payload_kg)
    if scene is not None:
        add_scene(spec, scene, tined=robot.tines is not None, grips=robot.gripper is not None)
    spec.option.timestep = STEP_S
    spec.option.integrator = mujoco.mjtIntegrator.mjINT_IMPLICITFAST
    return spec.compile(), found


def _inertia(
    model: mujoco.MjModel, arm: ModelChain, state: FloatArray, joints: IntArray, ratio: FloatArray
) -> FloatArray:
    """Inertia that moves with each of k servos alone, (k,), kg m², with the arm at its start; kg for slides.

    ``ratio`` (J, k) says how the model's joints (J,) move with them.
    """
    data = mujoco.MjData(model)
    data.qpos[:] = reference_positions(model)
    data.qpos[model.jnt_qposadr[arm.link_joints]] = arm.model_positions(state)
    mujoco.mj_forward(model, data)
    whole = np.zeros((model.nv, model.nv))
    mujoco.mj_fullM(model, data, whole)
    moved = model.jnt_dofadr[joints]
    return np.diag(ratio.T @ whole[np.ix_(moved, moved)] @ ratio)


def _let_first_links_turn(spec: mujoco.MjSpec, model: mujoco.MjModel, joints: IntArray) -> None:
    """No contact between a link and the base that it turns on, as between other links and parents."""
    for body in {int(model.jnt_bodyid[joint]) for joint in joints}:
        parent = int(model.body_parentid[body])
        if parent and model.body_weldid[parent] == 0:
            spec.add_exclude(bodyname1=_named(spec, parent), bodyname2=_named(spec, body))


def _named(spec: mujoco.MjSpec, body: int) -> str:
    found = next(one for one in spec.bodies if one.id == body)
    found.name = found.name or f"body{body}"
    return str(found.name)


def _hang(spec: mujoco.MjSpec, robot: Robot, payload_kg: float) -> None:
    """Add a ball at the end-effector that gravity compensation does not hold."""
    name = robot.chain.tools[0].name
    site = spec.site(name)
    parent, place = (spec.body(name), [0.0, 0.0, 0.0]) if site is None else (site.parent, list(site.pos))
    ball = parent.add_body(name="payload", pos=place)
    ball.add_geom(
        type=mujoco.mjtGeom.mjGEOM_SPHERE, size=[0.03, 0.0, 0.0], mass=payload_kg, contype=0, conaffinity=0
    )
