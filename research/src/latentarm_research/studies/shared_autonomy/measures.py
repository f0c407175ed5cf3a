"""What is measured of drives: one figure for each."""

from collections.abc import Mapping
from functools import partial
from typing import Final

import numpy as np
import torch

from latentarm.assistance.entropy import entropy_over_goals, goal_probabilities, goal_progress
from latentarm.core.types import BoolArray, FloatArray
from latentarm.models.decoder import Decoder
from latentarm.models.tool_contexts import ROTATION_WEIGHT_M, TWIST
from latentarm.robots.kinematics.torch_chain import TorchChain
from latentarm_research.assistance import bound
from latentarm_research.studies.shared_autonomy.choice import KNOWN
from latentarm_research.studies.shared_autonomy.drive import GAIN_PER_S, STEP_S, Drives, Scene

ARRIVED: Final = 0.2  # state error, in the distance between the goals, below which a drive has arrived

HALF_WAY: Final = 0.5
"""Distance of the tool from its goal, in that between the goals, within which a drive ended there: the other
goal is then no nearer."""

OPEN: Final = 0.5
"""Progress towards a goal, of the demonstrated speed, from which it is open: some input leads there."""

EVERY: Final = 10  # what decoders could do is looked at in every tenth step: once a second

FINENESS: Final = 4
"""Of the decoder's enclosure: for the study's decoders sigma_h is then 7 to 28 % above the largest action
found by sampling."""

DAMPING_M2: Final = 1e-2
"""Weight of a joint's motion by 1 rad in the metric of the tools, relative to a tool's motion by 1 m."""

BALLS: Final[dict[str, bound.Others]] = {
    "certified_share_eq_14": bound.furthest,
    "certified_share_eq_13": bound.weighted,
    "certified_share_known_help": bound.known_help,
}
"""Forms of the bound in which the person may do anything up to sigma_h, from the loosest to the tightest."""


def measure(drives: Drives, scene: Scene, decoder: Decoder) -> dict[str, FloatArray]:
    """The figures of P drives, each (P,).

    - ``final_state_error``: ``‖s_T - g*‖`` in the distance between the goals; ``final_tool_error``: the same
      of the tool's places.
    - ``time_s``: until the state error is below `ARRIVED` for the first time; of a drive that never arrives
      all the time it had. ``arrival_rate``: whether it arrives.
    - ``success_rate``: whether the tool ends at the wanted goal, by `HALF_WAY`.
    - ``final_belief``: in the wanted goal at the end.

    And, in every tenth step:

    - ``goal_entropy``: of ``p_c(g)``, nats. ``goal_open_share``: where the wanted goal is reached or open.
    - ``certified_share_...``: where the bound says that the distance to the goal of that moment shrinks,
      whatever the person does with the help as it is: by equation 14, by equation 13, with the help known,
      with the decoder known as well, and the last in the metric of the tools.
    - ``bound_slack``: sigma_h over the largest ‖a_h‖ of a few inputs, less one.
    """
    one, other = scene.goals
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
        **{name: values.mean(axis=-1) for name, values in looked_at(drives, scene, decoder).items()},
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


def looked_at(drives: Drives, scene: Scene, decoder: Decoder) -> dict[str, FloatArray]:
    """What the decoder could do in every tenth step, by measure, each (P, T / 10)."""
    moments = drives.moments
    context = np.concatenate([moments.state, moments.belief], axis=-1)[:, ::EVERY]
    known = np.broadcast_to(KNOWN[:, None], (*context.shape[:-1], len(KNOWN), 1))
    decoded = decoder.decode(known, context[..., None, :])
    entropy, progress = _openness(scene, moments.state[:, ::EVERY], decoded)
    reached = state_error(drives, scene)[:, :-1:EVERY] < ARRIVED
    most = np.sqrt(np.vecdot(decoded, decoded)).max(axis=-1)
    sigma_h, certificates = certify(drives, scene, decoder)
    return {
        "goal_entropy": entropy,
        "goal_open_share": (goal_open(drives, progress) | reached).astype(float),
        # A decoder that does nothing leaves no slack.
        "bound_slack": np.divide(sigma_h - most, most, out=np.zeros_like(most), where=most > 0.0),
        **{name: share.astype(float) for name, share in certificates.items()},
    }


def goal_open(drives: Drives, progress: FloatArray) -> BoolArray:
    """Whether an input leads to the wanted goal, by the fastest progress to each: (P, T, G) to (P, T)."""
    return np.take_along_axis(progress, drives.target[:, None, None], axis=-1)[..., 0] >= OPEN


def certify(drives: Drives, scene: Scene, decoder: Decoder) -> tuple[FloatArray, Mapping[str, BoolArray]]:
    """sigma_h, rad/s, and by name where a bound says that the arm comes nearer, each (P, T / 10)."""
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
    return sigma_h, shares | {
        name: along(enclosure.furthest(-w), w, gain_per_s=GAIN_PER_S) for name, w in towards.items()
    }


def tool_metric(scene: Scene) -> FloatArray:
    """The metric of the tools at each goal, ``J^T W J + damping 1``, (G, n, n), m²."""
    weight = np.array([1.0] * 3 + [ROTATION_WEIGHT_M] * (TWIST - 3))
    jacobian = scene.chain.jacobian(scene.goals) * weight[:, None]
    return jacobian.mT @ jacobian + DAMPING_M2 * np.eye(scene.goals.shape[-1])


def _openness(scene: Scene, state: FloatArray, decoded: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Entropy of ``p_c(g)`` (...,), nats, and the fastest progress to each goal (..., G)."""
    states, actions, goals = (torch.tensor(values) for values in (state, decoded, scene.goals))
    progress = goal_progress(states, actions, goals, scene.speed, TorchChain(scene.chain))
    entropy = entropy_over_goals(goal_probabilities(progress))
    return entropy.numpy(), progress.amax(dim=-2).numpy()
