"""Measure what is calibrated of the SIMULATED people: the variation of pushes, the time of a switch.

The variation of pushes was fitted to Fitts's law for movements along one axis: of `VARIATIONS` it is that
with the largest r² whose slope is in the range of published ones. The time of a mode switch was fitted to the
share of time that goes into mode switches. No latent action is driven. The figures are frozen
(`people/calibration.json`, seed 1).
"""

import math
from functools import partial
from typing import Final

import numpy as np

from latentarm.assistance.controllers.axis_modes import AxisModes
from latentarm.assistance.controllers.end_effector import EndEffectorController
from latentarm.robots.catalogue import load_robot
from latentarm.tasks.catalogue import SCENE_TASKS
from latentarm_research.drives.drive import Setup, drive
from latentarm_research.drives.pointing import Pointing, point
from latentarm_research.measurements.catalogue import Calibrating
from latentarm_research.measurements.measurement import Outcome, Work, line
from latentarm_research.metrics.stick import switching
from latentarm_research.people.calibration import BEFORE, CALIBRATED, Calibration
from latentarm_research.people.population import MIRRORED, TRAITS, draw_people
from latentarm_research.studies.tables import markdown_table

PRACTICE_S: Final = 300.0  # five minutes, the most that the paper's people had, s

SHARE: Final = 0.174
"""Of execution time that goes into mode switches: able-bodied people with a JACO (Herlant, Holladay and
Srinivasa, HRI 2016)."""

SLOPES_S_PER_BIT: Final = (0.35, 0.63)
"""From a teleoperator with a replica master (2.88 bits/s: Draper, Handel and Hood 1990) to the slowest
joystick (1.6 bits/s: Soukoreff and MacKenzie 2004)."""

VARIATIONS: Final = (0.1, 0.15, 0.25, 0.35)
WIDTHS_M: Final = (0.0075, 0.015, 0.03)
"""Over distances longer than the usual ones the arm's top speed decides, whatever the width."""

PUSHED: Final = 0.05  # deflection from which the stick counts as pushed
ONE_MODE: Final = ((("x-y",), ((0, 1),)), (("z-yaw",), ((2, 5),)))  # of the stick, with no other to switch to
MOVES, DRIVES = 1, 2  # streams of randomness of movements and drives


def measure(options: Calibrating, work: Work) -> Outcome:
    """Fitts's law at each variation of pushes, and mode switches before and after the calibration."""
    rows = []
    for variation in VARIATIONS:
        calibration = Calibration(variation, BEFORE.switch_s)
        plan = [(d, w) for d in range(len(options.distances_m)) for w in range(len(WIDTHS_M))]
        times = work.each(partial(movements, options, calibration, work.seed), plan)
        difficulty = [Pointing(0, options.distances_m[d], WIDTHS_M[w]).difficulty for d, w in plan]
        means_s = [float(np.mean([one for one in each if math.isfinite(one)])) for each in times]
        slope, intercept = np.polyfit(difficulty, means_s, 1)
        failed = sum(math.isinf(one) for each in times for one in each)
        figures = {
            "slope_s_per_bit": slope,
            "intercept_s": intercept,
            "r2": float(np.corrcoef(difficulty, means_s)[0, 1]) ** 2,
            "failed_movements": failed,
        }
        condition = f"pushes vary by {variation:g}"
        rows += line("calibration", condition, sum(map(len, times)), figures, "Fitts's law")
    for name, calibration in (("before", BEFORE), ("after", CALIBRATED)):
        cells = [(person, task) for person in range(options.people) for task in options.tasks]
        drives = np.array(work.each(partial(switches, options, calibration, work.seed), cells))
        spent_s, took_s = drives[:, :2].reshape(options.people, -1, 2).sum(axis=1).T
        share = 100.0 * spent_s / took_s
        figures = {
            "switch_s": calibration.switch_s,
            "switching_percent": (share.mean(), share.std(ddof=1)),
            "drive_s": drives[:, 1].mean(),
            "mode_switches": drives[:, 2].mean(),
            "done": drives[:, 3].sum(),
        }
        rows += line("calibration", name, len(drives), figures, "Mode switches")
    low, high = SLOPES_S_PER_BIT
    aim = f"Aimed at: slopes from {low} to {high} s/bit, and {100 * SHARE:.1f} % of time in mode switches."
    return Outcome(rows, note=f"{aim}\n\n## Traits\n\n{traits()}")


def movements(
    options: Calibrating, calibration: Calibration, seed: int, cell: tuple[int, int]
) -> list[float]:
    """Times of all people's movements over one distance to one width, s; infinite where one failed."""
    d, w = cell
    robot = load_robot("panda_fork")
    level, upright = (EndEffectorController(robot, modes=AxisModes(*one)) for one in ONE_MODE)
    found = list[float]()
    for traits in draw_people(options.people, seed, calibration):
        for repeat in range(options.repeats):
            axis = (traits.number + d + w + repeat) % 3
            mode = upright if axis == 2 else level
            movement = Pointing(axis, options.distances_m[d], WIDTHS_M[w])
            rng = np.random.default_rng([seed, MOVES, traits.number, d, w, repeat])
            found.append(point(robot, mode, traits.person(0, PRACTICE_S), movement, rng))
    return found


def switches(
    options: Calibrating, calibration: Calibration, seed: int, cell: tuple[int, str]
) -> tuple[float, float, int, bool]:
    """One drive: time in mode switches and in all, s; mode switches; whether the task was done."""
    person, name = cell
    traits = draw_people(options.people, seed, calibration)[person]
    task = SCENE_TASKS[name]()
    setup = Setup(task, EndEffectorController(task.robot), traits.person(0, PRACTICE_S))
    rng = np.random.default_rng([seed, DRIVES, options.tasks.index(name), traits.number])
    trace = drive(setup, traits.number % len(task.choices), rng)
    spent = switching(trace.mode, np.linalg.norm(trace.input, axis=1) > PUSHED)
    took_s = float(trace.time_s[-1])
    return float(spent.mean()) * took_s, took_s, trace.figures.mode_switches, trace.figures.success


def traits() -> str:
    """A line for each trait, in Markdown."""
    lines = [
        (
            f"{one.meaning}, {one.unit}" if one.unit else one.meaning,
            one.spread.shape,
            f"{float(f'{one.spread.lowest:.3g}'):g} to {float(f'{one.spread.highest:.3g}'):g}",
            one.source,
        )
        for one in TRAITS
    ]
    minority = (
        "that a minority inverts it: Corbett and Munneke, Cogn. Res. Princ. Implic., 2025; share chosen"
    )
    lines.append(("second axis upside down", f"{100 * MIRRORED:g} % of people", "yes or no", minority))
    return markdown_table(("trait", "distribution over people", "range", "source"), lines)
