import subprocess
import sys

LIGHT = [
    "latentarm.robots.kinematics.chain",
    "latentarm.robots.kinematics.distances",
    "latentarm.robots.kinematics.rotations",
    "latentarm.robots.limits",
    "latentarm.robots.robot",
    "latentarm.arms.contract",
    "latentarm.arms.kinematic",
]
HEAVY = {"torch", "mujoco", "mink", "scipy", "sklearn"}


def test_what_the_control_loop_imports_loads_no_physics_and_no_learning():
    code = (
        "import importlib, sys\n"
        f"for name in {LIGHT}:\n"
        "    importlib.import_module(name)\n"
        f"    if heavy := {HEAVY} & set(sys.modules): sys.exit(f'{{name}} loaded {{heavy}}')\n"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
