"""Everything that the study measured, as its series, and how long an alignment takes."""

import timeit
from collections.abc import Sequence
from dataclasses import dataclass
from time import perf_counter
from typing import Final

import numpy as np
from threadpoolctl import threadpool_limits

from latentarm_research.studies.alignment.cell import AlignmentErrors
from latentarm_research.studies.alignment.curves import CurveResult
from latentarm_research.studies.alignment.preset import CONDITIONS, PAPER_MODEL, Stream, under
from latentarm_research.studies.alignment.scene import LearnedDecoder, scene_of
from latentarm_research.studies.tables import Series

STUDY: Final = "alignment"

ERROR: Final = "relative_alignment_error"

ENCODED: Final = "the encoder's own choice"
"""Condition of the rows that say what the encoder's own latent actions come to."""

CALLS: Final = 200  # calls of an alignment that are timed; the fastest counts


@dataclass(frozen=True, eq=False)
class AlignmentResults:
    """All results, in the order of the tables."""

    decoders: Sequence[LearnedDecoder]  # that the alignments stand on
    results: Sequence[AlignmentErrors]  # the cells of the table, by task and noise
    curves: Sequence[CurveResult]  # by noise and task


def series_of(measured: AlignmentResults) -> list[Series]:
    """The errors of every run: the tables, then the curves."""
    found: list[Series] = []
    for task in dict.fromkeys(one.cell.task for one in measured.results):
        here = [one for one in measured.results if one.cell.task == task]
        found.append(Series(task, PAPER_MODEL, ENCODED, ERROR, np.array([here[0].encoded])))
        found += [
            Series(task, PAPER_MODEL, under(name, one.cell.noise), ERROR, one.errors[name])
            for one in here
            for name in CONDITIONS
        ]
    for one in measured.curves:
        cell = one.cell
        found += [
            Series(cell.task, PAPER_MODEL, under(_asked(choice, count), cell.noise), ERROR, values)
            for choice, errors in one.errors.items()
            for count, values in errors.items()
        ]
    return found


def _asked(choice: str, count: int) -> str:
    """How rows name a point of a curve."""
    return f"{choice}, {count} answer{'s' * (count != 1)}"


def time_alignment(learned: LearnedDecoder) -> dict[str, object]:
    """Times to learn an alignment in tool space and to call it, s; one thread."""
    preset, scene = learned.cell.preset, scene_of(learned)
    answers = scene.ask(preset.answers, 0.0, Stream.QUESTIONS, Stream.ANSWERS, 0)
    with threadpool_limits(limits=1):
        began = perf_counter()
        alignment = scene.in_tool_space(answers)
        tool_space_s = perf_counter() - began
        u, context = scene.test.u[0], scene.test.motions.context[0]
        calls = timeit.repeat(lambda: alignment(u, context), number=1, repeat=CALLS)
    return {
        "task": learned.cell.task,
        "answers": preset.answers,
        "tool_space_s": tool_space_s,
        "tool_space_call_s": min(calls),
    }
