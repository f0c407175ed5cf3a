"""What is measured of drives: one figure for each."""

from collections.abc import Mapping
from functools import partial
from typing import Final

import numpy as np

from latentarm.core.types import BoolArray, FloatArray
from latentarm.models.decoder import Decoder
from latentarm.models.tool_contexts import ROTATION_WEIGHT_M, TWIST
from latentarm_research.assistance import bound
from latentarm_research.studies.shared_autonomy.drive import GAIN_PER_S, STEP_S, Drives, Scene

ARRIVED: Final = 0.2  # state error, in the distance between the goals, below which a drive has arrived

EVERY: Final = 10  # what decoders could do is looked at in every tenth step: once a second

FINENESS: Final = 4
"""Of the decoder's enclosure: for the study's decoders sigma_h is then 7 to 28 % above the largest action
found by sampling."""

DAMPING_M2: Final = 1e-2
"""Weight of a joint's motion by 1 rad in the metric of the tools, relative to a tool's motion by 1 m."""

BALLS: Final[dict[str, bound.Others]] = {
    "certified_share_eq_14": bound.furthest,
    "certified_share_known_help": bound.known_help,
}
"""Forms of the bound in which the person may do anything up to sigma_h, from the loosest to the tightest."""


def measure(drives: Drives, scene: Scene, decoder: Decoder) -> dict[str, FloatArray]:
    """The figures of P drives, each (P,).

    - ``final_state_error``: ``‖s_T - g*‖`` in the distance between the goals.
    - ``time_s``: until the state error is below `ARRIVED` for the first time; of a drive that never arrives
      all the time it had. ``arrival_rate``: whether it arrives.
    - ``certified_share_...``: where, in every tenth step, the bound says that the distance to the goal of
      that moment shrinks, whatever the person does with the help as it is: by equation 14, with the help
      known, with the decoder known as well, and the last in the metric of the tools.
    """
    error = state_error(drives, scene)
    within = error < ARRIVED
    arrived = within.any(axis=-1)
    certificates = certify(drives, scene, decoder)
    return {
        "final_state_error": error[:, -1],
        "time_s": STEP_S * np.where(arrived, within.argmax(axis=-1), error.shape[-1] - 1),
        "arrival_rate": arrived.astype(float),
        **{name: share.mean(axis=-1) for name, share in certificates.items()},
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


def certify(drives: Drives, scene: Scene, decoder: Decoder) -> Mapping[str, BoolArray]:
    """Steps in which a bound says that the arm comes nearer, each (P, T / 10), by name."""
    at = drives.moments
    state, belief, alpha = (part[:, ::EVERY] for part in (at.state, at.belief, at.alpha))
    wanted = at.wanted[:, ::EVERY]
    enclosure = decoder.enclose(np.concatenate([state, belief], axis=-1), FINENESS)
    if enclosure is None:
        raise TypeError(f"no enclosure of the {decoder.kind} decoder is known")
    sigma_h = enclosure.largest()
    error = scene.goals[wanted] - state
    towards = {
        "certified_share_decoder": error,
        "certified_share_tools": np.matvec(tool_metric(scene)[wanted], error),
    }
    shares = {
        name: bound.certified(sigma_h, state, belief, scene.goals, wanted, alpha, GAIN_PER_S, others=others)
        for name, others in BALLS.items()
    }
    along = partial(bound.certified_along, state=state, belief=belief, goals=scene.goals, alpha=alpha)
    return shares | {
        name: along(enclosure.furthest(-w), w, gain_per_s=GAIN_PER_S) for name, w in towards.items()
    }


def tool_metric(scene: Scene) -> FloatArray:
    """The metric of the tools at each goal, ``J^T W J + damping 1``, (G, n, n), m²."""
    weight = np.array([1.0] * 3 + [ROTATION_WEIGHT_M] * (TWIST - 3))
    jacobian = scene.chain.jacobian(scene.goals) * weight[:, None]
    return jacobian.mT @ jacobian + DAMPING_M2 * np.eye(scene.goals.shape[-1])
