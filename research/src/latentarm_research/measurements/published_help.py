"""Measure what published kinds of help are worth at the marshmallows, in physics, to a noisy person.

A simulated person with a reaction time and tremor brings the fork over each of three marshmallows with one
stick of two axes and three modes (x-y, z-yaw, roll-pitch), at several rationalities. Every condition meets
the same scenes and starts.
"""

from dataclasses import replace
from typing import Final, cast

import numpy as np

from latentarm.assistance.controllers.end_effector import EndEffectorController
from latentarm.core.errors import UserError
from latentarm_research.assistance.catalogue import AssistanceName, published_assistance, published_belief
from latentarm_research.drives.drive import Setup
from latentarm_research.drives.drives import drive_all, plan_drives
from latentarm_research.measurements.catalogue import PublishedHelp
from latentarm_research.measurements.measurement import Outcome, Work, line
from latentarm_research.people.catalogue import PEOPLE
from latentarm_research.people.person import Person
from latentarm_research.tasks.over_marshmallow import OverMarshmallow

SPEED_M_S: Final = 0.2
TURN_RAD_S: Final = 0.4  # the person's gains in Javdani et al. (2018)
NONE: Final = "none"
WAYS: Final = (NONE, "hindsight", "low_assist", "high_assist", "full_assist", "policy_blending")
"""No help, hindsight optimisation, HARMONIC with 1/3, 2/3 and all of it, and policy blending."""


def measure(options: PublishedHelp, work: Work) -> Outcome:
    """How many arrive, and mean and SD of all drives, failed ones until they ended."""
    ways = options.kinds or WAYS
    if unknown := set(ways) - set(WAYS):
        raise UserError(f"There is no help {min(unknown)!r}: choose from {', '.join(WAYS)}.")
    cells = [(beta, way) for beta in options.beta for way in ways]
    plans = [plan_drives([[setup(way, noisy(beta))]], options.drives, work.seed) for beta, way in cells]
    rows = []
    found = drive_all(plans, work.jobs, bars=work.bars)
    for (beta, way), traces in zip(cells, found, strict=True):
        arrived = {trace.choice: 0 for trace in traces}
        for trace in traces:
            arrived[trace.choice] += trace.figures.success
        columns = {
            "time_s": [trace.figures.time_s for trace in traces],
            "input_s": [trace.figures.input_magnitude for trace in traces],
            "idle_s": [trace.figures.idle_s for trace in traces],
            "mode_switches": [float(trace.figures.mode_switches) for trace in traces],
        }
        figures = {
            "reached": sum(arrived.values()),
            **{f"reached_of_marshmallow_{choice + 1}": arrived[choice] for choice in sorted(arrived)},
            **{name: (np.mean(values), np.std(values, ddof=1)) for name, values in columns.items()},
        }
        rows += line("published-help", way, len(traces), figures, f"β = {beta:g} /m²")
    return Outcome(rows)


def noisy(beta: float) -> Person:
    """A simulated person with a reaction time and tremor, who is this rational."""
    unsteady = PEOPLE["unsteady"]
    return replace(unsteady, decides=replace(unsteady.decides, beta=beta))


def setup(way: str, person: Person) -> Setup:
    """Everything that a condition is driven with."""
    task = OverMarshmallow()
    return Setup(
        task,
        EndEffectorController(task.robot, SPEED_M_S, TURN_RAD_S),
        person,
        None if way == NONE else published_assistance(cast(AssistanceName, way), task.robot),
        rule=published_belief(task.robot),
    )
