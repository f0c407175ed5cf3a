"""Laws of the driver's inputs in the arm's process, whatever the page says."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from pydantic import ValidationError

from latentarm.arms.contract import INPUT_BUDGET_S
from latentarm.control.clock import SimulatedClock
from latentarm.web.arm_process.neutral_interlock import NeutralInterlock
from latentarm.web.arm_process.page_inputs import LATCH_MAX_S, PageInputs
from latentarm.web.protocol.orders import Enable, Given
from latentarm.web.protocol.shared_memory import LatestSlot

TICK_S = 0.01
DEAD_ZONE = 0.05


class Way:
    """From the server to the loop, which stops where it is told to, as the arm does."""

    def __init__(self):
        self.clock = SimulatedClock()
        self.slot = LatestSlot(1024)
        self.stops = []
        self.inputs = PageInputs(self.slot, self.clock, 2, DEAD_ZONE, INPUT_BUDGET_S, self.stops.append)
        self.gate = NeutralInterlock(self.inputs)
        self.sequence = 0
        self.give((0.0, 0.0))
        self.stops.clear()

    def give(self, u, raw=None, source="gamepad", device=0, latched=False, name=""):
        """An input, and what the loop makes of it in the next tick."""
        self.sequence += 1
        told = Given(
            driver=1,
            seq=self.sequence,
            nonce=self.inputs.issue_nonce(),
            u=u,
            raw=raw,
            source=source,
            device=device,
            name=name,
            latched=latched,
        )
        self.slot.write(told.model_dump_json().encode())
        self.clock.wait_until(self.clock.now_s() + TICK_S)
        found, _ = self.gate.latest(self.clock.now_s())
        return found.u


def smoothed(raw, ticks):
    """A push as the page smooths it: it comes nearer for ever."""
    return [tuple(float(x) * (1.0 - 0.97 ** (tick + 1)) for x in raw) for tick in range(ticks)]


@pytest.mark.parametrize("smooth", [False, True])
@pytest.mark.parametrize("source", ["gamepad", "keyboard", "pointer", "dpad", "switch"])
def test_a_push_that_does_not_change_ends_however_the_page_smooths_it(source, smooth):
    way = Way()
    ticks = round((LATCH_MAX_S + 1.0) / TICK_S)
    pushes = smoothed((0.7, 0.0), ticks) if smooth else [(0.7, 0.0)] * ticks
    began_s = way.clock.now_s()
    for u in pushes:
        way.give(u, raw=(0.7, 0.0), source=source)
        if way.stops:
            break
    assert [stop.code for stop in way.stops] == ["latch_ended"]
    assert LATCH_MAX_S - 0.1 < way.clock.now_s() - began_s < LATCH_MAX_S + 0.15


def test_a_push_that_changes_goes_on():
    way = Way()
    for tick in range(round(3 * LATCH_MAX_S / TICK_S)):
        x = 0.7 + 1e-9 * (tick // 500)  # a hand every 5 s
        way.give((0.7, 0.0), raw=(x, 0.0))
    assert way.stops == []


def test_one_that_is_latched_ends_also_where_it_changes():
    way = Way()
    for tick in range(round((LATCH_MAX_S + 0.2) / TICK_S)):
        way.give((0.5, 0.0), raw=(0.5 + 1e-6 * tick, 0.0), latched=True)
    assert [stop.code for stop in way.stops] == ["latch_ended"]


pushes = st.tuples(
    st.sampled_from(["gamepad", "keyboard"]),
    st.integers(0, 1),
    st.sampled_from([(0.0, 0.0), (0.04, 0.0), (0.7, 0.0), (0.0, -1.0)]),
    st.integers(1, 3),
)


@given(st.lists(pushes, max_size=40))
def test_a_device_counts_only_from_neutral_on(drawn):
    """Whatever passes comes from the device that was first deflected since everything was neutral."""
    way = Way()
    owner = None
    spoiled = False
    for source, device, u, times in drawn:
        for _ in range(times):
            passed = way.give(u, source=source, device=device)
            if math.hypot(*u) <= DEAD_ZONE:
                owner, spoiled = None, False
                continue
            spoiled |= owner not in (None, (source, device))
            owner = (source, device)
            assert np.array_equal(passed, (0.0, 0.0) if spoiled else u)


def test_a_dead_gamepad_stops_the_arm_after_ten_seconds(desk):
    """Axes at 0.7 and nobody there; 67 s and 99 cm it was."""

    def tick(now_s):
        if abs(now_s - 0.1) < 0.005:
            desk.order(Enable(driver=1, stops=desk.channel.stop.version))
        desk.give(0.0 if now_s < 0.5 else 0.7, 0.0)

    desk.each_tick = tick
    desk.run(LATCH_MAX_S + 2.0)
    moving = desk.times()[desk.speeds() > 0.0]
    assert moving[-1] - moving[0] < LATCH_MAX_S + 0.15
    assert desk.reports[-1].reason.code == "latch_ended"
    assert desk.reports[-1].phase == "neutral_needed"


def test_the_pushed_device_is_known_by_its_kind_and_name():
    way = Way()
    way.give((0.7, 0.0), source="pointer", name="touch")
    assert way.inputs.held_by == ("pointer", 0, "touch")
    way.give((0.0, 0.0), source="pointer", name="touch")
    assert way.inputs.held_by is None
    with pytest.raises(ValidationError):
        way.give((0.7, 0.0), name="Pad\n; 2")


def test_a_device_that_takes_over_a_push_moves_nothing_until_it_was_let_go(desk):
    def tick(now_s):
        if abs(now_s - 0.1) < 0.005:
            desk.order(Enable(driver=1, stops=desk.channel.stop.version))
        pushed = 0.5 <= now_s < 1.6 or now_s > 1.7
        desk.give(0.7 if pushed else 0.0, 0.0, device=0 if now_s < 1.0 else 1)

    desk.each_tick = tick
    desk.run(2.2)
    times, speeds = desk.times(), desk.speeds()
    assert speeds[(times > 0.8) & (times < 1.0)].min() > 0.0
    assert not speeds[(times > 1.15) & (times < 1.7)].any()
    assert speeds[(times > 2.0) & (times < 2.2)].min() > 0.0
