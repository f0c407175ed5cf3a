"""Manual Align: the baseline of section 8.3 that needs no training."""

from dataclasses import dataclass
from typing import final

import numpy as np

from latentarm.alignment.answers import Answers
from latentarm.core.types import FloatArray
from latentarm.models.model import LatentActionModel


@final
@dataclass(frozen=True, eq=False)
class AffineAlignment:
    """``z = A u + b``, the same in every context."""

    matrix: FloatArray  # (d, d), A
    offset: FloatArray  # (d,), b

    def __call__(self, u: FloatArray, context: FloatArray) -> FloatArray:
        """Latent actions (..., d) of inputs (..., d); the context does not count."""
        return u @ self.matrix.T + self.offset


def fit_affine(model: LatentActionModel, answers: Answers) -> AffineAlignment:
    """The affine map that best fits the answers to the encoded motions; the smallest of several."""
    z = model.encode(answers.motions.context, answers.motions.action)[0]
    inputs = np.concatenate([answers.u, np.ones((len(answers), 1))], axis=1)
    solution = np.asarray(np.linalg.lstsq(inputs, z, rcond=None)[0], dtype=np.float64)
    return AffineAlignment(matrix=solution[:-1].T, offset=solution[-1])
