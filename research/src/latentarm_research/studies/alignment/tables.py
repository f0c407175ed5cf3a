"""The study's tables."""

from collections.abc import Sequence

from latentarm.evaluation.table import format_figure
from latentarm_research.studies.alignment.cell import AlignmentErrors
from latentarm_research.studies.alignment.curves import CurveResult
from latentarm_research.studies.alignment.preset import CONDITIONS
from latentarm_research.studies.alignment.rows import ENCODED
from latentarm_research.studies.tables import grid_table, mean_and_sd

CORNER = "relative error, simulated"


def condition_table(results: Sequence[AlignmentErrors]) -> str:
    """The relative errors of one task: conditions down, noises across."""

    def text(name: str, one: AlignmentErrors) -> str:
        return format_figure(one.encoded, None) if name == ENCODED else mean_and_sd(one.errors[name])

    noises = {f"noise {one.cell.noise:g}": one for one in results}
    return grid_table(CORNER, {name: name for name in (*CONDITIONS, ENCODED)}, noises, text)


def curve_table(curve: CurveResult) -> str:
    """One task and noise: numbers of answers down, choices of questions across."""

    def text(count: int, choice: str) -> str | None:
        return mean_and_sd(curve.errors[choice][count]) if count in curve.errors[choice] else None

    counts = sorted({count for errors in curve.errors.values() for count in errors})
    return grid_table(
        "answers", {str(count): count for count in counts}, {name: name for name in curve.errors}, text
    )
