"""How far an adversary takes the tool from what was demonstrated, with a way back and without.

Models are trained briefly on the simulated table and get one way back, which does not depend on the kind.
From demonstrated states the adversary gives, at every step, the one of 32 full pushes that leads away fastest
from the nearest demonstrated place in the metric of the tools. Some of the drives pass the safety filters.

For example: python scripts/way_back_adversary.py homogeneous cvae
"""

import sys
from collections.abc import Callable
from dataclasses import replace
from typing import Any, Final

import numpy as np
from scipy.spatial import KDTree

from latentarm.core.types import FloatArray
from latentarm.models.catalogue import KINDS, MODELS
from latentarm.models.decoder import Decoder
from latentarm.models.saved_chain import chain_tensors
from latentarm.models.tool_contexts import ROTATION_WEIGHT_M
from latentarm.models.way_back.runtime import NETWORK
from latentarm.safety.config import SafetyConfig
from latentarm.safety.stack import SafetyStack
from latentarm.tasks.table_top import TABLE_HEIGHT, TableTop

STARTS: Final = 64
STEPS: Final = 1000
STEP_S: Final = 0.02
FILTERED: Final = 2
"""Starts of the drives through the safety filters."""

MARKS_S: Final = (1.0, 5.0, 20.0)
TASK: Final = TableTop()
CHAIN: Final = TASK.robot.chain
TURNED_M: Final = ROTATION_WEIGHT_M / np.sqrt(2.0)
"""Entries of rotations times this differ by `ROTATION_WEIGHT_M` per rad between near poses."""

Decode = Callable[[FloatArray, FloatArray], FloatArray]


def farthest(decode: Decode, tree: KDTree, state: FloatArray) -> tuple[FloatArray, FloatArray]:
    """How far tools (N,) are from what was demonstrated, m, and the actions (N, n) that lead away fastest."""
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


def chased(decode: Decode, tree: KDTree, state: FloatArray) -> FloatArray:
    """Distances (STEPS + 1, N), m, from states (N, n) on; joints stop at their limits."""
    limits, distances = TASK.robot.limits, []
    for _ in range(STEPS + 1):
        distance, action = farthest(decode, tree, state)
        distances.append(distance)
        state = np.clip(state + STEP_S * action, limits.lower, limits.upper)
    return np.array(distances)


def filtered(decode: Decode, tree: KDTree, state: FloatArray) -> tuple[float, float]:
    """From one state (n,) on through the safety filters: largest distance and least height of the arm, m."""
    stack, capsules = (
        SafetyStack(SafetyConfig(obstacles=TASK.obstacles), TASK.robot, STEP_S),
        TASK.robot.capsules,
    )
    found: list[tuple[float, float]] = []
    for _ in range(STEPS):
        distance, action = farthest(decode, tree, state[None])
        ends = np.stack(capsules.placed(CHAIN, CHAIN.link_transforms(state)))[..., 2] - capsules.radius
        found.append((float(distance[0]), float(ends[:, capsules.link >= 0].min()) - TABLE_HEIGHT))
        state = state + STEP_S * stack.command(action[0], state, 0.0).velocity
    return max(one[0] for one in found), min(one[1] for one in found)


def main(kinds: list[str]) -> None:
    """Train, chase, and print a table in Markdown."""
    demonstrations, rng = TASK.demonstrate(30, np.random.default_rng(0)), np.random.default_rng(1)
    states = np.concatenate([one.state for one in demonstrations.episodes])
    tree, starts = KDTree(coordinates(states)), rng.choice(states, STARTS)
    led = MODELS["pca"](way_back_m=0.06).fit(demonstrations).trained_
    own = {name: one for name, one in led.tensors.items() if name.startswith(NETWORK)} | chain_tensors(CHAIN)
    speed = own[f"{NETWORK}.scale"][0]
    print(f"v = {1000 * speed:.0f} mm/s; median and largest distance (mm), and its fastest growth\n")
    marks = " | ".join(f"after {mark:g} s" for mark in MARKS_S)
    print(f"| | | {marks} | growth (v) | filtered: distance | clearance |\n|---|---|" + "---:|" * 6)
    for kind in kinds:
        few: dict[str, Any] = {} if kind == "pca" else {"epochs": 2}
        plain = MODELS[kind](**few).fit(demonstrations).trained_
        sizes = replace(plain.dimensions, tools=len(CHAIN.tools), way_back=led.dimensions.way_back)
        with_it = replace(plain, dimensions=sizes, tensors={**plain.tensors, **own})
        for name, trained in (("alone", plain), ("way back", with_it)):
            decode = Decoder(trained).decode
            distance = chased(decode, tree, starts)
            at = [1000 * distance[round(mark / STEP_S)] for mark in MARKS_S]
            cells = [f"{np.median(one):.0f}, {one.max():.0f}" for one in at]
            ends = 1000 * np.array([filtered(decode, tree, one) for one in starts[:FILTERED]])
            cells += [f"{np.diff(distance, axis=0).max() / (STEP_S * speed):.2f}"]
            cells += [f"{ends[:, 0].max():.0f}", f"{ends[:, 1].min():.1f}"]
            print(f"| {kind} | {name} |", " | ".join(cells), "|", flush=True)


if __name__ == "__main__":
    main(sys.argv[1:] or list(KINDS))
