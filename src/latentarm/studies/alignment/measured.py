"""Everything that the study measured."""

from collections.abc import Sequence
from dataclasses import dataclass

from latentarm.studies.alignment.cell import CellResult
from latentarm.studies.alignment.curves import CurveResult
from latentarm.studies.alignment.decoder import LearnedDecoder
from latentarm.studies.alignment.drives import DrivesResult


@dataclass(frozen=True, eq=False)
class Measured:
    """All results, in the order of the tables.

    Attributes:
        decoders: that the alignments stand on.
        results: the cells of the table, by task, model and noise.
        curves: by noise, model and task.
        drives: one for each kind of model that was driven with.
    """

    decoders: Sequence[LearnedDecoder]
    results: Sequence[CellResult]
    curves: Sequence[CurveResult]
    drives: Sequence[DrivesResult]
