"""Judge streams of joint velocities at 1 kHz by the motion limits that franka-sim enforces for an FR3.

It runs in an environment of its own, because franka-sim pins old versions of NumPy and MuJoCo:

    python -m venv ENV && ENV/bin/pip install franka-sim==1.1.7
    ENV/bin/python scripts/franka_oracle.py STREAM.npz [--lost 0.001]

A stream has ``dq`` (T, 7), rad/s, and ``q`` (T, 7), rad, of each cycle of 1 ms. What breaks a limit aborts
the motion, as on the arm; the person enables it again a second later. Each cycle needs its answer: the arm
extrapolates one that is lost, and aborts the motion after 20 in a row. With ``--lost``, that share of answers
never comes, each by itself at random; the stream does not react to that, as franky would.
"""

import argparse
import json
from collections import Counter
from typing import Final

import numpy as np
from franka_sim.comm_constraints import CommConstraintTracker
from franka_sim.control_modes import ControlMode
from franka_sim.motion_limits import MotionLimitChecker

REST_CYCLES: Final = 50
"""A motion ends after so many cycles of zero velocity."""

ENABLED_AFTER: Final = 1000
"""Cycles after a reflex until the person has enabled the arm again."""


def judge(q: np.ndarray, dq: np.ndarray, lost: np.ndarray) -> dict[str, object]:
    """Replay one stream, and count reflexes; ``lost`` (T,) says which answers never come."""
    checker, network = MotionLimitChecker(enforce=True), CommConstraintTracker(enforce=True)
    reflexes: Counter[str] = Counter()
    motions, cycles, number, zeros, missed = 0, 0, 0, REST_CYCLES, 0
    running, waits = False, 0
    before, before_that = np.zeros(7), np.zeros(7)
    for position, velocity, never_comes in zip(q.tolist(), dq.tolist(), lost.tolist(), strict=True):
        stands = not any(velocity)
        zeros = zeros + 1 if stands else 0
        waits = max(0, waits - 1)
        if running and zeros >= REST_CYCLES:
            checker.end_motion()
            network.end_motion()
            running = False
        if not running and not stands and waits == 0:
            acceleration = ((before - before_that) / 1e-3).tolist()
            state = {"q": position, "q_d": position, "dq_d": before.tolist(), "ddq_d": acceleration}
            motions += 1
            checker.start_motion(ControlMode.VELOCITY, state, motions)
            network.start_motion(motions)
            running = True
        if running:
            number += 1
            cycles += 1
            said = ""
            closed = network.tick(number)
            if closed.violation_triggered:
                said = "communication_constraints_violation"
            elif closed.lost:
                missed += 1
                guess = checker.extrapolate(closed.closed_id)
                if guess is not None and guess[1] is not None:
                    said = f"{guess[1].error_name}, {guess[1].unit}, in a lost cycle"
            if not said and not never_comes:
                network.command_received(number)
                command = {"message_id": number, "dq_c": velocity}
                verdict = checker.absorb_command(command, position, fresh=True, enforce=True)
                if verdict.violation is not None:
                    said = f"{verdict.violation.error_name}, {verdict.violation.unit}"
            if said:
                reflexes[said] += 1
                checker.end_motion()
                checker.recover()
                network.end_motion()
                network.recover()
                running, waits = False, ENABLED_AFTER
        before_that, before = before, np.array(velocity)
    return {
        "motions": motions,
        "cycles_in_motion": cycles,
        "lost_cycles": missed,
        "reflexes": sum(reflexes.values()),
        "of_which": dict(reflexes),
    }


def main() -> None:
    """Judge a stream, and print what came of it as JSON."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("stream")
    parser.add_argument("--lost", type=float, default=0.0, help="share of answers that never come")
    parser.add_argument("--seed", type=int, default=0, help="of which those are")
    options = parser.parse_args()
    stream = np.load(options.stream)
    lost = np.random.default_rng(options.seed).random(len(stream["q"])) < options.lost
    print(json.dumps(judge(stream["q"], stream["dq"], lost)))


if __name__ == "__main__":
    main()
