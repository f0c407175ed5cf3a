from dataclasses import dataclass, field

import numpy as np
import pytest

from latentarm.models.enclosure import celled, linear_enclosure
from latentarm_research.studies.shared_autonomy.cell import TASKS
from latentarm_research.studies.shared_autonomy.drive import RULE, STEP_S, Scene

TANH_CURVATURE = 0.7699
"""Just above the largest |tanh''|, 4 / (3 sqrt 3)."""


@dataclass(frozen=True)
class Straight:
    """z moves all joints along one line, whatever the context: the decoder of a perfect linear model."""

    line: np.ndarray
    latent_dim: int = 1

    def decode(self, z, context):
        shape = np.broadcast_shapes(z.shape[:-1], context.shape[:-1])
        return np.broadcast_to(z * self.line, (*shape, len(self.line)))

    def enclose(self, context, fineness=1):
        lead = context.shape[:-1]
        columns = np.broadcast_to(self.line, (*lead, 1, len(self.line)))
        return linear_enclosure(columns, np.zeros((*lead, len(self.line))))


@dataclass(frozen=True)
class Wild:
    """A nonlinear decoder that hangs on state and belief, without any sense."""

    joints: int
    goals: int
    seed: int = 0
    latent_dim: int = 1
    weight: np.ndarray = field(init=False)

    def __post_init__(self):
        shape = (1 + self.joints + self.goals, self.joints)
        object.__setattr__(self, "weight", np.random.default_rng(self.seed).normal(0.0, 1.0, shape))

    def decode(self, z, context):
        shape = np.broadcast_shapes(z.shape[:-1], context.shape[:-1])
        parts = [np.broadcast_to(part, (*shape, part.shape[-1])) for part in (z, context)]
        return 0.4 * np.tanh(np.concatenate(parts, axis=-1) @ self.weight)

    def enclose(self, context, fineness=1):
        before = celled(self.weight[:1], context @ self.weight[1:], fineness)
        tanh = np.tanh(before.centre)
        return before.bent(tanh, 1.0 - tanh**2, TANH_CURVATURE).mapped(0.4 * np.eye(self.joints))


@pytest.fixture(scope="session")
def task():
    return TASKS["planar_two_cups"]()


@pytest.fixture(scope="session")
def scene(task):
    goals = np.stack([goal.configuration for goal in task.goals])
    return Scene(task.robot.chain, RULE(goals, period_s=STEP_S))


@pytest.fixture(scope="session")
def straight(scene):
    """z = 1 leads straight from the second goal to the first, at 0.3 rad/s."""
    one, other = scene.goals
    return Straight(0.3 * (one - other) / np.linalg.norm(one - other))


@pytest.fixture(scope="session")
def wild(scene):
    return Wild(scene.goals.shape[1], len(scene.goals))
