"""The Franka Emika Panda and the Franka Research 3, from the manufacturer's published figures."""

from functools import cache

import mujoco
import numpy as np

from latentarm.core.types import FloatArray
from latentarm.robots.assemble import assemble
from latentarm.robots.gripper import Gripper
from latentarm.robots.limits import JointLimits, same_source
from latentarm.robots.panda_look import SHELL_GROUP, add_look
from latentarm.robots.robot import Robot

HOME: FloatArray = np.array([0.0, -np.pi / 4, 0.0, -3 * np.pi / 4, 0.0, np.pi / 2, np.pi / 4])
"""(7,), the manufacturer's ready pose, rad."""

LIMITS = JointLimits(
    lower=np.array([-2.8973, -1.7628, -2.8973, -3.0718, -2.8973, -0.0175, -2.8973]),
    upper=np.array([2.8973, 1.7628, 2.8973, -0.0698, 2.8973, 3.7525, 2.8973]),
    velocity=np.array([2.175, 2.175, 2.175, 2.175, 2.61, 2.61, 2.61]),
    acceleration=np.array([15.0, 7.5, 10.0, 12.5, 15.0, 20.0, 20.0]),
    jerk=np.array([7500.0, 3750.0, 5000.0, 6250.0, 7500.0, 10000.0, 10000.0]),
    sources=same_source("manufacturer", 7),
)
"""Franka control-parameters documentation."""

TORQUE_LIMIT = (87.0, 87.0, 87.0, 87.0, 12.0, 12.0, 12.0)  # of each joint, N m; the same documentation
_FR3_LOWER = np.array([-2.7437, -1.7837, -2.9007, -3.0421, -2.8065, 0.5445, -3.0159])
_FR3_UPPER = np.array([2.7437, 1.7837, 2.9007, -0.1518, 2.8065, 4.5169, 3.0159])
FR3_LIMITS = JointLimits(
    lower=np.maximum(_FR3_LOWER, LIMITS.lower),
    upper=np.minimum(_FR3_UPPER, LIMITS.upper),
    velocity=np.array([2.62, 2.62, 2.62, 2.62, 5.26, 4.18, 5.26]),
    acceleration=np.full(7, 10.0),
    jerk=np.full(7, 5000.0),
    sources=same_source("manufacturer", 7),
)
"""The manufacturer's limits of the FR3 (https://frankarobotics.github.io/docs/robot_specifications.html).
Positions end where the Panda's do too: beyond, it is not known which of the links cannot meet."""

FR3_TOOL_SPEED_LIMIT = 3.0  # Cartesian limit of the FR3's end-effector, m/s
TOOL_SPEED_LIMIT = 1.7  # Cartesian limit of the end-effector, m/s
# Modified Denavit-Hartenberg (Craig): a and d in m, alpha in rad. Joint i turns about its own z axis.
_A = (0.0, 0.0, 0.0, 0.0825, -0.0825, 0.0, 0.088)
_D = (0.333, 0.0, 0.316, 0.0, 0.384, 0.0, 0.0)
_ALPHA = (0.0, -np.pi / 2, np.pi / 2, np.pi / 2, -np.pi / 2, np.pi / 2, np.pi / 2)
_FLANGE_D = 0.107
_HAND_TURN = -np.pi / 4
_TOOL_D = 0.1034  # hand -> the point between the fingertips
# Mass, kg; centre of mass, m; inertia xx, yy, zz, xy, xz, yz about it, kg m². Links 1-7 as identified
# by Gaz et al. (IEEE RA-L 4(4), 2019); the base likewise.
_INERTIA = (
    (0.629769, -0.041018, -0.00014, 0.049974, 0.00315, 0.00388, 0.004285, 8.2904e-07, 0.00015, 8.2299e-06),
    (4.970684, 0.003875, 0.002081, -0.04762, 0.70337, 0.70661, 0.009117, -0.000139, 0.006772, 0.019169),
    (0.646926, -0.003141, -0.02872, 0.003495, 0.007962, 0.02811, 0.025995, -0.003925, 0.010254, 0.000704),
    (3.228604, 0.027518, 0.039252, -0.066502, 0.037242, 0.036155, 0.01083, -0.004761, -0.011396, -0.012805),
    (3.587895, -0.05317, 0.104419, 0.027454, 0.025853, 0.019552, 0.028323, 0.007796, -0.001332, 0.008641),
    (1.225946, -0.011953, 0.041065, -0.038437, 0.035549, 0.029474, 0.008627, -0.002117, -0.004037, 0.000229),
    (1.666555, 0.060149, -0.014117, -0.010517, 0.001964, 0.004354, 0.005433, 0.000109, -0.001158, 0.000341),
    (0.735522, 0.010517, -0.004252, 0.061597, 0.012516, 0.010027, 0.004815, -0.000428, -0.001196, -0.000741),
)
_HAND_INERTIA = (0.73, -0.01, 0.0, 0.03, 0.001, 0.0025, 0.0017, 0.0, 0.0, 0.0)
GRIPPER = Gripper(joints=("finger_joint1", "finger_joint2"), width_m=0.08, speed_m_s=0.1, force_n=70.0)
"""The Franka Hand: its datasheet's stroke, speed for each change of the opening, and continuous force."""

_FINGER_Z = 0.0584  # hand -> finger, m
_FINGER_INERTIA = (0.015, 0.0, 0.01, 0.025, 2.375e-6, 2.375e-6, 7.5e-7, 0.0, 0.0, 0.0)
_FINGER_ARMATURE = 0.1  # kg: what the motor and its gear add
# A finger in its own frame: at zero its pad lies in the plane y = 0. What the capsule covers is the shell of
# the real finger; the pad is what grips, and makes the capsule about both fingers no thicker.
_FINGER_SHELL = ((0.0, 0.011, 0.008), (0.0, 0.011, 0.044), 0.01)
_PAD_HALF = (0.0085, 0.004, 0.0085)
_PAD_AT = (0.0, 0.004, 0.0435)
_PAD_FRICTION = (1.5, 0.02, 0.0001)
# As stiff as a time step of 1 ms allows: friction has no memory, so what is held creeps, by gravity and by
# the hand's own turning, in proportion to this time constant. With MuJoCo's 0.02 a cup creeps by 1 mm/s.
_PAD_SOLREF = (0.003, 1.0)
_PAD_SOLIMP = (0.99, 0.99, 0.001, 0.5, 2.0)
_GREY = (0.35, 0.37, 0.40, 1.0)
_DARK = (0.15, 0.15, 0.16, 1.0)
# The shell, capsule by capsule: body, both ends in its frame (m), radius (m). Fitted to the
# manufacturer's visual meshes (franka_description): the smallest capsules found that together leave
# nothing of them outside by more than 1 mm, in any configuration. A seam may be covered by the
# neighbour's capsule, where that turns about the same axis. The base's dip below the table it stands on.
_SHELL = (
    ("link0", (-0.094, 0.0, 0.042), (0.005, 0.0, 0.058), 0.09),
    ("link0", (0.008, -0.073, 0.005), (0.008, 0.073, 0.005), 0.031),
    ("link1", (0.0, 0.0, -0.173), (0.0, -0.019, -0.082), 0.066),
    ("link2", (0.0, 0.0, -0.055), (0.0, -0.017, 0.066), 0.0785),
    ("link3", (0.0, 0.0, -0.218), (0.0, 0.0, -0.082), 0.0705),
    ("link4", (0.003, -0.003, -0.042), (-0.003, 0.001, 0.037), 0.0765),
    ("link5", (0.0, -0.002, -0.309), (0.0, 0.011, -0.207), 0.065),
    ("link5", (-0.003, 0.058, -0.176), (-0.003, 0.099, -0.064), 0.041),
    ("link6", (0.0, 0.0, -0.073), (0.011, 0.004, 0.011), 0.064),
    ("link7", (0.0, 0.0, -0.05), (0.003, 0.003, 0.064), 0.057),
    ("link7", (0.032, 0.06, 0.083), (0.06, 0.032, 0.083), 0.027),
    ("hand", (0.0, -0.068, 0.023), (0.0, 0.068, 0.023), 0.052),
)
# Links two apart that the joint limits keep from each other: their surfaces never come nearer than 60 mm,
# those of links 5 and 7 than 19 mm, though their capsules do.
_NEVER_MEET = (
    ("link0", "link2"),
    ("link1", "link3"),
    ("link2", "link4"),
    ("link3", "link5"),
    ("link4", "link6"),
    ("link5", "link7"),
)


@cache
def panda() -> Robot:
    """The Panda with its hand; "tool" lies between the fingertips. Cached: do not write to its arrays."""
    return franka("panda", LIMITS, TOOL_SPEED_LIMIT)


@cache
def fr3() -> Robot:
    """The FR3 with its hand, with the Panda's links and shell. Cached: do not write to its arrays."""
    return franka("fr3", FR3_LIMITS, FR3_TOOL_SPEED_LIMIT)


def franka(model: str, limits: JointLimits, tool_speed_limit: float) -> Robot:
    """An arm with the Panda's links and hand.

    Positions must lie within the Panda's limits: only for those is it known which links never meet.
    """
    spec = mujoco.MjSpec()
    spec.modelname = model
    spec.compiler.degree = False
    body = spec.worldbody.add_body(name="link0")
    bodies = {"link0": body}
    _give_inertia(body, *_INERTIA[0])
    for i, (a, d, alpha) in enumerate(zip(_A, _D, _ALPHA, strict=True)):
        body = body.add_body(
            name=f"link{i + 1}",
            pos=[a, -d * np.sin(alpha), d * np.cos(alpha)],
            quat=[np.cos(alpha / 2), np.sin(alpha / 2), 0.0, 0.0],
        )
        bodies[body.name] = body
        body.add_joint(
            name=f"joint{i + 1}",
            axis=[0.0, 0.0, 1.0],
            range=[limits.lower[i], limits.upper[i]],
            actfrclimited=True,
            actfrcrange=[-TORQUE_LIMIT[i], TORQUE_LIMIT[i]],
            armature=0.1,
            damping=[1.0, 0.0, 0.0],
        )
        _give_inertia(body, *_INERTIA[i + 1])
    hand = body.add_body(
        name="hand",
        pos=[0.0, 0.0, _FLANGE_D],
        quat=[np.cos(_HAND_TURN / 2), 0.0, 0.0, np.sin(_HAND_TURN / 2)],
    )
    bodies["hand"] = hand
    _give_inertia(hand, *_HAND_INERTIA)
    hand.add_site(name="tool", pos=[0.0, 0.0, _TOOL_D], size=[0.005, 0.005, 0.005])
    for name, start, end, radius in _SHELL:
        bodies[name].add_geom(
            type=mujoco.mjtGeom.mjGEOM_CAPSULE,
            fromto=[*start, *end],
            size=[radius, 0.0, 0.0],
            group=SHELL_GROUP,
        )
    add_look(spec, bodies)
    _add_fingers(spec, hand)
    for first, second in _NEVER_MEET:
        spec.add_exclude(bodyname1=first, bodyname2=second)
    spec.compile()
    spec.add_key(name="home", qpos=[*HOME, *([GRIPPER.width_m / 2] * 2)])
    spec.compile()
    return assemble(
        model,
        spec.to_xml(),
        ["tool"],
        limits,
        HOME,
        tool_speed_limit,
        tool_speed_source="manufacturer",
        gripper=GRIPPER,
    )


def _add_fingers(spec: mujoco.MjSpec, hand: mujoco.MjsBody) -> None:
    """Two fingers that slide along y, coupled as by the hand's rack and pinion."""
    for side, joint, turn in zip(("left", "right"), GRIPPER.joints, (0.0, np.pi), strict=True):
        finger = hand.add_body(
            name=f"{side}_finger",
            pos=[0.0, 0.0, _FINGER_Z],
            quat=[np.cos(turn / 2), 0.0, 0.0, np.sin(turn / 2)],
        )
        _give_inertia(finger, *_FINGER_INERTIA)
        finger.add_joint(
            name=joint,
            type=mujoco.mjtJoint.mjJNT_SLIDE,
            axis=[0.0, 1.0, 0.0],
            range=[0.0, GRIPPER.width_m / 2],
            actfrclimited=True,
            actfrcrange=[-GRIPPER.force_n, GRIPPER.force_n],
            armature=_FINGER_ARMATURE,
        )
        start, end, radius = _FINGER_SHELL
        finger.add_geom(
            type=mujoco.mjtGeom.mjGEOM_CAPSULE, fromto=[*start, *end], size=[radius, 0.0, 0.0], rgba=_GREY
        )
        finger.add_geom(
            type=mujoco.mjtGeom.mjGEOM_BOX,
            pos=_PAD_AT,
            size=_PAD_HALF,
            rgba=_DARK,
            condim=4,
            friction=_PAD_FRICTION,
            priority=1,
            solref=_PAD_SOLREF,
            solimp=_PAD_SOLIMP,
        )
    spec.add_exclude(bodyname1="left_finger", bodyname2="right_finger")
    coupling = spec.add_equality(
        type=mujoco.mjtEq.mjEQ_JOINT,
        name1=GRIPPER.joints[1],
        name2=GRIPPER.joints[0],
        objtype=mujoco.mjtObj.mjOBJ_JOINT,
        data=[0.0, 1.0, *([0.0] * (mujoco.mjNEQDATA - 2))],
    )
    coupling.solref = [0.002, 1.0]


def _give_inertia(body: mujoco.MjsBody, mass: float, x: float, y: float, z: float, *inertia: float) -> None:
    body.explicitinertial = True
    body.mass = mass
    body.ipos = [x, y, z]
    body.fullinertia = list(inertia)
