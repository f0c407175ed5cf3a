"""Judge streams of joint velocities at 1 kHz by the motion limits that franka-sim enforces for an FR3.

It runs in an environment of its own, because franka-sim pins old versions of NumPy and MuJoCo:

    python -m venv ENV && ENV/bin/pip install franka-sim==1.1.7
    ENV/bin/python scripts/franka_oracle.py STREAM.npz

A stream has ``dq`` (T, 7), rad/s, and ``q`` (T, 7), rad, of each cycle of 1 ms. What breaks a limit aborts
the motion, as on the arm; the person enables it again a second later.
"""

import json
import sys
from collections import Counter
from typing import Final

import numpy as np
from franka_sim.control_modes import ControlMode
from franka_sim.motion_limits import MotionLimitChecker

REST_CYCLES: Final = 50
"""A motion ends after so many cycles of zero velocity."""

ENABLED_AFTER: Final = 1000
"""Cycles after a reflex until the person has enabled the arm again."""


def judge(q: np.ndarray, dq: np.ndarray) -> dict[str, object]:
    """Replay one stream, and count reflexes."""
    checker = MotionLimitChecker(enforce=True)
    reflexes: Counter[str] = Counter()
    motions, cycles, number, zeros = 0, 0, 0, REST_CYCLES
    running, waits = False, 0
    before, before_that = np.zeros(7), np.zeros(7)
    for position, velocity in zip(q.tolist(), dq.tolist(), strict=True):
        stands = not any(velocity)
        zeros = zeros + 1 if stands else 0
        waits = max(0, waits - 1)
        if running and zeros >= REST_CYCLES:
            checker.end_motion()
            running = False
        if not running and not stands and waits == 0:
            acceleration = ((before - before_that) / 1e-3).tolist()
            state = {"q": position, "q_d": position, "dq_d": before.tolist(), "ddq_d": acceleration}
            motions += 1
            checker.start_motion(ControlMode.VELOCITY, state, motions)
            running = True
        if running:
            number += 1
            cycles += 1
            command = {"message_id": number, "dq_c": velocity}
            verdict = checker.absorb_command(command, position, fresh=True, enforce=True)
            if verdict.violation is not None:
                said = verdict.violation
                reflexes[f"{said.error_name}, {said.unit}"] += 1
                checker.end_motion()
                checker.recover()
                running, waits = False, ENABLED_AFTER
        before_that, before = before, np.array(velocity)
    return {
        "motions": motions,
        "cycles_in_motion": cycles,
        "reflexes": sum(reflexes.values()),
        "of_which": dict(reflexes),
    }


if __name__ == "__main__":
    stream = np.load(sys.argv[1])
    print(json.dumps(judge(stream["q"], stream["dq"])))
