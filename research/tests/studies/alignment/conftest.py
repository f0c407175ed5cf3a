"""Figures that nobody measured, to test what is made of figures."""

from types import SimpleNamespace

import numpy as np
import pytest

from latentarm_research.studies.alignment.cell import AlignmentErrors
from latentarm_research.studies.alignment.preset import CONDITIONS, NO_ALIGN, PRESETS
from latentarm_research.studies.alignment.scene import AlignmentCell, DecoderCell

AS_IN_THE_PAPER = (3.0, 2.0, 1.0, 0.4, 0.35, 0.4, 0.11, 0.1, 0.1, 0.1)
"""Means of the conditions, in their order."""


def make_result(means=AS_IN_THE_PAPER, task="plane", noise=0.0, runs=6, spread=0.02):
    """Runs that spread about the means by a share of them, the same way in every condition."""
    about = 1 + spread * np.linspace(-1, 1, runs)
    errors = {
        name: np.array([mean]) if name == NO_ALIGN else mean * about
        for name, mean in zip(CONDITIONS, means, strict=True)
    }
    cell = AlignmentCell(DecoderCell(task, PRESETS["smoke"], 0), SimpleNamespace(), noise)
    return AlignmentErrors(cell, errors, {}, 0.05)


@pytest.fixture
def result():
    """Make a cell's result."""
    return make_result
