"""Record adversarial driving as the 1 kHz stream that an FR3 would get, for `franka_oracle.py` to judge.

A stick at random, modes, the hand, stops, inputs that come late and ticks that are missed, through `Step`
with its safety filters, the driver's own limits, and franky's motion generator, as its source has it: Ruckig
over the velocities, from the velocity commanded last and the acceleration that the arm reports (some cycles
old), at 0.99 of the limits, in step over the joints, then libfranka's low-pass filter of 100 Hz. Without
``--late-cycles`` the arm's report is one cycle old.

    python scripts/franka_replay.py --ticks 100000 --out full.npz
    python scripts/franka_replay.py --ticks 20000 --without stack --out without_stack.npz
    python scripts/franka_replay.py --ticks 20000 --without resampling --out held.npz

The oracle must bite: without the safety stack, or with commands that are held for 10 ms, it finds reflexes.
"""

import argparse
import json
import math
from collections import deque
from pathlib import Path
from typing import Final, final

import numpy as np
import ruckig

from clearance_drives import Pusher
from latentarm.arms.franka.limits import FR3, SHARE
from latentarm.assistance.controllers.end_effector import EndEffectorController
from latentarm.control.step import Step
from latentarm.core.types import FloatArray, GripperAsk, GripperReading, Input, Reading, Stop
from latentarm.robots.panda import fr3
from latentarm.safety.config import SafetyConfig

CYCLES: Final = 10
"""Of 1 ms in a tick of the loop."""

EPISODE_TICKS: Final = 500
LOW_PASS_HZ: Final = 100.0
GAIN: Final = 1e-3 / (1e-3 + 1.0 / (2.0 * math.pi * LOW_PASS_HZ))
"""`franka::lowpassFilter`."""


@final
class Franky:
    """Joint velocities in each cycle from commands of bounded duration, as franky makes them.

    Args:
        late_cycles: how old the acceleration is that the arm reports.
    """

    def __init__(self, late_cycles: int) -> None:
        self._generator = ruckig.Ruckig(7, 1e-3)
        self._input = ruckig.InputParameter(7)
        self._output = ruckig.OutputParameter(7)
        self._input.max_velocity = (SHARE * FR3.acceleration).tolist()
        self._input.max_acceleration = (SHARE * FR3.jerk).tolist()
        self._input.max_jerk = [math.inf] * 7
        self._input.synchronization = ruckig.Synchronization.Time
        self._input.current_acceleration = [0.0] * 7
        self._filtered = np.zeros(7)
        self._reported: deque[FloatArray] = deque([np.zeros(7)] * (late_cycles + 1), late_cycles + 1)
        self._left = 0
        self._stopping = True

    def command(self, velocity: FloatArray, cycles: int) -> None:
        """A new motion takes over; in ``cycles`` a stop takes over from it."""
        self._left, self._stopping = cycles, False
        self._aim(velocity)

    def cycle(self) -> FloatArray:
        """(7,), the velocity that the arm is sent, rad/s."""
        if self._left == 0 and not self._stopping:
            self._stopping = True
            self._aim(np.zeros(7))
        self._left -= 1
        result = self._generator.update(self._input, self._output)
        if result not in (ruckig.Result.Working, ruckig.Result.Finished):
            raise RuntimeError(f"Ruckig answers {result}")
        self._output.pass_to_input(self._input)
        before = self._filtered
        wanted = np.array(self._input.current_position)
        self._filtered = GAIN * wanted + (1.0 - GAIN) * before
        if self._stopping and np.abs(self._filtered).max() < 1e-9:
            self._filtered = np.zeros(7)
        self._reported.append((self._filtered - before) / 1e-3)
        return self._filtered

    def _aim(self, velocity: FloatArray) -> None:
        # The velocity commanded last is the generator's own; libfranka filters what it is given.
        self._input.current_velocity = np.clip(
            self._reported[0], -SHARE * FR3.acceleration, SHARE * FR3.acceleration
        ).tolist()
        self._input.target_position = velocity.tolist()
        self._input.target_velocity = [0.0] * 7
        self._generator.reset()


@final
class Held:
    """Commands held until the next one, or until they run out: what must not be done."""

    def __init__(self) -> None:
        self._velocity, self._left = np.zeros(7), 0

    def command(self, velocity: FloatArray, cycles: int) -> None:
        """Replace the command before."""
        self._velocity, self._left = velocity, cycles

    def cycle(self) -> FloatArray:
        """(7,), rad/s."""
        self._left -= 1
        return self._velocity if self._left >= 0 else np.zeros(7)


@final
class Adversary:
    """What a person at their worst does, with an interface and a machine at theirs."""

    def __init__(self, rng: np.random.Generator) -> None:
        self._rng = rng
        self._u = np.zeros(2)
        self._wanted = np.zeros(7)
        self._neutral = 0
        self.missed = 0

    def input(self, pusher: Pusher | None, *, stopped: bool) -> tuple[Input, float, bool, bool]:
        """What happens in this tick.

        Returns:
            The input, its age in s, whether Stop is pressed, and whether the arm is to be enabled.
        """
        rng = self._rng
        if rng.random() < 0.2:
            self._u = rng.uniform(-1.0, 1.0, 2) if rng.random() < 0.7 else rng.choice([-1.0, 1.0], 2)
            if pusher is not None:
                pusher.wanted = rng.uniform(-3.0, 3.0, 7)
        if stopped and self._neutral == 0:
            self._neutral = int(rng.integers(3, 20))
        self._neutral = max(0, self._neutral - 1)
        u = np.zeros(2) if self._neutral else self._u
        ask: GripperAsk | None = "toggle" if rng.random() < 0.01 else None
        age_s = 0.0 if rng.random() < 0.98 else float(rng.choice([0.03, 0.06, 0.3, math.inf]))
        if self.missed == 0 and rng.random() < 0.01:
            self.missed = int(rng.integers(1, 8))
        given = Input(u if pusher is None else u[:1], rng.random() < 0.02, ask)
        return given, age_s, rng.random() < 0.003, stopped and self._neutral == 1


def record(ticks: int, without: str, late_cycles: int, seed: int) -> tuple[FloatArray, FloatArray, int]:
    """Drive for so many ticks.

    Returns:
        Positions and velocities in each cycle, each (T, 7), and in how many ticks the arm was enabled.
    """
    robot, rng = fr3(), np.random.default_rng(seed)
    arm = Held() if "resampling" in without else Franky(late_cycles)
    q, dq = robot.home.copy(), np.zeros(7)
    positions, velocities = np.empty((ticks * CYCLES, 7)), np.empty((ticks * CYCLES, 7))
    who, engaged, at, sent_s = Adversary(rng), 0, 0, 0.0
    pusher: Pusher | None = None
    step = _step(pusher)
    for tick in range(ticks):
        time_s = 0.01 * tick
        if tick % EPISODE_TICKS == 0 and step.at_rest and not dq.any():
            pusher = Pusher(7) if rng.random() < 0.5 else None
            step = _step(pusher)
            step.reset(q)
        given, age_s, stop, enable = who.input(pusher, stopped=step.stopped is not None)
        if who.missed:
            who.missed -= 1
        else:
            velocity = np.zeros(7)
            if "stack" in without:
                velocity = pusher.wanted * given.u[0] if pusher is not None else rng.uniform(-3, 3, 7)
            else:
                if time_s - sent_s > step.hold_s:
                    step.halted(Stop("late"))
                if stop:
                    step.stop("pressed")
                reading = Reading(q.copy(), dq.copy(), time_s, tick, GripperReading(0.04))
                velocity = step(given, age_s, reading, time_s).command.velocity
                step.sent(time_s)
                if enable:
                    step.enable()
                engaged += step.stopped is None
            sent_s = time_s
            arm.command(FR3.slowed(velocity, q), round(1000 * step.hold_s))
        for _ in range(CYCLES):
            dq = arm.cycle()
            q = np.clip(q + 1e-3 * dq, FR3.lower, FR3.upper)
            positions[at], velocities[at] = q, dq
            at += 1
    return positions, velocities, engaged


def _step(pusher: Pusher | None) -> Step:
    controller = EndEffectorController(fr3(), linear_speed=0.5) if pusher is None else pusher
    return Step(fr3(), controller, SafetyConfig(), dt_s=0.01)


def main() -> None:
    """Record, and say how fast it was."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--ticks", type=int, default=100_000)
    parser.add_argument("--without", choices=("", "stack", "resampling", "stack and resampling"), default="")
    parser.add_argument("--late-cycles", type=int, default=1)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--out", type=Path, required=True)
    options = parser.parse_args()
    q, dq, engaged = record(options.ticks, options.without, options.late_cycles, options.seed)
    np.savez(options.out, q=q, dq=dq)
    acceleration = np.diff(dq, axis=0) / 1e-3
    jerk = np.diff(acceleration, axis=0) / 1e-3
    shares = {
        "speed": np.abs(dq / FR3.velocity).max(),
        "acceleration": np.abs(acceleration / FR3.acceleration).max(),
        "jerk": np.abs(jerk / FR3.jerk).max(),
    }
    print(json.dumps({"ticks": options.ticks, "enabled": engaged} | {k: float(v) for k, v in shares.items()}))


if __name__ == "__main__":
    main()
