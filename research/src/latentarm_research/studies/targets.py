"""What a study is to show: met or missed, with the figures that decide it."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import final

from latentarm_research.studies.tables import markdown_table


@final
@dataclass(frozen=True)
class Target:
    """One target and whether it was met."""

    name: str  # what is asked for
    met: bool  # whether it was reached
    figures: str  # that decide it
    where: tuple[str, ...] = ()  # what it is asked of, such as an arm and a model, as tables call them


def target_table(found: Sequence[Target], where: Sequence[str] = ()) -> str:
    """All targets in Markdown; ``where`` heads the columns of `Target.where`."""
    lines = [[one.name, *one.where, "met" if one.met else "**missed**", one.figures] for one in found]
    return markdown_table(["target", *where, "", "figures"], lines)
