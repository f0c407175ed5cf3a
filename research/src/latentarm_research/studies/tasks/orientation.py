"""Learning which orientation the tool has in which place, for the study's baseline after HITL-D."""

import warnings
from collections.abc import Mapping
from typing import Any, Final

import numpy as np
from sklearn.exceptions import ConvergenceWarning
from sklearn.neural_network import MLPRegressor

from latentarm.core.types import Demonstrations, FloatArray
from latentarm.demonstrations.gripper import GRIPPER_WIDTH
from latentarm.demonstrations.things import ENVIRONMENT
from latentarm.robots.kinematics.chain import Chain
from latentarm.robots.kinematics.pose_rows import STORED, seen_rows
from latentarm_research.baselines.learned_orientation import OrientationMap, features
from latentarm_research.studies.streams import generator, integer, sequence
from latentarm_research.studies.tasks.cell import ModelCell
from latentarm_research.studies.tasks.moved import task_of
from latentarm_research.studies.tasks.preset import Stream

NOISE_M: Final = 0.02
"""SD of how far the tool is moved from where it was shown, along each axis, m: its orientation stays."""

DRAWS: Final = 3  # times that each sample is moved so


def orient(cell: ModelCell) -> OrientationMap:
    """Learn the orientations of a task's demonstrations."""
    chain = task_of(cell.task, Stream.DEMONSTRATIONS).robot.chain
    use = (cell.seed, cell.task, Stream.NETWORKS)
    how: dict[str, Any] = {
        "hidden_layer_sizes": cell.preset.hidden,
        "batch_size": cell.preset.batch_size,
        "max_iter": cell.preset.epochs,
        "random_state": integer(sequence(*use)),
    }
    return learned(cell.demonstrations, chain, how, generator(*use))


def learned(
    demonstrations: Demonstrations, chain: Chain, how: Mapping[str, Any], rng: np.random.Generator
) -> OrientationMap:
    """What demonstrations say of the tool's orientation."""
    episodes = demonstrations.episodes
    sees_gripper = GRIPPER_WIDTH in episodes[0].extras
    pose = chain.forward(np.concatenate([one.state for one in episodes]))
    rows = np.concatenate([one.extras[ENVIRONMENT] for one in episodes]) if demonstrations.objects else None
    count = len(pose.position)
    objects = np.zeros((count, 0, 9)) if rows is None else seen_rows(rows.reshape(count, -1, STORED))
    gripper = np.zeros((count, 0))
    if sees_gripper:
        gripper = np.concatenate([one.extras[GRIPPER_WIDTH] for one in episodes])
    moved = pose.position + NOISE_M * rng.normal(size=(DRAWS, count, 3))
    inputs = features(moved, np.broadcast_to(objects, (DRAWS, *objects.shape)), gripper)
    inputs = inputs.reshape(DRAWS * count, -1)
    centre, scale = inputs.mean(axis=0), np.maximum(inputs.std(axis=0), 1e-3)
    columns = np.tile(pose.rotation[..., :2].reshape(count, 6), (DRAWS, 1))
    regressor = MLPRegressor(activation="tanh", **how)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", ConvergenceWarning)  # It learns for as long as it is told to.
        regressor.fit((inputs - centre) / scale, columns)
    weights: list[FloatArray] = [np.asarray(one, dtype=np.float64) for one in regressor.coefs_]
    biases: list[FloatArray] = [np.asarray(one, dtype=np.float64) for one in regressor.intercepts_]
    weights[0] = weights[0] / scale[:, None]
    biases[0] = biases[0] - centre @ weights[0]
    return OrientationMap(demonstrations.objects, sees_gripper, tuple(zip(weights, biases, strict=True)))
