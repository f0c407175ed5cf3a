"""Measure whether an arm's motors can do what a limits file states.

By the masses and the reflected inertia of the model, over random poses: the torque that gravity takes at
each joint, that of a stop on top of it (0.8 of the stated acceleration, at all joints at once, each in the
worst direction), and the sum as a share of the torque at standstill. Friction, which helps a stop, is left
out, and nothing is in the gripper.
"""

import mujoco
import numpy as np

from latentarm.robots.limits_file import read_limits
from latentarm.safety.config import SafetyConfig
from latentarm_research.measurements.catalogue import Torque
from latentarm_research.measurements.measurement import Outcome, Work, line


def measure(options: Torque, work: Work) -> Outcome:
    """Torques of each joint, and their shares; none may be above the torque at standstill."""
    model = mujoco.MjModel.from_xml_path(str(options.model))
    limits = read_limits(options.limits)
    names = [model.joint(index).name for index in range(model.njnt)]
    arm = [index for index, name in enumerate(names) if name in limits.joints]
    stop = SafetyConfig().stop_fraction
    acceleration = stop * np.array([limits.joints[names[index]].acceleration for index in arm])
    data, rng = mujoco.MjData(model), np.random.default_rng(work.seed)
    lower, upper = model.jnt_range.T
    inertia = np.zeros((model.nv, model.nv))
    gravity, needed = np.zeros(len(arm)), np.zeros(len(arm))
    for _ in range(options.poses):
        data.qpos[:] = rng.uniform(lower, upper)
        mujoco.mj_forward(model, data)
        mujoco.mj_fullM(model, data, inertia)
        now = np.abs(data.qfrc_bias[arm])
        gravity = np.maximum(gravity, now)
        needed = np.maximum(needed, now + np.abs(inertia[np.ix_(arm, arm)]) @ acceleration)
    rows, broken = [], list[str]()
    for index, joint in enumerate(arm):
        figures = {"gravity_n_m": gravity[index], "gravity_and_stop_n_m": needed[index]}
        for stall in options.stall_n_m:
            figures[f"of_{stall:g}_n_m_percent"] = 100.0 * needed[index] / stall
        rows += line("torque", names[joint], options.poses, figures)
        broken += [f"{names[joint]}: above {one:g} N·m" for one in options.stall_n_m if needed[index] > one]
    return Outcome(rows, broken)
