"""Figures that nobody measured, to test what is made of figures."""

from types import SimpleNamespace

import numpy as np
import pytest

from latentarm_research.studies.alignment.cell import AlignmentErrors
from latentarm_research.studies.alignment.curves import CHOICES, CurveResult
from latentarm_research.studies.alignment.preset import CHOSEN, CONDITIONS, NO_ALIGN, PRESETS
from latentarm_research.studies.alignment.scene import AlignmentCell, DecoderCell, LearnedDecoder

AS_IN_THE_PAPER = (3.0, 2.0, 1.0, 0.4, 0.35, 0.4, 0.11, 0.1, 0.1, 0.1)
"""Means of the conditions, in their order."""


def decoder(task="plane", preset=PRESETS["smoke"]):
    return LearnedDecoder(DecoderCell(task, preset, 0), SimpleNamespace(), 1.0)


def make_result(means=AS_IN_THE_PAPER, task="plane", noise=0.0, runs=6, spread=0.02):
    """Runs that spread about the means by a share of them, the same way in every condition."""
    about = 1 + spread * np.linspace(-1, 1, runs)
    errors = {
        name: np.array([mean]) if name == NO_ALIGN else mean * about
        for name, mean in zip(CONDITIONS, means, strict=True)
    }
    return AlignmentErrors(
        AlignmentCell("conditions", decoder(task), noise),
        errors,
        0.05,
        dict.fromkeys(CONDITIONS[2:], 1.0),
    )


def make_curve(task="plane", noise=0.0, counts=(1, 3, 6, 10, 20), faster=1.0, runs=6):
    """Errors of 1 / n at random, and as if there were ``faster`` times as many answers by choice."""
    spread = np.linspace(0.9, 1.1, runs)
    errors = {
        choice: {count: spread / (count * (faster if choice == CHOSEN else 1.0)) for count in counts}
        for choice in CHOICES
    }
    return CurveResult(
        AlignmentCell("curve", decoder(task), noise),
        errors,
        np.full(runs, 6.0) + (np.arange(runs) % 2),
        spread / 6,
    )


@pytest.fixture
def result():
    """Make a cell's result."""
    return make_result


@pytest.fixture
def curve():
    """Make a curve."""
    return make_curve
