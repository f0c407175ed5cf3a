"""The queue of those who wait for an arm."""

import time
from collections.abc import Callable, Sequence
from heapq import heapify, heapreplace
from typing import Final, final

GONE_S: Final = 15.0  # somebody who has not asked again for so long has left the queue, s


@final
class Queue:
    """First come, first served.

    Args:
        arms: how many people may drive at the same time.
        now_s: a clock, s.
    """

    def __init__(self, arms: int, now_s: Callable[[], float] = time.monotonic) -> None:
        self._arms = arms
        self._now_s = now_s
        self._waiting: dict[str, tuple[float, float]] = {}  # by key, in order: asked when; drives how long

    def waits_s(self, key: str, limit_s: float, left_s: Sequence[float]) -> float:
        """Ask for an arm for ``limit_s``; how long it takes until there is one, s, or 0 for now.

        ``left_s`` is how long those who drive may still take. They and all who are before this person are
        expected to take all their time.
        """
        now_s = self._now_s()
        self._waiting[key] = now_s, limit_s
        self._waiting = {one: asked for one, asked in self._waiting.items() if now_s - asked[0] < GONE_S}
        before = [limit_s for _, limit_s in self._waiting.values()][: list(self._waiting).index(key)]
        if len(before) + len(left_s) < self._arms:
            del self._waiting[key]
            return 0.0
        free_s = [*left_s, *[0.0] * (self._arms - len(left_s))]
        heapify(free_s)
        for takes_s in before:
            heapreplace(free_s, free_s[0] + takes_s)
        return max(free_s[0], 1.0)
