"""An enabled arm is disabled when nobody gives an input for a while, and pages know beforehand."""

from dataclasses import replace
from itertools import pairwise

import pytest

from latentarm.core.errors import UserError
from latentarm.web.arm_process.idle_limit import SAID_S, IdleLimit, idle_s_of
from latentarm.web.protocol.orders import ChooseMode, Enable

LIMIT_S = 2.0
ENABLED_S = 0.1


@pytest.fixture
def desk(setup, desk_of):
    """A drive whose host has set 2 s."""
    with desk_of(replace(setup, spec=replace(setup.spec, idle_s=LIMIT_S))) as desk:
        yield desk


def driven(desk, for_s, acts=lambda now_s: None):
    """Enable the arm and keep sending a stick at rest, as pages do, but for what ``acts`` gives."""

    def tick(now_s):
        if abs(now_s - ENABLED_S) < 0.005:
            desk.order(Enable(driver=1, stops=desk.channel.stop.version))
        if not acts(now_s):
            desk.give(0.0, 0.0)

    desk.each_tick = tick
    desk.run(for_s)
    return desk.reports


def disabled_at(reports):
    """When the arm was first enabled no more, s; None for never."""
    seen = [(one.time_s, one.phase in ("ready", "moving")) for one in reports]
    ends = (now[0] for before, now in pairwise(seen) if before[1] and not now[1])
    return next(ends, None)


def test_an_arm_that_nobody_drives_is_disabled_and_it_is_said_before_and_after(desk):
    reports = driven(desk, LIMIT_S + 0.5)
    assert disabled_at(reports) == pytest.approx(LIMIT_S + ENABLED_S, abs=0.1)
    assert reports[-1].reason.code == "idle"
    assert "2 s" in reports[-1].reason.text
    told = [one.idle_left_s for one in reports if one.idle_left_s is not None]
    assert [*dict.fromkeys(told)] == [2, 1]
    assert reports[-1].idle_left_s is None


@pytest.mark.parametrize("act", ["push", "gripper", "mode"])
def test_whatever_a_person_does_begins_the_time_again(desk, act):
    at_s = LIMIT_S - 0.5

    def acts(now_s):
        if abs(now_s - at_s) > 0.005:
            return False
        if act == "mode":
            desk.order(ChooseMode(mode="end_effector", axes=1))
            return False
        desk.give(
            *((0.5, 0.0) if act == "push" else (0.0, 0.0)), gripper="close" if act == "gripper" else None
        )
        return True

    reports = driven(desk, LIMIT_S + at_s + 0.5, acts)
    assert disabled_at(reports) == pytest.approx(LIMIT_S + at_s, abs=0.2)


def test_an_arm_that_is_pushed_now_and_then_stays_enabled(desk):
    def acts(now_s):
        pushed = now_s % 1.5 > 1.3
        if pushed:
            desk.give(0.3, 0.0)
        return pushed

    reports = driven(desk, 3.0 * LIMIT_S + 0.1, acts)
    assert disabled_at([one for one in reports if one.time_s < 3.0 * LIMIT_S]) is None


def test_a_disabled_arm_is_not_stopped_for_it(desk):
    desk.each_tick = lambda now_s: desk.give(0.0, 0.0)
    desk.run(LIMIT_S + 0.5)
    assert {one.reason.code for one in desk.reports} == {"not_enabled"}


def test_it_is_said_in_the_last_fifteen_seconds():
    stops = []
    idle = IdleLimit(120.0, stops.append)
    said = {}
    for tick in range(1, 12_100):
        idle.look(0.01 * tick, used=tick == 1)
        said.setdefault(idle.left_s, 0.01 * tick)
    assert said[round(SAID_S)] == pytest.approx(120.0 - SAID_S, abs=0.1)
    assert said[1] == pytest.approx(119.0, abs=0.1)
    assert [stop.code for stop in stops] == ["idle"]


@pytest.mark.parametrize("minutes", [0.0, -1.0, 61.0, float("nan")])
def test_a_time_that_disables_at_once_or_never_is_refused(minutes):
    with pytest.raises(UserError, match="--idle-minutes"):
        idle_s_of(minutes)
