"""What the published kinds of help are worth at the marshmallows, in physics, to a noisy simulated person.

A simulated person with a reaction time and tremor brings the fork over each of three marshmallows with one
stick of two axes and three modes (x-y, z-yaw, roll-pitch), at several rationalities. Every condition meets
the same scenes and starts. Prints one table. For example:
python scripts/published_help.py --drives 10
"""

import argparse
from dataclasses import replace
from typing import Final

import numpy as np

from latentarm.assistance.catalogue import AssistanceName, published_assistance, published_belief
from latentarm.assistance.controllers.end_effector import EndEffectorController
from latentarm_research.drives.drive import Setup
from latentarm_research.drives.drives import drive_all, plan_drives
from latentarm_research.drives.trace import Trace
from latentarm_research.people.catalogue import PEOPLE
from latentarm_research.people.person import Person
from latentarm_research.tasks.over_marshmallow import OverMarshmallow

SPEED_M_S: Final = 0.2
TURN_RAD_S: Final = 0.4
"""The person's gains in Javdani et al. (2018)."""

WAYS: Final[dict[str, AssistanceName | None]] = {
    "no help": None,
    "hindsight optimisation": "hindsight",
    "HARMONIC, Low Assist (1/3)": "low_assist",
    "HARMONIC, High Assist (2/3)": "high_assist",
    "HARMONIC, Full Assist (1)": "full_assist",
    "policy blending": "policy_blending",
}

HEAD: Final = (
    "β (1/m²)",
    "help",
    "reached",
    "of each marshmallow",
    "time (s)",
    "input (s)",
    "idle (s)",
    "mode switches",
)

RATIONALITIES: Final = (50.0, 200.0, 1000.0)
"""beta of equation 24, 1/m²."""


def main() -> None:
    """Drive, and print the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--drives", type=int, default=10, help="for each marshmallow")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--jobs", type=int, default=1)
    parser.add_argument("--beta", type=float, nargs="*", default=[*RATIONALITIES])
    options = parser.parse_args()
    print(f"| {' | '.join(HEAD)} |")
    print(f"|---:|---|{'---:|' * (len(HEAD) - 2)}")
    for beta in options.beta:
        for name, help_by in WAYS.items():
            planned = plan_drives([[setup(help_by, noisy(beta))]], options.drives, options.seed)
            (traces,) = drive_all([planned], options.jobs)
            print(f"| {beta:g} | {name} | {' | '.join(figures(traces))} |", flush=True)


def noisy(beta: float) -> Person:
    """A simulated person with a reaction time and tremor, who is this rational."""
    unsteady = PEOPLE["unsteady"]
    return replace(unsteady, decides=replace(unsteady.decides, beta=beta))


def setup(help_by: AssistanceName | None, person: Person) -> Setup:
    """Everything that a condition is driven with."""
    task = OverMarshmallow()
    return Setup(
        task,
        EndEffectorController(task.robot, SPEED_M_S, TURN_RAD_S),
        person,
        None if help_by is None else published_assistance(help_by, task.robot),
        rule=published_belief(task.robot),
    )


def figures(traces: list[Trace]) -> list[str]:
    """How many arrive; mean and SD of the other figures over all drives, failed ones until they ended."""
    arrived: dict[int, int] = {}
    for trace in traces:
        arrived[trace.choice] = arrived.get(trace.choice, 0) + trace.figures.success
    columns = [
        [trace.figures.time_s for trace in traces],
        [trace.figures.input_magnitude for trace in traces],
        [trace.figures.idle_s for trace in traces],
        [float(trace.figures.mode_switches) for trace in traces],
    ]
    spread = [f"{np.mean(values):.1f} ± {np.std(values, ddof=1):.1f}" for values in columns]
    each = ", ".join(str(arrived[choice]) for choice in sorted(arrived))
    return [f"{sum(arrived.values())} of {len(traces)}", each, *spread]


if __name__ == "__main__":
    main()
