"""How near latent actions bring a tool to a cup that was moved, by what the decoder sees of the cup.

Behind the table in docs/models.md, "What the decoder sees", and docs/decisions/0038. A Panda is led to a cup
in scripted demonstrations; a table stands still. Then a greedy operator drives with a stick of one axis.
It takes about 6 minutes: python scripts/moved_things.py
"""

import warnings
from collections.abc import Callable, Mapping
from functools import partial
from typing import Final
from unittest.mock import patch

import numpy as np

from latentarm.core.context import OBJECTS_IN_TOOL, ContextLayout, context_vector
from latentarm.core.types import Context, Demonstrations, Episode, FloatArray
from latentarm.demonstrations.things import ENVIRONMENT
from latentarm.models import prepared
from latentarm.models.catalogue import MODELS
from latentarm.models.decoder import Decoder
from latentarm.models.scaling import (
    UNSEEN,
    CollapseWarning,
    Normaliser,
    context_normaliser,
    feature_normaliser,
)
from latentarm.robots.panda import panda

ARM: Final = panda()
CHAIN: Final = ARM.chain
TABLE: Final = np.array([0.5, 0.3, 0.0])
MOVED: Final = np.array([0.2, -0.3, 0.0])
MIDDLE: Final = CHAIN.forward(ARM.home).position - np.array([0.0, 0.0, 0.25])
HALF_M: Final = 0.1
"""Half the side of the region in which the cup is demonstrated, m."""

NOISE_M: Final = 0.001
"""Of every measured position, m."""

PERIOD_S: Final = 0.05
NEAR_M: Final = 0.02
CONTEXTS: Final = (("joints",), ("joints", "objects"), ("joints", "objects_in_tool"))

Rule = Callable[[FloatArray, FloatArray, ContextLayout], Normaliser]


def by_own_spread(recorded: FloatArray, framed: FloatArray, layout: ContextLayout) -> Normaliser:
    """Every entry by its own spread, as the joints."""
    return context_normaliser(framed)


def nothing_left_out(recorded: FloatArray, framed: FloatArray, layout: ContextLayout) -> Normaliser:
    """At least 5 cm, also for what stood still."""
    ours = feature_normaliser(recorded, framed, layout)
    return Normaliser(ours.centre, np.where(ours.scale == UNSEEN, 0.05, ours.scale))


def left_out_in_base_alone(recorded: FloatArray, framed: FloatArray, layout: ContextLayout) -> Normaliser:
    """In the tool's frame, what varies there is seen, also of a thing that stood still."""
    return feature_normaliser(framed, framed, layout)


RULES: Final[Mapping[str, Rule]] = {
    "as shipped": feature_normaliser,
    "left out in the base frame alone": left_out_in_base_alone,
    "nothing left out": nothing_left_out,
    "by its own spread": by_own_spread,
}


def cup(rng: np.random.Generator, outside_m: float = 0.0) -> FloatArray:
    """A place within the region, or so far outside it along one axis."""
    place = rng.uniform(-HALF_M, HALF_M, 2)
    if outside_m:
        place[rng.integers(2)] = np.sign(rng.normal()) * (HALF_M + outside_m)
    return MIDDLE + np.array([*place, 0.0])


def start(rng: np.random.Generator) -> FloatArray:
    """About the home position."""
    return ARM.home + rng.normal(scale=0.08, size=7)


def demonstration(rng: np.random.Generator) -> Episode:
    """Straight to the cup at 25 cm/s, slower near it."""
    q, goal = start(rng), cup(rng)
    states = [q]
    for _ in range(120):
        way = goal - CHAIN.forward(q).position
        left = float(np.linalg.norm(way))
        if left < 0.01:
            break
        jacobian = CHAIN.jacobian(q)[:3]
        velocity = way * min(0.25 / left, 2.0)
        q = q + PERIOD_S * jacobian.T @ np.linalg.solve(jacobian @ jacobian.T + 1e-4 * np.eye(3), velocity)
        states.append(q)
    upright = np.array([1.0, 0.0, 0.0, 0.0])
    seen = [np.concatenate([_measured(goal, rng), upright, _measured(TABLE, rng), upright]) for _ in states]
    return Episode(np.array(states), np.arange(len(states)) * PERIOD_S, extras={ENVIRONMENT: np.array(seen)})


def _measured(position: FloatArray, rng: np.random.Generator) -> FloatArray:
    return position + rng.normal(scale=NOISE_M, size=3)


def drive(decoder: Decoder, rng: np.random.Generator, outside_m: float, moved: FloatArray) -> float:
    """The least distance that remains, m."""
    q, goal, least = start(rng), cup(rng, outside_m), np.inf
    inputs = np.linspace(-1, 1, 21)[:, None]
    upright = [1.0, 0.0, 0.0, 1.0, 0.0, 0.0]
    objects = np.array([[*goal, *upright], [*(TABLE + moved), *upright]])
    for _ in range(160):
        context = context_vector(Context(q, np.zeros(0), objects=objects), decoder.layout.features)
        actions = decoder.decode(inputs, context)
        actions = actions / np.maximum(1.0, np.abs(actions).max(axis=1, keepdims=True))
        reached = q + PERIOD_S * actions
        left = np.linalg.norm(CHAIN.forward(reached).position - goal, axis=1)
        q, least = reached[left.argmin()], min(least, float(left.min()))
    return least


def main() -> None:
    """Print one line for each model, rule and context."""
    rng = np.random.default_rng(0)
    shown = Demonstrations(
        tuple(demonstration(rng) for _ in range(60)),
        20.0,
        ARM.joint_names,
        robot="panda",
        objects=("cup", "table"),
    )
    still = np.zeros(3)
    situations = {"inside": (0.0, still), "10 cm": (0.1, still), "20 cm": (0.2, still), "table": (0.0, MOVED)}
    warnings.simplefilter("ignore", CollapseWarning)
    for kind in ("cae", "homogeneous"):
        for name, rule in RULES.items():
            for context in CONTEXTS if name == "as shipped" else CONTEXTS[1:]:
                if name == "left out in the base frame alone" and OBJECTS_IN_TOOL not in context:
                    continue
                made = partial(
                    MODELS[kind], latent_dim=1, context=context, seeds=3, state_noise_rad=0.05, window=3
                )
                with patch.object(prepared, "feature_normaliser", rule):
                    model = made().fit(shown, chain=CHAIN)
                print(f"{kind}, {name}, {' '.join(context)}:", end="")
                for situation, (outside_m, moved) in situations.items():
                    dice = np.random.default_rng(5)
                    left = np.array(
                        [
                            drive(model.decoder(seed), dice, outside_m, moved)
                            for seed in range(3)
                            for _ in range(20)
                        ]
                    )
                    near = 100 * (left < NEAR_M).mean()
                    print(f"  {situation} {1000 * np.median(left):.0f} mm ({near:.0f} %)", end="")
                print(flush=True)


if __name__ == "__main__":
    main()
