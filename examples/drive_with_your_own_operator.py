"""Drive a simulated Panda through Algorithm 1 and its safety filters, with inputs from anywhere."""

import numpy as np

from latentarm.control.safety.config import SafetyConfig
from latentarm.control.step import Step
from latentarm.controllers.end_effector import EndEffectorController
from latentarm.robots.catalogue import load_robot
from latentarm.robots.simulated import SimulatedArm
from latentarm.types import Input

DT_S = 0.01

robot = load_robot("panda")
arm = SimulatedArm(robot, robot.home, DT_S)
step = Step(robot, EndEffectorController(robot), SafetyConfig(), dt_s=DT_S)

# The arm starts disengaged: a neutral input, then an explicit enable.
step.reset(arm.state())
step(Input(np.zeros(2)), 0.0, arm.state(), 0.0)
step.enable()

before = robot.chain.forward(arm.state()).position
for tick in range(1, 101):
    u = np.array([0.0, 1.0])  # your stick, switch or straw here
    age_s = 0.0  # how old that input is by the loop's own clock
    record = step(Input(u), age_s, arm.state(), tick * DT_S)
    arm.send(record.command)
    arm.advance()
moved = robot.chain.forward(arm.state()).position - before
print(f"A second of stick to the left moved the tool by {np.round(100 * moved, 1)} cm.")

# Old input: the arm ramps to rest and stays there until it is enabled again.
for tick in range(101, 131):
    record = step(Input(u), 0.2, arm.state(), tick * DT_S)
    arm.send(record.command)
    arm.advance()
print(f"Then the input went stale: {step.stopped.reason if step.stopped else 'not at all'}")
