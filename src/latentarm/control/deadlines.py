"""How well a loop met its deadlines."""

from dataclasses import dataclass
from typing import final

import numpy as np


@final
@dataclass(frozen=True)
class DeadlineStatistics:
    """Figures over the ticks of one run.

    Attributes:
        ticks: how many.
        met_share: share of ticks that were done before the next one was due.
        median_s: median time from a tick's due time until its command was sent, s.
        p99_s: 99th percentile of the same, s.
        worst_start_s: the latest that any tick began after it was due, s.
        overruns: ticks that began so late that the last command had run out.
    """

    ticks: int
    met_share: float
    median_s: float
    p99_s: float
    worst_start_s: float
    overruns: int


@final
class DeadlineLog:
    """Collects how late ticks were, in bounded memory.

    Args:
        period_s: the loop's period, s.
        window: figures are over the last so many ticks (counts are over all).
    """

    def __init__(self, period_s: float, window: int = 65536) -> None:
        self._period_s = period_s
        self._sent = np.zeros(window)
        self._ticks = 0
        self._met = 0
        self._worst_start_s = 0.0
        self._overruns = 0

    @property
    def ticks(self) -> int:
        """How many ticks there were."""
        return self._ticks

    def add(self, started_s: float, sent_s: float, *, overrun: bool) -> None:
        """Record one tick.

        Args:
            started_s: when it began, after it was due, s.
            sent_s: when its command had been sent, after it was due, s.
            overrun: whether the command before had run out.
        """
        self._sent[self._ticks % len(self._sent)] = sent_s
        self._ticks += 1
        self._met += sent_s <= self._period_s
        self._worst_start_s = max(self._worst_start_s, started_s)
        self._overruns += overrun

    def statistics(self) -> DeadlineStatistics:
        """The figures so far; all zero, and all deadlines met, before the first tick."""
        kept = self._sent[: min(self._ticks, len(self._sent))]
        median, p99 = np.percentile(kept, [50, 99]) if len(kept) else (0.0, 0.0)
        return DeadlineStatistics(
            ticks=self._ticks,
            met_share=self._met / self._ticks if self._ticks else 1.0,
            median_s=float(median),
            p99_s=float(p99),
            worst_start_s=self._worst_start_s,
            overruns=self._overruns,
        )
