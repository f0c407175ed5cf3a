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


def fit_affine(model: LatentActionModel, answers: Answers, seed_index: int = 0) -> AffineAlignment:
    """The affine map that best fits the answers to the encoded motions; the smallest of several.

    Raises UserError where the model is not fitted, has no such seed, or the answers do not fit it.
    """
    model.decoder(seed_index)  # refuses a seed that is not there
    z = model.encode(answers.motions.context, answers.motions.action)[seed_index]
    inputs = np.concatenate([answers.u, np.ones((len(answers), 1))], axis=1)
    solution = np.linalg.lstsq(inputs, z, rcond=None)[0]
    return AffineAlignment(matrix=solution[:-1].T, offset=solution[-1])
