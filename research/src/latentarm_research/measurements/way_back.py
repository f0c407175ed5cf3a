"""Measure how far an adversary takes the tool from what was demonstrated, with a way back and without.

Models are trained briefly on the simulated table and get one way back, which does not depend on the kind.
From demonstrated states the adversary gives, at every step, the one of 32 full pushes that leads away fastest
from the nearest demonstrated place in the metric of the tools. Some of the drives pass the safety filters.
"""

from collections.abc import Callable
from dataclasses import replace
from typing import Any, Final

import numpy as np
from scipy.spatial import KDTree

from latentarm.core.errors import UserError
from latentarm.core.types import FloatArray
from latentarm.models.catalogue import KINDS
from latentarm.models.decoder import Decoder
from latentarm.models.estimators import MODELS
from latentarm.models.saved_chain import chain_tensors
from latentarm.models.tool_contexts import ROTATION_WEIGHT_M
from latentarm.models.way_back.runtime import NETWORK
from latentarm.safety.config import SafetyConfig
from latentarm.safety.stack import SafetyStack
from latentarm.tasks.table_top import TABLE_HEIGHT, TableTop
from latentarm_research.measurements.catalogue import WayBack
from latentarm_research.measurements.measurement import Outcome, Work, line

STEP_S: Final = 0.02
FILTERED: Final = 2  # starts of the drives through the safety filters
MARKS_S: Final = (1.0, 5.0, 20.0)
CLEARANCE_M: Final = SafetyConfig().clearance
TASK: Final = TableTop()
CHAIN: Final = TASK.robot.chain
TURNED_M: Final = ROTATION_WEIGHT_M / np.sqrt(2.0)
"""Entries of rotations times this differ by `ROTATION_WEIGHT_M` per rad between near poses."""

Decode = Callable[[FloatArray, FloatArray], FloatArray]


def measure(options: WayBack, work: Work) -> Outcome:
    """Distances after some time, their fastest growth, and how near filtered drives come to the table."""
    if unknown := set(options.kinds) - set(KINDS):
        raise UserError(f"There is no model {min(unknown)!r}: choose from {', '.join(KINDS)}.")
    demonstrations = TASK.demonstrate(30, np.random.default_rng(work.seed))
    rng = np.random.default_rng(work.seed + 1)
    states = np.concatenate([one.state for one in demonstrations.episodes])
    tree, starts = KDTree(coordinates(states)), rng.choice(states, options.starts)
    led = MODELS["pca"](way_back_m=0.06).fit(demonstrations).trained_
    own = {name: one for name, one in led.tensors.items() if name.startswith(NETWORK)} | chain_tensors(CHAIN)
    speed = float(own[f"{NETWORK}.scale"][0])
    rows, broken = [], list[str]()
    for kind in options.kinds or KINDS:
        few: dict[str, Any] = {} if kind == "pca" else {"epochs": 2}
        plain = MODELS[kind](**few).fit(demonstrations).trained_
        sizes = replace(plain.dimensions, tools=len(CHAIN.tools), way_back=led.dimensions.way_back)
        with_it = replace(plain, dimensions=sizes, tensors={**plain.tensors, **own})
        for name, trained in ((kind, plain), (f"{kind}, way back", with_it)):
            decode = Decoder(trained).decode
            distance = chased(decode, tree, starts, options.steps)
            ends = 1000 * np.array([filtered(decode, tree, one, options.steps) for one in starts[:FILTERED]])
            figures: dict[str, float] = {}
            for mark in MARKS_S:
                if (step := round(mark / STEP_S)) < len(distance):
                    at = 1000 * distance[step]
                    figures[f"after_{mark:g}_s_median_mm"] = float(np.median(at))
                    figures[f"after_{mark:g}_s_most_mm"] = at.max()
            figures |= {
                "fastest_growth_of_v": np.diff(distance, axis=0).max() / (STEP_S * speed),
                "filtered_most_mm": ends[:, 0].max(),
                "filtered_clearance_mm": ends[:, 1].min(),
            }
            rows += line("way-back", name, len(starts), figures)
            near = figures["filtered_clearance_mm"] < 1000 * CLEARANCE_M
            broken += [f"{name}: {figures['filtered_clearance_mm']:.3f} mm from the table"] * bool(near)
    return Outcome(rows, broken, f"v is {1000 * speed:.0f} mm/s.")


def farthest(decode: Decode, tree: KDTree, state: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Distances of tools from demonstrations (N,), m, and the actions (N, n) that lead away fastest."""
    turn = 2 * np.pi / 32 * np.arange(32)
    actions = decode(np.stack([np.cos(turn), np.sin(turn)], axis=-1)[:, None], state)
    here = coordinates(state)
    distance, nearest = tree.query(here)
    out = here - np.asarray(tree.data)[nearest]
    about = np.cross(here[:, 3:].reshape(-1, 3, 3).mT, out[:, 3:].reshape(-1, 3, 3).mT).sum(axis=1)
    twist = np.concatenate([out[:, :3], about], axis=-1)
    best = np.vecdot(np.vecmat(twist, CHAIN.jacobian(state)), actions).argmax(axis=0)
    return distance, actions[best, np.arange(len(state))]


def coordinates(state: FloatArray) -> FloatArray:
    """Coordinates (N, 12), m, that differ as much as the tools do in their metric."""
    pose = CHAIN.forward(state)
    return np.concatenate([pose.position, TURNED_M * pose.rotation.reshape(-1, 9)], axis=-1)


def chased(decode: Decode, tree: KDTree, state: FloatArray, steps: int) -> FloatArray:
    """Distances (steps + 1, N), m, from states (N, n) on; joints stop at their limits."""
    limits, distances = TASK.robot.limits, []
    for _ in range(steps + 1):
        distance, action = farthest(decode, tree, state)
        distances.append(distance)
        state = np.clip(state + STEP_S * action, limits.lower, limits.upper)
    return np.array(distances)


def filtered(decode: Decode, tree: KDTree, state: FloatArray, steps: int) -> tuple[float, float]:
    """From one state (n,) on through the safety filters: largest distance and least height of the arm, m."""
    stack = SafetyStack(SafetyConfig(obstacles=TASK.obstacles), TASK.robot, STEP_S)
    capsules = TASK.robot.capsules
    found: list[tuple[float, float]] = []
    for _ in range(steps):
        distance, action = farthest(decode, tree, state[None])
        ends = np.stack(capsules.placed(CHAIN, CHAIN.link_transforms(state)))[..., 2] - capsules.radius
        found.append((float(distance[0]), float(ends[:, capsules.link >= 0].min()) - TABLE_HEIGHT))
        state = state + STEP_S * stack.command(action[0], state, 0.0).velocity
    return max(one[0] for one in found), min(one[1] for one in found)
