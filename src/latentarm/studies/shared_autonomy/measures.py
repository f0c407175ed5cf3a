"""What is measured of drives: one figure for each."""

from typing import Final

import numpy as np

from latentarm.assistance.bound import Others, certified, furthest, known_help, weighted
from latentarm.studies.shared_autonomy.drive import GAIN_PER_S, STEP_S, Drives, Scene
from latentarm.types import BoolArray, FloatArray

ARRIVED: Final = 0.2
"""State error, in the distance between the goals, below which a drive has arrived."""

HALF_WAY: Final = 0.5
"""Distance of the tool from its goal, in that between the goals, within which a drive ended there: the other
goal is then no nearer."""

OPEN: Final = 0.5
"""Progress towards a goal, of the demonstrated speed, from which it is open: some input leads there."""

CERTIFICATES: Final[dict[str, Others]] = {
    "certified_share_eq_14": furthest,
    "certified_share_eq_13": weighted,
    "certified_share_known_help": known_help,
}
"""Three forms of the bound, each at least as tight as the one before."""


def measure(drives: Drives, scene: Scene) -> dict[str, FloatArray]:
    """The figures of P drives, each (P,).

    - ``final_state_error``: ``‖s_T - g*‖`` in the distance between the goals; ``final_tool_error``: the same
      of the tool's places.
    - ``time_s``: until the state error is below `ARRIVED` for the first time; of a drive that never arrives
      all the time it had. ``arrival_rate``: whether it arrives.
    - ``success_rate``: whether the tool ends at the wanted goal, by `HALF_WAY`.
    - ``final_belief``: in the wanted goal at the end.
    - ``goal_entropy``: of ``p_c(g)``, mean over the steps, nats. ``goal_open_share``: of the steps in which
      the wanted goal is reached or open.
    - ``certified_share_...``: of the steps in which the bound says that the error to the goal of that moment
      shrinks, whatever the person does: by equation 14, by equation 13, and with the help known.
    """
    moments, (one, other) = drives.moments, scene.goals
    goal = scene.goals[drives.target]
    apart = np.linalg.norm(one - other)
    error = state_error(drives, scene)
    places = scene.chain.forward(scene.goals).position
    tool = scene.chain.forward(drives.state).position
    tool_error = np.linalg.norm(tool - places[drives.target], axis=-1) / np.linalg.norm(places[0] - places[1])
    within = error < ARRIVED
    arrived = within.any(axis=-1)
    steps = error.shape[-1] - 1
    return {
        "final_state_error": np.linalg.norm(drives.state - goal, axis=-1) / apart,
        "final_tool_error": tool_error,
        "time_s": STEP_S * np.where(arrived, within.argmax(axis=-1), steps),
        "arrival_rate": arrived.astype(float),
        "success_rate": (tool_error < HALF_WAY).astype(float),
        "final_belief": np.take_along_axis(drives.belief, drives.target[:, None], axis=-1)[:, 0],
        "goal_entropy": moments.goal_entropy.mean(axis=-1),
        "goal_open_share": goal_open(drives, error).mean(axis=-1),
        **{name: share.mean(axis=-1) for name, share in certificates(drives, scene).items()},
    }


def state_error(drives: Drives, scene: Scene) -> FloatArray:
    """``‖s_t - g*‖`` in the distance between the two goals, (P, T + 1)."""
    state = np.concatenate([drives.moments.state, drives.state[:, None]], axis=1)
    one, other = scene.goals
    away = state - scene.goals[drives.target][:, None]
    return np.linalg.norm(away, axis=-1) / np.linalg.norm(one - other)


def true_belief(drives: Drives) -> FloatArray:
    """Belief in the goal that is wanted in the end, (P, T + 1)."""
    belief = np.concatenate([drives.moments.belief, drives.belief[:, None]], axis=1)
    return np.take_along_axis(belief, drives.target[:, None, None], axis=-1)[..., 0]


def goal_open(drives: Drives, error: FloatArray) -> BoolArray:
    """Whether the wanted goal is reached or open, (P, T)."""
    progress = np.take_along_axis(drives.moments.progress, drives.target[:, None, None], axis=-1)[..., 0]
    return (progress >= OPEN) | (error[:, :-1] < ARRIVED)


def certificates(drives: Drives, scene: Scene) -> dict[str, BoolArray]:
    """Where each form of the bound says that the arm comes nearer to the goal of that moment, (P, T)."""
    at = drives.moments
    return {
        name: certified(
            at.sigma_h, at.state, at.belief, scene.goals, at.wanted, at.alpha, GAIN_PER_S, others=others
        )
        for name, others in CERTIFICATES.items()
    }
