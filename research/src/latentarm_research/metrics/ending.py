"""Why a simulated drive ended, from its record."""

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final, Literal

import numpy as np

from latentarm.core.types import Pose, StepRecord
from latentarm.robots.kinematics.chain import Chain
from latentarm.robots.kinematics.rotations import angle_between

Reason = Literal["done", "mishap", "time_limit", "operator_stuck", "held_back", "safety_stop", "record_full"]

STUCK_S: Final = 20.0  # no progress for this long counts as stuck, s; a shorter drive never counts as stuck
NOT_NEARER: Final = f"no nearer for {STUCK_S:g} s"

PROGRESS_M: Final = 0.005  # coming this much nearer to the next waypoint than ever before is progress, m
RADIAN_M: Final = 0.2  # what a radian of wrong orientation counts, m, as for the simulated operator

HELD_BACK_SHARE: Final = 0.1
"""Less motion than this share of what the inputs asked for means that the safety filters hold the arm."""


@dataclass(frozen=True)
class Ending:
    """Why a drive ended."""

    reason: Reason  # the code
    detail: str  # the same in words, without a full stop


def why_it_timed_out(
    records: Sequence[StepRecord],  # every step in order
    chain: Chain,
    waypoint: Pose,  # the waypoint that was not reached
    since_s: float,  # when that waypoint became the next one, on the records' clock, s
) -> Ending:
    """Why a drive was not done within its time."""
    stop = records[-1].command.stop
    if stop is not None:
        return Ending("safety_stop", f"stopped by safety: {stop.reason.rstrip('.')}")
    now_s = records[-1].time_s
    if now_s - since_s < STUCK_S or _progressed(records, chain, waypoint, since_s):
        return Ending("time_limit", "out of time")
    lately = [record for record in records if record.time_s >= now_s - STUCK_S]
    # Help moves the arm too, so the requested motion is that of both.
    wanted = sum(
        float(
            np.linalg.norm((1 - one.alpha) * one.action_human + (one.alpha + one.added) * one.action_assist)
        )
        for one in lately
        if one.input.any()
    )
    given = sum(float(np.linalg.norm(one.command.velocity)) for one in lately)
    if wanted and given < HELD_BACK_SHARE * wanted:
        filters = Counter(name for one in lately for name in one.command.limited_by)
        named = ", ".join(name for name, _ in filters.most_common(2)) or "the verified stop"
        return Ending("held_back", f"held back by the safety filters ({named})")
    return Ending("operator_stuck", NOT_NEARER)


def _progressed(records: Sequence[StepRecord], chain: Chain, waypoint: Pose, since_s: float) -> bool:
    """Whether the tool came nearer in the last `STUCK_S` than it had been before."""
    time_s = np.array([record.time_s for record in records])
    here = time_s >= since_s
    pose = chain.forward(np.stack([record.state for record in records])[here])
    away = np.hypot(
        np.linalg.norm(pose.position - waypoint.position, axis=-1),
        RADIAN_M * angle_between(pose.rotation, waypoint.rotation),
    )
    late = time_s[here] >= time_s[-1] - STUCK_S
    return bool(away[late].min() < away[~late].min(initial=away[late][0]) - PROGRESS_M)
