"""Manual Align: the baseline of section 8.3 that needs no training."""

import numpy as np

from latentarm.alignment.answers import Answers
from latentarm.alignment.contract import Alignment
from latentarm.models.model import LatentActionModel


def fit_affine(model: LatentActionModel, answers: Answers) -> Alignment:
    """``z = A u + b`` that best fits the answers to the encoded motions, the same in every context.

    The smallest of several.
    """
    z = model.encode(answers.motions.context, answers.motions.action)[0]
    inputs = np.concatenate([answers.u, np.ones((len(answers), 1))], axis=1)
    solution = np.asarray(np.linalg.lstsq(inputs, z, rcond=None)[0], dtype=np.float64)
    return lambda u, context: u @ solution[:-1] + solution[-1]
