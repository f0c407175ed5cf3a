"""Learning the way back: demonstrated states that were displaced, and a network that leads back from them."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Final, final
from warnings import warn

import numpy as np
import torch
from torch import Tensor

from latentarm.core.context import GRIPPER, OBJECT, OBJECTS, OBJECTS_IN_TOOL, ContextLayout
from latentarm.core.types import BoolArray, FloatArray, Pairs
from latentarm.demonstrations.held import moved_to
from latentarm.models.batches import Batch, TrainingData
from latentarm.models.kind import TrainedModel
from latentarm.models.networks import Networks, mlp
from latentarm.models.numpy_networks import network_shapes
from latentarm.models.scaling import LEAST_SCALE, SPAN_QUANTILE, STILL, UNSEEN, Normaliser, context_normaliser
from latentarm.models.tool_contexts import PLACE, TWIST, ToolGeometry, places_and_jacobian, twist_weight
from latentarm.models.training import Report, TrainingConfig, TrainingResult, train
from latentarm.models.way_back.runtime import DAMPING_M2, NETWORK, PullContexts, metric_length
from latentarm.robots.kinematics.chain import Chain

DRAWS: Final = 6  # displacements of each demonstrated state
MOST_SAMPLES: Final = 20_000  # demonstrated states that are displaced, at most
NOISE_M: Final = 0.06  # standard deviation of the largest displacements of a tool along each axis, m
NOISE_RAD: Final = 0.4  # the same of its turns, rad
NULL_NOISE_RAD: Final = 0.1  # the same of each joint in motions that no tool shows, rad
LEAST_DISPLACED: Final = 0.15
"""Displacements below this share of the largest weigh no more than those, or they would outweigh the rest."""

HIDDEN: Final = (128, 128)  # units of each hidden layer
OUTPUT_RAD: Final = 0.1  # the network's output is multiplied by this, rad
CONFIG: Final = TrainingConfig(
    learning_rate=3e-3, epochs=30, batch_size=256, patience=6, checkpoint_interval_s=np.inf
)


class NoWayBackWarning(UserWarning):
    """The way back was no nearer to held-out demonstrations than staying, so the model has none."""


@final
@dataclass(frozen=True, eq=False)
class Displaced:
    """Displaced states."""

    context: FloatArray  # (N, c), there
    way: FloatArray  # (N, m), from there to where they were, rad
    scale: FloatArray  # (N, 1), how far they were displaced, as a share of the largest standard deviation


def displaced(
    chain: Chain, layout: ContextLayout, context: FloatArray, held: BoolArray, rng: np.random.Generator
) -> Displaced:
    """Displace the states of contexts (N, c), and with the tool the things that it holds (N, K)."""
    state = context[:, : layout.joints]
    _, jacobian = places_and_jacobian(chain, state)
    tools = len(chain.tools)
    noise = np.repeat([NOISE_M, NOISE_RAD], 3) * rng.normal(size=(len(state), tools, TWIST))
    twist = twist_weight(tools) * noise.reshape(len(state), -1)
    hidden = NULL_NOISE_RAD * rng.normal(size=state.shape)
    seen = twist - np.matvec(jacobian, hidden)
    full = hidden + np.linalg.solve(_metric(jacobian), np.matvec(jacobian.mT, seen)[..., None])[..., 0]
    scale = rng.uniform(size=(len(state), 1))
    there = state + scale * full
    return Displaced(moved_to(chain, layout, context, held, there), -scale * full, scale)


def with_way_back(
    trained: TrainedModel,
    pairs: Pairs,
    chain: Chain,
    length_m: float,
    data_seed: int,
    device: torch.device,
    report: Report | None,
) -> TrainedModel:
    """A trained model with a way back, learned from the pairs that it was trained on.

    The pull is as fast as the demonstrations from ``length_m`` on, which is L.

    Warns with NoWayBackWarning where the network is no nearer to the held-out demonstrations than staying.
    """
    layout, seeds = trained.layout, trained.summary.seeds
    outside = np.isin(pairs.episode, trained.summary.validation_episodes)
    rng = np.random.default_rng([data_seed, 3])
    contexts = PullContexts(ToolGeometry(chain), layout)
    inside = _examples(chain, layout, pairs, ~outside, rng)
    judged = _examples(chain, layout, pairs, outside, rng)
    seen, weight = _shown(contexts, inside)
    judged_seen, judged_weight = _shown(contexts, judged)
    sizes = {NETWORK: (seen.shape[1], *HIDDEN, layout.joints)}

    def learn(normaliser: Normaliser) -> TrainingResult:
        return train(
            _objective,
            network_shapes(sizes, len(seeds)),
            0,
            TrainingData(
                context=normaliser.apply(seen),
                action=inside.way / OUTPUT_RAD,
                validation_context=normaliser.apply(judged_seen),
                validation_action=judged.way / OUTPUT_RAD,
                elsewhere=seen[:0],
                later=weight,
                validation_later=judged_weight,
            ),
            seeds,
            CONFIG,
            device=device,
            report=report,
        )

    # Orientations of things that mean nothing would be learned by heart: what was held out decides.
    tried = [
        (learn(normaliser), normaliser)
        for normaliser in _normalisers(seen, layout, pairs.clean_context[~outside], len(chain.tools))
    ]
    learned, normaliser = min(tried, key=lambda one: one[0].validation_loss.mean())
    missed = np.matvec(judged_weight.reshape(-1, layout.joints, layout.joints), judged.way / OUTPUT_RAD)
    if (learned.validation_loss >= np.vecdot(missed, missed).mean()).any():
        why = "The demonstrations are too few, or too unlike each other, to learn a way back to them"
        warn(NoWayBackWarning(f"{why}, so the model has none: record more of the task."), stacklevel=3)
        return trained
    _, jacobian = places_and_jacobian(chain, pairs.clean_context[~outside][:, : layout.joints])
    speed = np.quantile(metric_length(jacobian, pairs.action[~outside]), SPAN_QUANTILE)
    return replace(
        trained,
        dimensions=replace(trained.dimensions, way_back=HIDDEN),
        tensors={
            **trained.tensors,
            **_folded(learned.weights, normaliser),
            f"{NETWORK}.scale": np.array([speed, length_m]),
        },
    )


def _examples(
    chain: Chain, layout: ContextLayout, pairs: Pairs, side: BoolArray, rng: np.random.Generator
) -> Displaced:
    """Displaced states of some of the pairs; several that begin at one sample follow each other there."""
    context, held = pairs.clean_context[side], pairs.held[side]
    new = np.concatenate([[True], (context[1:] != context[:-1]).any(axis=1)])
    rows = np.flatnonzero(new)
    rows = rows[np.linspace(0, len(rows) - 1, min(len(rows), MOST_SAMPLES)).astype(np.int64)]
    rows = np.repeat(rows, DRAWS)
    return displaced(chain, layout, context[rows], held[rows], rng)


def _shown(contexts: PullContexts, examples: Displaced) -> tuple[FloatArray, FloatArray]:
    """Inputs of the network (N, o), and the root F (N, m m) of its loss's metric.

    ``F^T F = G / (scale^2 + LEAST_DISPLACED^2)``, so that ``‖F x‖^2`` is the weighted squared error of x.
    """
    seen, jacobian = contexts.apply(examples.context)
    counted = np.sqrt(np.square(examples.scale) + LEAST_DISPLACED**2)
    factor = np.linalg.cholesky(_metric(jacobian)).mT / counted[..., None]
    return seen, factor.reshape(len(seen), -1)


def _metric(jacobian: FloatArray) -> FloatArray:
    """G (..., m, m), given ``J_w`` (..., 6 k, m)."""
    return jacobian.mT @ jacobian + DAMPING_M2 * np.eye(jacobian.shape[-1])


def _objective(networks: Networks, batch: Batch) -> Tensor:
    """The squared error in the metric of the tools, (S,)."""
    off = mlp(networks[NETWORK], batch.context) - batch.action
    factor = batch.later.unflatten(-1, (off.shape[-1], off.shape[-1]))
    return (factor * off[..., None, :]).sum(-1).square().sum(-1).mean(-1)


def _normalisers(
    seen: FloatArray, layout: ContextLayout, recorded: FloatArray, tools: int
) -> list[Normaliser]:
    """Normalisers of what the network sees, (N, o): with the orientations of things, and without.

    What did not vary in the demonstrated contexts (N, c) is not seen, as in `feature_normaliser`: where a
    thing stood still, the network is what it would be without.
    """
    plain = context_normaliser(seen)
    scale = plain.scale.copy()
    if GRIPPER in layout.features:  # the last entry
        told = recorded[:, layout.columns(GRIPPER)].std() > STILL[GRIPPER]
        scale[-1] = max(scale[-1], LEAST_SCALE[GRIPPER]) if told else UNSEEN
    feature = next((one for one in (OBJECTS, OBJECTS_IN_TOOL) if one in layout.features), None)
    if feature is None:
        return [Normaliser(plain.centre, scale)]
    units = np.repeat([1.0, 10.0], [3, OBJECT - 3])
    varied = recorded[:, layout.columns(feature)].std(axis=0).reshape(-1, OBJECT) > units * STILL[feature]
    moved, turned = varied[:, :3].any(axis=1), varied[:, 3:].any(axis=1)
    start = layout.joints + PLACE * tools
    columns = slice(start, start + 2 * varied.size)
    least = np.concatenate(
        [np.tile(units, len(varied)), np.repeat([1.0, 10.0], [3 * len(varied), 6 * len(varied)])]
    )
    floored = np.maximum(scale[columns], LEAST_SCALE[feature] * least)

    def shown(oriented: bool) -> Normaliser:
        base = varied & (np.arange(OBJECT) < (OBJECT if oriented else 3))
        told = np.concatenate([base.ravel(), np.repeat(moved, 3), np.repeat(turned & oriented, 6)])
        here = scale.copy()
        here[columns] = np.where(told, floored, UNSEEN)
        return Normaliser(plain.centre, here)

    return [shown(True), shown(False)] if turned.any() else [shown(False)]


def _folded(weights: Mapping[str, FloatArray], normaliser: Normaliser) -> dict[str, FloatArray]:
    """The weights of a network that takes what is seen as it is, and gives rad."""
    first, last = f"{NETWORK}.0", f"{NETWORK}.{len(HIDDEN)}"
    weight = weights[f"{first}.weight"] / normaliser.scale[:, None]
    return {
        **weights,
        f"{first}.weight": weight,
        f"{first}.bias": weights[f"{first}.bias"] - (normaliser.centre @ weight)[:, None],
        f"{last}.weight": OUTPUT_RAD * weights[f"{last}.weight"],
        f"{last}.bias": OUTPUT_RAD * weights[f"{last}.bias"],
    }
