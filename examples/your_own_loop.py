"""Your own loop: drive a simulated Panda through Algorithm 1 and its safety filters."""

import numpy as np

import latentarm as la

DT_S = 0.01

robot = la.load_robot("panda")
clock = la.SimulatedClock()  # la.MonotonicClock() for real time
arm = la.make_arm("kinematic", robot, robot.home, clock.now_s)
step = la.Step(robot, la.EndEffectorController(robot), la.SafetyConfig(), dt_s=DT_S)

with arm:
    # Arm and step start disengaged. It takes a neutral input, then an explicit enable.
    step.reset(arm.read().q)
    step(la.Input(np.zeros(2)), 0.0, arm.read(), clock.now_s())
    arm.enable()
    step.enable()

    before = robot.chain.forward(arm.read().q).position
    for tick in range(1, 101):
        clock.wait_until(tick * DT_S)
        u = np.array([0.0, 1.0])  # your stick, switch or straw here
        age_s = 0.0  # how old that input is by the loop's own clock
        record = step(la.Input(u), age_s, arm.read(), clock.now_s())
        arm.send(record.command)
    moved = robot.chain.forward(arm.read().q).position - before
    print(f"One second of full stick to the left moved the tool by {np.round(100 * moved, 1)} cm.")

    # Stale input: the arm ramps to rest and stays there until it is enabled again.
    for tick in range(101, 131):
        clock.wait_until(tick * DT_S)
        record = step(la.Input(u), 0.2, arm.read(), clock.now_s())
        arm.send(record.command)
    print(f"Then the input went stale: {step.stopped.reason if step.stopped else 'not at all'}")
