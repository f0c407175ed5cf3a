"""The verdict on a model: which of a few thresholds it misses, in words."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

from latentarm.core.types import Row


@dataclass(frozen=True)
class Threshold:
    """A limit on a measure that every useful model should meet."""

    measure: str  # a name in `latentarm.evaluation.measures.MEASURES`, or of one of its axes
    worst: float  # the figure from which on it is missed
    least: bool  # whether figures below ``worst`` miss it, instead of figures from there on
    meaning: str  # in a person's words
    scale: float = 1.0  # factor for showing figures
    unit: str = ""  # after a shown figure

    def missed_by(self, figure: float) -> bool:
        """Whether a figure misses it."""
        return figure < self.worst if self.least else figure >= self.worst


THRESHOLDS: Final = (
    Threshold(
        "search_error_percent_of_pca",
        100.0,
        False,
        "expresses the actions no better than PCA",
        unit=" % of its error",
    ),
    Threshold("drift", 0.10, False, "moves at rest", 100.0, " % of the speed of motion"),
    Threshold("reversal", 0.30, False, "the opposite push does not go back", 100.0, " % is left"),
    Threshold(
        "reversal_2_s", 0.30, False, "after 2 s the opposite push does not go back", 100.0, " % is left"
    ),
    Threshold("motion_turn", 2.0, False, "the motion turns faster than the stick", unit=" times"),
    Threshold("r2_local_axis_0", 0.5, True, "axis 1 does not move the tool in proportion", unit=" R²"),
    Threshold("r2_local_axis_1", 0.5, True, "axis 2 does not move the tool in proportion", unit=" R²"),
    Threshold("disentanglement_deg", 20.0, True, "both axes move the tool alike", unit="°"),
)
"""The thresholds of the verdict. They are choices, not results: drift of a tenth of the speed of motion is
visible, and if a third of a motion remains, a person cannot undo it with the opposite push. Where the motion
turns twice as fast as the stick, two pushes 90° apart can give opposite motions."""

REACH_SHARE: Final = 0.5
"""Goals count as out of reach where more than this share of the distance at the start is left."""


@dataclass(frozen=True)
class Finding:
    """A threshold that is missed."""

    measure: str
    said: str


def findings(rows: Sequence[Row]) -> list[Finding]:
    """The thresholds that the rows of one model miss, worst kinds first; absent figures miss nothing."""
    found = {row.measure: row for row in rows if row.mean is not None}
    missed: list[Finding] = []
    for threshold in THRESHOLDS:
        row = found.get(threshold.measure)
        if row is not None and row.mean is not None and threshold.missed_by(row.mean):
            missed.append(Finding(threshold.measure, f"{threshold.meaning} ({_shown(row, threshold)})"))
    error = found.get("search_error_percent_of_pca")
    if error is not None and error.mean is not None and error.mean < 100.0 <= error.mean + (error.sd or 0.0):
        said = f"not reliably better than PCA ({error.mean:.0f} ± {error.sd:.0f} % of its error)"
        missed.insert(0, Finding("search_error_percent_of_pca", said))
    left, start = found.get("controllability_m"), found.get("start_distance_m")
    if left and start and left.mean is not None and start.mean and left.mean > REACH_SHARE * start.mean:
        said = f"does not reach goals ({1e3 * left.mean:.0f} mm of {1e3 * start.mean:.0f} mm are left)"
        missed.append(Finding("controllability_m", said))
    return missed


def _shown(row: Row, threshold: Threshold) -> str:
    mean = threshold.scale * (row.mean or 0.0)
    spread = "" if row.sd is None else f" ± {threshold.scale * row.sd:.3g}"
    return f"{mean:.3g}{spread}{threshold.unit}"
