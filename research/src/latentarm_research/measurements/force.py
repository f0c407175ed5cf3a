"""Measure how hard an arm presses on what its safety filters do not know, and for how long after its stop.

A Panda in MuJoCo with 1 kg at its tool, noise on its readings, and readings that are 0 to 3 ticks late, is
pushed down at 100 Hz with full input, from places over the whole table. Most of the time the stick points
straight down; the rest of the time anywhere. The thing is the table, or a spring without mass and friction
that begins above it. With ``--feels`` the arm estimates external torques, and a force ends the pushing.
Otherwise the following error does: the joints move less far than they are commanded to. Where that has not
happened after 4 s, the person presses Stop.
"""

import itertools
from dataclasses import replace
from functools import partial
from typing import Final, final

import mujoco
import numpy as np

from latentarm.arms.mujoco import MujocoArm
from latentarm.assistance.controllers.end_effector import EndEffectorController
from latentarm.control.clock import SimulatedClock
from latentarm.control.step import Step
from latentarm.core.types import FloatArray, Input, Pose, Reading
from latentarm.robots.kinematics.obstacles import HalfSpace
from latentarm.robots.panda import panda
from latentarm.robots.robot import Robot
from latentarm.robots.scene.scene import TABLE, TOOL, Scene
from latentarm.safety.config import SafetyConfig
from latentarm.safety.zones import Zone
from latentarm.tasks.inverse_kinematics import solve
from latentarm_research.measurements.catalogue import Force
from latentarm_research.measurements.measurement import Outcome, Work, line
from latentarm_research.measurements.pushing import LATE_TICKS, PERIOD_S, enabled, imperfect

PRESSED_TICKS: Final = 400

UNTOUCHED_TICKS: Final = 600  # a drive that has touched nothing by then is over
UP_AND_DOWN: Final = 1  # the controller's mode whose first axis moves the tool up and down
BOTH: Final = (min(TOOL, TABLE), max(TOOL, TABLE))

AT_M: Final = ((0.35, 0.6), (-0.3, 0.3), (0.06, 0.12))  # where the tool starts, x, y and z, m
SPRING_M: Final = 0.05  # where springs begin, above the table, m
AFTER_S: Final = (0.0, 0.2, 1.0, 3.0)  # times after the stop at which the force is read, s
WATCHED_TICKS: Final = round(AFTER_S[-1] / PERIOD_S)


def measure(options: Force, work: Work) -> Outcome:
    """Median and largest force at the table, known or not, and at each spring, of the drives that touched."""
    rows = []
    springs = [(f"{one:g} N/mm", one) for one in options.stiffness_n_mm]
    for name, stiffness in [("known table", None), ("table", None), *springs]:
        place_m = np.array([0.0, 0.0, 0.0 if stiffness is None else SPRING_M])
        thing = HalfSpace("thing", place_m, np.array([0.0, 0.0, 1.0]))
        config = SafetyConfig(
            obstacles=(thing,) if name == "known table" else (),
            zones=(Zone(thing, options.zone),) if options.zone else (),
        )
        cells = [(work.seed, number) for number in range(options.drives)]
        touched = [
            one
            for one in work.each(partial(drive, stiffness, config, options.feels), cells)
            if one is not None
        ]
        found = {"touched_drives": len(touched)}
        if touched:
            forces = np.array(touched)
            median, most = np.median(forces, axis=0), forces.max(axis=0)
            found |= {"stopped_by_itself": forces[:, -1].sum(), "touch_to_stop_median_s": median[0]}
            for index, when in enumerate(("peak", *(f"{after_s:g}_s_after" for after_s in AFTER_S)), 1):
                found |= {f"{when}_median_n": median[index], f"{when}_most_n": most[index]}
        rows += line("force", name, options.drives, found)
    return Outcome(rows)


@final
class Thing:
    """A thing that the arm presses on."""

    def __init__(
        self,
        arm: MujocoArm,
        stiffness_n_mm: float | None,  # of the spring, N/mm; None for the table
    ) -> None:
        self._arm = arm
        self._stiffness = stiffness_n_mm
        self._tool = arm.model.site(panda().chain.tools[0].name).id
        self._peak_n = self._now_n = 0.0
        mujoco.set_mjcb_passive(None if stiffness_n_mm is None else self._push)

    def _push(self, model: mujoco.MjModel, data: mujoco.MjData) -> None:
        at = data.site_xpos[self._tool]
        force_n = 1e3 * (self._stiffness or 0.0) * max(0.0, SPRING_M - at[2])
        self._now_n = force_n
        self._peak_n = max(self._peak_n, force_n)
        up, body = np.array([0.0, 0.0, force_n]), model.site_bodyid[self._tool]
        mujoco.mj_applyFT(model, data, up, np.zeros(3), at, body, data.qfrc_passive)

    def force_n(self) -> float:
        """The largest force since the last call, N."""
        table_n = self._arm.scene_state().force_n.get(BOTH, 0.0)
        peak_n, self._peak_n = self._peak_n, 0.0
        return table_n if self._stiffness is None else peak_n

    def felt(self, reading: Reading) -> FloatArray | None:
        """The external torque of a reading, (n,), N m, with that of the spring, which the arm omits."""
        if reading.external_torque is None:
            return None
        return reading.external_torque + self._now_n * panda().chain.jacobian(reading.q)[2]


def start(robot: Robot, rng: np.random.Generator) -> FloatArray:
    """A configuration with the tool over the table, pointing down, (n,), rad."""
    place = np.array([rng.uniform(*span) for span in AT_M])
    home = robot.chain.forward(robot.home)
    return solve(robot, Pose(place, home.rotation), robot.home)


def drive(
    stiffness_n_mm: float | None,  # of the spring, N/mm; None for the table
    config: SafetyConfig,
    feels: bool,  # whether the arm estimates external torques
    cell: tuple[int, int],
) -> FloatArray | None:
    """Push down once.

    Returns the time from touch to stop, s; the peak, and the forces at `AFTER_S`, N; whether the arm stopped
    by itself. None where it touched nothing.
    """
    late, robot, rng = LATE_TICKS[cell[1] % len(LATE_TICKS)], panda(), np.random.default_rng(cell)
    clock = SimulatedClock()
    arm = MujocoArm(robot, start(robot, rng), clock.now_s, imperfect(late, rng), Scene())
    thing, step = Thing(arm, stiffness_n_mm), Step(robot, EndEffectorController(robot), config, dt_s=PERIOD_S)
    first = enabled(arm, step, clock, late, inputs=2)
    step.choose_mode(UP_AND_DOWN)
    forces: list[float] = []
    touch = stop = None
    for tick in itertools.count():
        clock.wait_until(PERIOD_S * (first + tick))
        if stop is None and touch is not None and tick == touch + PRESSED_TICKS:
            step.stop("Stop was pressed.")
        u = np.array([-1.0, 0.0]) if rng.uniform() < 0.8 else rng.uniform(-1.0, 1.0, 2)
        reading = arm.read()
        felt = thing.felt(reading) if feels else None
        record = step(Input(u), 0.0, replace(reading, external_torque=felt), clock.now_s())
        arm.send(record.command)
        forces.append(thing.force_n())
        touch = tick if touch is None and forces[-1] > 0.0 else touch
        stop = tick if stop is None and record.command.stop is not None else stop
        if (touch is None and tick > UNTOUCHED_TICKS) or (stop is not None and tick >= stop + WATCHED_TICKS):
            break
    mujoco.set_mjcb_passive(None)
    if touch is None or stop is None:
        return None
    after = [forces[stop + round(after_s / PERIOD_S)] for after_s in AFTER_S]
    return np.array([PERIOD_S * (stop - touch), max(forces), *after, stop < touch + PRESSED_TICKS])
