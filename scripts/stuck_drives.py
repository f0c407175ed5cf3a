"""Whether drives that fail at the table with three items end in true local minima of the decoder's map.

For every drive of the greedy operator that fails, the largest gain of any held input out of a fine grid, and
whether the planning operator completes the same drive. For example:
python scripts/stuck_drives.py default_model/scl/run
"""

import sys
from pathlib import Path

import numpy as np

from latentarm.controllers.latent import LatentController
from latentarm.kinematics.rotations import angle_between
from latentarm.models.saving import load_decoder
from latentarm.operators.boltzmann import BoltzmannConfig
from latentarm.operators.catalogue import PEOPLE
from latentarm.simulation.drive import Setup, simulate
from latentarm.simulation.drives import drive_plan
from latentarm.tasks.table_top import TableTop
from latentarm.types import Context, FloatArray, Pose, StepRecord

SEEDS, DRIVES, LIMIT_S = 3, 7, 40.0
HORIZONS_S = (0.05, 0.1, 0.25, 0.5, 1.0, 2.0)
STEP_S = 0.05
TASK = TableTop()


def main(run: Path) -> None:
    """Drive, and print a line for each drive that fails."""
    controllers = [LatentController(load_decoder(run, seed)) for seed in range(SEEDS)]
    plans = zip(drive_plan(TASK, DRIVES, 0), drive_plan(TASK, DRIVES, 0), strict=True)
    for number, ((goal, manner, rng), (*_, again)) in enumerate(plans):
        controller, records = controllers[number % SEEDS], list[StepRecord]()
        greedy = Setup(TASK, controller, None, PEOPLE["greedy"], LIMIT_S)
        trace = simulate(greedy, goal, manner, rng, records.append)
        if trace.figures.success:
            continue
        waypoints = TASK.waypoints(goal, manner)
        target = waypoints[round(trace.progress * len(waypoints))]
        gain = largest_gain(controller, records[-1], target)
        planned = simulate(
            Setup(TASK, controller, None, PEOPLE["planning"], LIMIT_S), goal, manner, again
        ).figures
        off_m = float(distance(records[-1].state, target))
        print(
            f"drive {number}, goal {goal}, {manner}: stuck {1e3 * off_m:.0f} mm off; no held input gains more"
            f" than {1e3 * gain:.2f} mm; planning {'takes' if planned.success else 'fails in'}"
            f" {planned.time_s:.1f} s",
            flush=True,
        )


def largest_gain(controller: LatentController, record: StepRecord, target: Pose) -> float:
    """By how much any held input would bring the tool nearer within the longest horizon, m."""
    angle, size = np.arange(720) * (np.pi / 360), np.linspace(0.02, 1.0, 50)
    inputs = (size[:, None, None] * np.stack([np.cos(angle), np.sin(angle)], axis=-1)).reshape(-1, 2)
    start, gains = distance(record.state, target), [0.0]
    for horizon_s in HORIZONS_S:
        steps = round(horizon_s / STEP_S)
        state = np.broadcast_to(record.state, (len(inputs), len(record.state)))
        for _ in range(steps):
            here = Context(state=state, belief=record.belief)
            state = state + horizon_s / steps * controller.action(inputs, here, 0)
            gains.append(float(start - distance(state, target).min()))
    return max(gains)


def distance(state: FloatArray, target: Pose) -> FloatArray:
    """Of the tool from the target, a radian counted as the simulated person does, m."""
    pose = TASK.robot.chain.forward(state)
    turned = BoltzmannConfig().rotation_weight * angle_between(pose.rotation, target.rotation)
    return np.sqrt(np.square(pose.position - target.position).sum(axis=-1) + np.square(turned))


if __name__ == "__main__":
    main(Path(sys.argv[1]))
