"""Fit the SIMULATED people to half of the persons of a public study, and predict the other half.

The study is AutonomyFitts (Pan et al., HRI 2025): 24 people move a Franka's tool by a Falcon from target to target
on rings, 0.118 or 0.236 m apart and 0.01 or 0.02 m wide. Only trials without autonomy count. Fetch
https://github.com/mpan31415/AutonomyFitts yourself; nothing of it is shipped here. For example:

    python scripts/people_from_logs.py AutonomyFitts --out people_from_logs.json
"""

import argparse
import csv
import json
import tempfile
from collections.abc import Sequence
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import Any, Final

import numpy as np
from scipy.signal import find_peaks, savgol_filter
from scipy.stats import norm

from latentarm.control.controller import Controller
from latentarm.operators.loop_limits import LoopLimits
from latentarm.operators.person import SimulatedPerson
from latentarm.operators.population import TRAITS, draw_people
from latentarm.operators.traits import Traits
from latentarm.robots.catalogue import load_robot
from latentarm.types import Context, FloatArray, IntArray, Pose

SEED: Final = 39
"""Of which persons are fitted and which predicted, and of the simulated people."""
PERSONS: Final = 24
RINGS: Final = ((0.06, 0.02), (0.12, 0.02), (0.06, 0.01), (0.12, 0.01))
"""Radius and width of targets, m."""
ORDER: Final = (0, 5, 1, 6, 2, 7, 3, 8, 4)
"""Of the nine targets of a ring. The way to the first of them does not count."""
BITS: Final = np.array([np.log2(2.0 * radius * np.sin(np.pi * 4 / 9) / width + 1.0) for radius, width in RINGS])
LOG_S: Final = 0.025
"""Time between samples, in which a target is also seen to be reached, s."""
STEP_S: Final = 0.0125
GIVES_UP_S: Final = 15.0
HALF: Final = 12
"""Trials; those after it repeat them."""
MEASURES: Final = ("time", "error", "corrections")
MOST: Final = 6
"""So many corrections and more count as one figure."""
PLANE: Final = """<mujoco><worldbody><body name="x"><joint name="x" type="slide" axis="1 0 0" range="-1 1"/>
<geom size=".01"/><body name="y"><joint name="y" type="slide" axis="0 1 0" range="-1 1"/><geom size=".01"/>
<site name="tool"/></body></body></worldbody></mujoco>"""
SPREADS: Final = {one.name: one.spread for one in TRAITS}
STEPS: Final = (0.7, 0.85, 1.2, 1.4)
"""Each figure is multiplied with these in turn while the fit gets better."""


def measured(who: Sequence[int], at_s: FloatArray, tool_m: FloatArray, ends_s: FloatArray) -> list[FloatArray]:
    """The movements of a trial, all but the first.

    Args:
        who: person from 0, ring from 0, trial from 1.
        at_s: (n,), times of samples, s.
        tool_m: (n, 2), the tool in the plane of the ring, m.
        ends_s: (8,), when each target was reached, s.

    Returns:
        7 rows of who, time from target to target, s; largest distance from the straight line, m; and peaks of
        the speed after the first.
    """
    even_s = np.arange(at_s[0], at_s[-1], LOG_S)
    even_m = np.stack([np.interp(even_s, at_s, one) for one in tool_m.T], axis=1)
    speed = np.linalg.norm(savgol_filter(even_m, 7, 2, deriv=1, delta=LOG_S, axis=0), axis=1)
    peaks, _ = find_peaks(speed, prominence=0.1 * np.percentile(speed, 95))
    rows = []
    for begin_s, end_s in zip(ends_s[:-1], ends_s[1:], strict=True):
        during = (even_s >= begin_s) & (even_s <= end_s)
        way = even_m[during] - even_m[during][0]
        off_m = np.abs(way @ np.array([[0.0, -1.0], [1.0, 0.0]]) @ way[-1]).max() / np.linalg.norm(way[-1])
        rows.append(np.array([*who, end_s - begin_s, off_m, max(during[peaks].sum() - 1, 0)]))
    return rows


def logged(clone: Path) -> FloatArray:
    """What the persons of the study did without autonomy: rows of `measured`."""
    rows = list[FloatArray]()
    csv.field_size_limit(2**24)
    for person in range(PERSONS):
        folder = clone / f"ros2_ws/src/cpp_pubsub/data_logging/csv_logs/part{person + 1}"
        with (folder / f"part{person + 1}_header.csv").open(newline="") as header:
            trials = [one for one in csv.DictReader(header) if one["alpha_id"] == "5"]
        for one in trials:
            with (folder / f"trial{one['trial_number']}.csv").open(newline="") as file:
                table = np.array(
                    [[float(row[name]) for name in ("target_id", "times", "ty", "tz")] for row in csv.DictReader(file)]
                )
            ends_s = table[np.flatnonzero(np.diff(table[:, 0])) + 1, 1]
            # When the last target was reached only the header says.
            ends_s = np.append(ends_s, ends_s[-1] + json.loads(one["mt_list"])[-1])
            who = (person, int(one["ring_id"]) - 1, int(one["trial_number"]))
            rows += measured(who, table[:, 1], table[:, 2:], ends_s)
    return np.array(rows)


class Plane(Controller):
    """The stick moves a point in a plane, at `full_m_s` when it is pushed all the way."""

    modes = ("plane",)
    input_dim = 2

    def __init__(self, full_m_s: float) -> None:
        self._full_m_s = full_m_s

    def latent(self, u: FloatArray, context: Context, mode: int) -> FloatArray:
        """The input itself."""
        return u

    def action(self, z: FloatArray, context: Context, mode: int) -> FloatArray:
        """Velocity of the point, (..., 2), m/s."""
        return self._full_m_s * z


@dataclass(frozen=True)
class Figures:
    """What is fitted; `full_m_s`, m/s, is of the study's device, and all others are medians over people."""

    full_m_s: float
    push_variation: float = SPREADS["push_variation"].middle
    decision_s: float = SPREADS["decision_s"].middle
    learning: float = SPREADS["learning"].middle
    own_speed_width: float = SPREADS["own_speed"].width

    def people(self, number: int) -> list[Traits]:
        """People who keep their places among all people in every trait."""
        own, moved = SPREADS["own_speed"], list[Traits]()
        for one in draw_people(number, SEED):
            traits = {name: getattr(one, name) for name in ("push_variation", "decision_s", "learning")}
            traits = {name: value * getattr(self, name) / SPREADS[name].middle for name, value in traits.items()}
            share = own.middle * (one.own_speed / own.middle) ** (self.own_speed_width / own.width)
            moved.append(replace(one, **traits, own_speed=min(share, 1.0)))
        return moved


def simulated(figures: Figures, number: int, trials: Sequence[Sequence[tuple[int, int]]]) -> FloatArray:
    """What so many simulated people do on the same rings: rows of `measured`.

    Args:
        figures: of which they are.
        number: of people.
        trials: ring and number of each trial of each person of the study; people take turns with them.
    """
    with tempfile.TemporaryDirectory() as folder:
        model = Path(folder) / "plane.xml"
        model.write_text(PLANE, encoding="utf-8")
        robot = load_robot(model)
    home = robot.chain.forward(np.zeros(2))
    angle = 2.0 * np.pi * np.array(ORDER) / len(ORDER)
    ways = np.stack([np.cos(angle), np.sin(angle)], axis=1)
    controller, rows = Plane(figures.full_m_s), list[FloatArray]()
    for traits in figures.people(number):
        for ring, trial in trials[traits.number % len(trials)]:
            targets, within_m = RINGS[ring][0] * ways, RINGS[ring][1] / 2.0
            rng = np.random.default_rng([SEED, traits.number, trial])
            operator = SimulatedPerson(robot, traits.person(trial - 1), STEP_S, LoopLimits(dead_zone=0.02))
            samples, ends_s = [targets[0]], [0.0]
            while len(ends_s) < len(ORDER):
                q, now_s, target = samples[-1], (len(samples) - 1) * LOG_S, targets[len(ends_s)]
                if np.linalg.norm(q - target) < within_m or now_s - ends_s[-1] > GIVES_UP_S:
                    ends_s.append(now_s)
                wanted = Pose(home.position + np.append(target, 0.0), home.rotation)
                for _ in range(round(LOG_S / STEP_S)):
                    here = Context(q, np.zeros(0))
                    given = operator.act(here, controller, 0, wanted, rng, within_m)
                    q = q + STEP_S * controller.action(given.u, here, 0)
                samples.append(q)
            at_s = LOG_S * np.arange(len(samples))
            rows += measured((traits.number, ring, trial), at_s, np.array(samples), np.array(ends_s[1:]))
    return np.array(rows)
