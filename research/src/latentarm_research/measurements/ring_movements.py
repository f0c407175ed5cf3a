"""Movements between targets on rings: those of AutonomyFitts' persons, and those of simulated people.

The persons move a Franka's tool, which follows the position of a Falcon. The simulated people's stick says
how fast a point goes.
"""

import csv
import io
import json
import tempfile
from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from pathlib import Path
from typing import Final

import numpy as np
from scipy.signal import find_peaks, savgol_filter

from latentarm.assistance.controllers.axis_modes import AxisModes
from latentarm.assistance.controllers.end_effector import EndEffectorController
from latentarm.core.types import Context, FloatArray, Pose
from latentarm.core.untrusted.opening import read_bytes
from latentarm.robots.catalogue import load_robot
from latentarm_research.people.contract import LoopLimits
from latentarm_research.people.person import SimulatedPerson
from latentarm_research.people.population import TRAITS, draw_people
from latentarm_research.people.traits import Traits

SEED: Final = 39  # of the simulated people, and of the halves of the study's persons

RINGS: Final = np.array([(0.06, 0.02), (0.12, 0.02), (0.06, 0.01), (0.12, 0.01)])
"""Radius and width of targets, m. A cell is a ring, and 4 more in the second half of the trials."""

ORDER: Final = np.array([0, 5, 1, 6, 2, 7, 3, 8, 4])
"""Of the nine targets of a ring. The way to the first of them does not count."""

MOST_BYTES: Final = 1 << 27  # length of a log
LOG_S: Final = 0.025  # time between samples, in which a target is also seen to be reached, s

PLANE: Final = """<mujoco><worldbody><body name="x"><joint name="x" type="slide" axis="1 0 0" range="-1 1"/>
<geom size=".01"/><body name="y"><joint name="y" type="slide" axis="0 1 0" range="-1 1"/><geom size=".01"/>
<site name="tool"/></body></body></worldbody></mujoco>"""

PERSON, RING, TRIAL, TIME, ERROR, CORRECTIONS = range(6)
"""Columns of movements: person from 0, ring from 0, trial from 1, time from target to target, s; largest
distance from the straight line, m; and peaks of the speed after the first."""

SPREADS: Final = {one.name: one.spread for one in TRAITS}


def measured(
    who: Sequence[int], at_s: FloatArray, tool_m: FloatArray, ends_s: FloatArray
) -> list[FloatArray]:
    """A trial's movements: samples of the tool (n, 2), and when each of 8 targets was reached."""
    even_s = np.arange(at_s[0], at_s[-1], LOG_S)
    even_m = np.stack([np.interp(even_s, at_s, one) for one in tool_m.T], axis=1)
    speed = np.linalg.norm(np.asarray(savgol_filter(even_m, 7, 2, deriv=1, delta=LOG_S, axis=0)), axis=1)
    peaks, _ = find_peaks(speed, prominence=0.1 * np.percentile(speed, 95))
    rows = []
    for begin_s, end_s in pairwise(ends_s):
        during = (even_s >= begin_s) & (even_s <= end_s)
        way = even_m[during] - even_m[during][0]
        off_m = np.abs(way @ np.array([[0.0, -1.0], [1.0, 0.0]]) @ way[-1]).max() / np.linalg.norm(way[-1])
        rows.append(np.array([*who, end_s - begin_s, off_m, max(during[peaks].sum() - 1, 0)]))
    return rows


def logged(clone: Path) -> FloatArray:
    """The movements of the study's persons without autonomy."""
    rows = list[FloatArray]()
    csv.field_size_limit(2**24)
    for person in range(24):
        folder = clone / f"ros2_ws/src/cpp_pubsub/data_logging/csv_logs/part{person + 1}"
        header = io.StringIO(read_bytes(folder / f"part{person + 1}_header.csv", MOST_BYTES).decode())
        trials = [one for one in csv.DictReader(header) if one["alpha_id"] == "5"]
        for one in trials:
            log = io.BytesIO(read_bytes(folder / f"trial{one['trial_number']}.csv", MOST_BYTES))
            target, at_s, *tool_m = np.loadtxt(log, delimiter=",", skiprows=1, usecols=(0, 19, 16, 17)).T
            ends_s = at_s[np.flatnonzero(np.diff(target)) + 1]
            # When the last target was reached only the header says.
            ends_s = np.append(ends_s, ends_s[-1] + json.loads(one["mt_list"])[-1])
            who = (person, int(one["ring_id"]) - 1, int(one["trial_number"]))
            rows += measured(who, at_s, np.stack(tool_m, axis=1), ends_s)
    return np.array(rows)


@dataclass(frozen=True)
class Figures:
    """What is fitted: the study's device at full deflection, m/s; medians over people; a spread.

    Where nothing is given, the people are those of before.
    """

    full_m_s: float
    push_variation: float = 0.15
    decision_s: float = 0.5
    learning: float = 0.2
    own_speed_width: float = 0.2

    def person(self, drawn: Traits) -> Traits:
        """Who keeps their place among all people in every trait."""
        own, names = SPREADS["own_speed"], ("push_variation", "decision_s", "learning")
        traits = {name: getattr(drawn, name) * getattr(self, name) / SPREADS[name].middle for name in names}
        share = own.middle * (drawn.own_speed / own.middle) ** (self.own_speed_width / own.width)
        return replace(drawn, **traits, own_speed=min(share, 1.0))


def simulated(figures: Figures, number: int, trials: Sequence[Sequence[tuple[int, int]]]) -> FloatArray:
    """The movements of so many people, who take turns with the study's persons' trials and rings."""
    with tempfile.TemporaryDirectory() as folder:
        (model := Path(folder) / "plane.xml").write_text(PLANE, encoding="utf-8")
        robot = load_robot(model)
    home = robot.chain.forward(np.zeros(2))
    controller = EndEffectorController(robot, figures.full_m_s, modes=AxisModes(("x-y",), ((0, 1),)))
    angle, rows = 2.0 * np.pi * ORDER / len(ORDER), list[FloatArray]()
    for drawn in draw_people(number, SEED):
        traits = figures.person(drawn)
        for trial, ring in trials[traits.number % len(trials)]:
            targets, within_m = (
                RINGS[ring, 0] * np.stack([np.cos(angle), np.sin(angle)], axis=1),
                RINGS[ring, 1] / 2,
            )
            rng = np.random.default_rng([SEED, traits.number, trial])
            operator = SimulatedPerson(robot, traits.person(trial - 1), LOG_S, LoopLimits(dead_zone=0.02))
            samples, ends_s = [targets[0]], [0.0]
            while len(ends_s) < len(ORDER):
                q, now_s, target = samples[-1], (len(samples) - 1) * LOG_S, targets[len(ends_s)]
                # After 15 s they give up.
                if np.linalg.norm(q - target) < within_m or now_s - ends_s[-1] > 15.0:
                    ends_s.append(now_s)
                wanted = Pose(home.position + np.append(target, 0.0), home.rotation)
                here = Context(q, np.zeros(0))
                given = operator.act(here, controller, 0, wanted, rng, within_m)
                samples.append(q + LOG_S * controller.action(given.u, here, 0))
            at_s = LOG_S * np.arange(len(samples), dtype=np.float64)
            rows += measured((traits.number, ring, trial), at_s, np.array(samples), np.array(ends_s[1:]))
    return np.array(rows)
