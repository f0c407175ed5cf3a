"""What people and devices truly do at the inputs, and which motion of the arm that explains."""

import math
from collections import Counter
from dataclasses import dataclass, field
from itertools import pairwise

import numpy as np

CAP_S = 10.0
"""How long a push counts that does not change, or that is latched."""

GRACE_S = 0.9
"""A page may be so late that the arm nearly stops; then it comes to rest, and a watcher hears of it."""

EARLY_S = 0.25
"""The arm is enabled for so long before a watcher hears of it."""

STILL_M = 1e-4
"""Between two states, m; below it the arm settles."""


@dataclass
class Push:
    """A deflection of one source, from neutral on.

    `counts` is whether the source was seen neutral before: not where it appeared like this.
    """

    source: str
    began_s: float
    counts: bool = True
    latched: bool = False
    changes: list[float] = field(default_factory=list)
    ended_s: float = math.inf

    def explains(self, now_s: float, enabled_s: float) -> bool:
        """Whether the arm may move now for it."""
        if not self.counts or self.began_s < enabled_s - EARLY_S:
            return False
        if not self.began_s <= now_s <= self.ended_s + GRACE_S:
            return False
        changed_s = max([self.began_s, *(at_s for at_s in self.changes if at_s <= now_s)])
        return now_s <= changed_s + CAP_S + GRACE_S


@dataclass
class Sample:
    """What the arm's process has said.

    It was true at `at_s`, by the ticks of its loop, or later, if the loop was late; at `heard_s` at last.
    """

    at_s: float
    heard_s: float
    enabled: bool
    excused: bool
    tool: np.ndarray


@dataclass
class World:
    """Every push that there was."""

    pushes: list[Push] = field(default_factory=list)

    def now(self, source: str) -> Push | None:
        """The push of a source that goes on."""
        found = (one for one in reversed(self.pushes) if one.source == source)
        return next((one for one in found if one.ended_s == math.inf), None)

    def begin(self, source: str, at_s: float, counts: bool = True, latched: bool = False) -> None:
        """A source is deflected; one that is already has changed."""
        going = self.now(source)
        if going is None:
            self.pushes.append(Push(source, at_s, counts, latched))
        elif not latched:
            going.changes.append(at_s)

    def end(self, source: str, at_s: float) -> None:
        """A source is at rest."""
        if (going := self.now(source)) is not None:
            going.ended_s = at_s

    def end_latched(self, at_s: float) -> None:
        """Any press ends what goes on by itself."""
        for one in self.pushes:
            if one.latched and one.ended_s == math.inf:
                one.ended_s = at_s

    def unexplained(self, samples: list[Sample]) -> list[tuple[float, float]]:
        """When the arm moved without anybody's asking, s, and how far, m."""
        found, enabled_s, enabled = [], math.inf, False
        for before, sample in pairwise(samples):
            if sample.enabled and not enabled:
                enabled_s = sample.at_s
            enabled = sample.enabled
            moved = float(np.linalg.norm(sample.tool - before.tool))
            if moved <= STILL_M or sample.excused or before.excused:
                continue
            times = (sample.at_s, sample.heard_s)
            near = (
                one for one in self.pushes if one.began_s <= times[1] and times[0] <= one.ended_s + GRACE_S
            )
            if not any(one.explains(now_s, enabled_s) for one in near for now_s in times):
                found.append((sample.at_s, moved))
        return found

    def kinds(self, samples: list[Sample]) -> Counter[str]:
        """For how many samples of motion each kind of source was deflected."""
        found: Counter[str] = Counter()
        for before, sample in pairwise(samples):
            if np.linalg.norm(sample.tool - before.tool) > STILL_M:
                found.update(
                    {o.source.split()[0] for o in self.pushes if o.began_s <= sample.at_s <= o.ended_s}
                )
        return found
