"""Your own loop: drive a simulated Panda through Algorithm 1 and its safety filters."""

import numpy as np

import latentarm as la

DT_S = 0.01

robot = la.load_robot("panda")
arm = la.KinematicArm(robot, robot.home)
step = la.Step(robot, la.EndEffectorController(robot), la.SafetyConfig(), dt_s=DT_S)

# The arm starts disengaged. It takes a neutral input, then an explicit enable.
step.reset(arm.state())
step(la.Input(np.zeros(2)), 0.0, arm.state(), 0.0)
step.enable()

before = robot.chain.forward(arm.state()).position
for tick in range(1, 101):
    u = np.array([0.0, 1.0])  # your stick, switch or straw here
    age_s = 0.0  # how old that input is by the loop's own clock
    record = step(la.Input(u), age_s, arm.state(), tick * DT_S)
    arm.send(record.command)
    arm.advance(DT_S)
moved = robot.chain.forward(arm.state()).position - before
print(f"One second of full stick to the left moved the tool by {np.round(100 * moved, 1)} cm.")

# Stale input: the arm ramps to rest and stays there until it is enabled again.
for tick in range(101, 131):
    record = step(la.Input(u), 0.2, arm.state(), tick * DT_S)
    arm.send(record.command)
    arm.advance(DT_S)
print(f"Then the input went stale: {step.stopped.reason if step.stopped else 'not at all'}")
