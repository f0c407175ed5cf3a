"""Arms of which a page hears late, in simulated time: simulated ones are driven, real ones are not."""

from collections import deque
from dataclasses import replace

import numpy as np
import pytest

from latentarm.arms.catalogue import make_arm
from latentarm.arms.contract import INPUT_BUDGET_S, SIMULATED_INPUT_BUDGET_S
from latentarm.web.arm_process.drive_setup import PERIOD_S
from latentarm.web.protocol.notice import Notice
from latentarm.web.protocol.orders import Enable, PoseToGoTo, Return

STILL_WITHIN_S = 0.15
TICK_S = PERIOD_S + 1e-6


def as_hardware(*given):
    """An arm that allows no more than a real one."""
    arm = make_arm(*given)
    arm._spec = replace(arm.spec, input_budget_s=INPUT_BUDGET_S)
    return arm


@pytest.fixture
def hardware_desk(desk_of, setup):
    with desk_of(setup, make=as_hardware) as desk:
        yield desk


class FarPage:
    """Sends 50 inputs per second, over a line that keeps their order.

    ``delay_s`` gives the delay of a message one way, s. The person lets go of the stick at first, has pressed
    Enable at 0.2 s, pushes by ``push`` from 1.2 s on, and is cut off at ``cut_s``.
    """

    def __init__(self, desk, delay_s, cut_s=np.inf, push=1.0):
        self.desk, self.delay_s, self.cut_s, self.push = desk, delay_s, cut_s, push
        self.down, self.up = deque(), deque()  # when it arrives, and what
        self.seen = ""
        self.ticks = self.taken = 0
        desk.each_tick = self.tick

    def tick(self, now_s):
        desk = self.desk
        for report in desk.reports[self.taken :]:
            self.send(self.down, now_s, report.nonce)
        self.taken = len(desk.reports)
        for nonce in self.arrived(self.down, now_s):
            self.seen = nonce
        self.ticks += 1
        if abs(now_s - 0.2) < 0.5 * PERIOD_S:
            self.send(self.up, now_s, None)
        elif self.ticks % 2 == 0 and now_s > 0.14 and now_s < self.cut_s:
            self.send(self.up, now_s, (self.seen or "0" * 32, self.push if now_s > 1.2 else 0.0))
        for what in self.arrived(self.up, now_s):
            if what is None:
                desk.order(Enable(driver=1, stops=desk.channel.stop.version))
            else:
                desk.give(what[1], 0.0, nonce=what[0])

    def send(self, way, now_s, what):
        way.append((max(now_s + self.delay_s(), way[-1][0] if way else 0.0), what))

    @staticmethod
    def arrived(way, now_s):
        while way and way[0][0] <= now_s + 1e-9:
            yield way.popleft()[1]


END_S = 3.9  # the loop brings the arm to rest before 4 s


def moves(desk, from_s, until_s=END_S):
    """(T,), whether the arm was commanded to move, in this time."""
    return desk.speeds()[(desk.times() > from_s) & (desk.times() < until_s)] > 0.0


def enabled(desk):
    return np.array([report.phase in ("ready", "moving") for report in desk.reports])


@pytest.mark.parametrize("round_trip_s", [0.0, 0.2, 0.3, 0.5])
def test_a_simulated_arm_is_driven_from_far_away(desk, round_trip_s):
    FarPage(desk, lambda: 0.5 * round_trip_s)
    desk.run(4.0)
    assert moves(desk, 1.3 + round_trip_s).all()
    delay_s = np.array([record.delay_s for record in desk.records])[desk.times() > 1.3]
    assert round_trip_s <= delay_s.min()
    assert delay_s.max() <= round_trip_s + 5 * PERIOD_S


@pytest.mark.parametrize("seed", range(5))
def test_a_simulated_arm_is_driven_over_300_ms_with_jitter(desk, seed):
    rng = np.random.default_rng(seed)
    FarPage(desk, lambda: rng.uniform(0.1, 0.2))
    desk.run(4.0)
    assert moves(desk, 1.6).mean() > 0.8


def test_hardware_is_not_driven_from_far_away(hardware_desk):
    FarPage(hardware_desk, lambda: 0.1)
    hardware_desk.run(4.0)
    assert not enabled(hardware_desk).any()
    assert not hardware_desk.speeds().any()


@pytest.mark.parametrize("round_trip_s", [0.0, 0.2, 0.4])
@pytest.mark.parametrize("by_itself", [False, True])
def test_a_page_that_is_cut_off_stops_a_simulated_arm(desk, round_trip_s, by_itself):
    page = FarPage(desk, lambda: 0.5 * round_trip_s, cut_s=2.0, push=float(not by_itself))
    away = PoseToGoTo(name="away", q=tuple((desk.setup.start + 0.3).tolist()))

    def tick(now_s):
        page.tick(now_s)
        if by_itself and abs(now_s - 1.4) < 0.5 * PERIOD_S:
            desk.order(Return(on=True, pose=away))

    desk.each_tick = tick
    desk.run(4.0)
    last_s = 2.0 + 0.5 * round_trip_s  # when the last input came
    assert moves(desk, 1.8, 2.0).all()
    assert desk.times()[desk.speeds() > 0.0][-1] < last_s + STILL_WITHIN_S
    # The last input answers a state of one way before it was sent.
    until_s = desk.reports[np.flatnonzero(enabled(desk))[-1]].time_s
    assert until_s <= 2.0 - 0.5 * round_trip_s + SIMULATED_INPUT_BUDGET_S + TICK_S
    assert desk.reports[-1].reason.code == "input_late"


@pytest.mark.parametrize("gap_s", [0.1, 0.3, 0.5])
def test_inputs_that_come_back_in_time_move_a_simulated_arm_again(desk, gap_s):
    gone = (2.0, 2.0 + gap_s)
    page = FarPage(desk, lambda: 0.0)
    send = page.send
    page.send = lambda way, now_s, what: None if gone[0] < now_s < gone[1] else send(way, now_s, what)
    desk.run(4.0)
    assert not moves(desk, gone[0] + STILL_WITHIN_S, gone[1]).any()
    assert moves(desk, gone[1] + 0.2).all()


def test_inputs_that_come_back_do_not_move_hardware_that_was_stopped(hardware_desk):
    page = FarPage(hardware_desk, lambda: 0.0)
    send = page.send
    page.send = lambda way, now_s, what: None if 2.0 < now_s < 2.15 else send(way, now_s, what)
    hardware_desk.run(4.0)
    assert moves(hardware_desk, 1.5, 2.0).all()
    assert not moves(hardware_desk, 2.15).any()


@pytest.mark.parametrize("round_trip_s", [0.0, 0.4])
def test_stop_counts_at_once_however_far_away_the_page_is(desk, round_trip_s):
    page = FarPage(desk, lambda: 0.5 * round_trip_s)
    drive = page.tick

    def tick(now_s):
        drive(now_s)
        if abs(now_s - 2.0) < 0.5 * PERIOD_S:
            desk.channel.stop.write(Notice(code="stop_pressed").model_dump_json().encode())

    desk.each_tick = tick
    desk.run(4.0)
    assert moves(desk, 1.8, 2.0).all()
    assert not moves(desk, 2.0 + STILL_WITHIN_S).any()
    assert not enabled(desk)[[report.time_s > 2.0 + TICK_S for report in desk.reports]].any()
