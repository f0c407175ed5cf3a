import subprocess
import sys

import pytest

LIGHT = [
    "latentarm.kinematics.chain",
    "latentarm.kinematics.distances",
    "latentarm.kinematics.rotations",
    "latentarm.robots.limits",
    "latentarm.robots.robot",
    "latentarm.arms.contract",
    "latentarm.arms.kinematic",
]


@pytest.mark.parametrize("module", LIGHT)
def test_what_the_control_loop_imports_loads_no_physics_and_no_learning(module):
    heavy = {"torch", "mujoco", "mink", "scipy", "sklearn"}
    code = f"import sys, {module}; print(sorted({heavy} & set(sys.modules)))"
    found = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert found.stdout.strip() == "[]"
