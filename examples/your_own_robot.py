"""Your own robot: an arm from a URDF or MJCF file, its kinematics and its limits, driven by a stick."""

import tempfile
from pathlib import Path

import numpy as np

import latentarm as la

LINK = """<link name="{0}"><inertial><mass value="1"/>
  <inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link>"""
JOINT = """<joint name="joint{0}" type="revolute"><parent link="link{0}"/><child link="link{1}"/>
  <origin xyz="{2} 0 0"/><axis xyz="0 0 1"/><limit lower="-2" upper="2" velocity="1" effort="10"/></joint>"""
links = "".join(LINK.format(f"link{index}") for index in range(5))
joints = "".join(JOINT.format(index, index + 1, 0.0 if index == 0 else 0.3) for index in range(4))

path = Path(tempfile.mkdtemp()) / "snake.urdf"  # your own file here
path.write_text(f'<robot name="snake">{links}{joints}</robot>')

robot = la.load_robot(str(path), end_effector="link4")
print(f"{robot.dof} joints: {', '.join(robot.joint_names)}; fastest {robot.limits.velocity} rad/s")
state = np.array([0.2, 0.4, -0.3, 0.1])
print(f"The tool is at {np.round(robot.chain.forward(state).position, 3)} m.")
