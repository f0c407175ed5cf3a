"""Hand-made decoders and arms whose true figures are known in closed form."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import pytest

from latentarm.core.types import FloatArray, Pose


@dataclass(frozen=True)
class FormulaDecoder:
    """A decoder that is a formula."""

    latent_dim: int
    formula: Callable[[FloatArray, FloatArray], FloatArray]

    def decode(self, z: FloatArray, context: FloatArray) -> FloatArray:
        return self.formula(z, context)


class GantryArm:
    """Sliding joints: the tool's position is the first three joints (zero where there are fewer)."""

    def forward(self, q: FloatArray, tool: int = 0) -> Pose:
        position = np.zeros((*q.shape[:-1], 3))
        used = min(3, q.shape[-1])
        position[..., :used] = q[..., :used]
        return Pose(position=position, rotation=np.broadcast_to(np.eye(3), (*position.shape, 3)))


def linear(matrix: FloatArray, offset: FloatArray | float = 0.0) -> FormulaDecoder:
    """a = M z + offset, the same in every state."""
    return FormulaDecoder(matrix.shape[1], lambda z, context: z @ matrix.T + offset)


def turning(rate: float) -> FormulaDecoder:
    """a = R(rate * s_0) z: one direction of motion that turns with the first joint."""

    def formula(z: FloatArray, context: FloatArray) -> FloatArray:
        angle = rate * context[..., 0]
        cos, sin = np.cos(angle), np.sin(angle)
        return np.stack([cos * z[..., 0] - sin * z[..., 1], sin * z[..., 0] + cos * z[..., 1]], axis=-1)

    return FormulaDecoder(2, formula)


@pytest.fixture(scope="session")
def gantry() -> GantryArm:
    return GantryArm()


@pytest.fixture(scope="session")
def linear_decoder() -> Callable[..., FormulaDecoder]:
    return linear


@pytest.fixture(scope="session")
def turning_decoder() -> Callable[[float], FormulaDecoder]:
    return turning


@pytest.fixture(scope="session")
def formula_decoder() -> type[FormulaDecoder]:
    return FormulaDecoder
