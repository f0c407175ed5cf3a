import math
import threading

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from latentarm.control.clock import Clock, MonotonicClock, SimulatedClock
from latentarm.control.input_port import InputPort
from latentarm.core.types import Input


def push(value, *, switch_mode=False):
    return Input(np.array([value, 0.0]), switch_mode)


def port_and_clock():
    clock = SimulatedClock()
    return InputPort(2, clock), clock


def test_without_any_input_there_is_only_an_infinitely_old_zero():
    port, _ = port_and_clock()
    given, age = port.latest(0.0)
    assert not given.u.any()
    assert age == math.inf


def test_the_latest_input_wins_and_ages():
    port, clock = port_and_clock()
    nonce = port.issue_nonce()
    assert port.offer(push(0.1), nonce, 1)
    assert port.offer(push(0.2), nonce, 2)
    clock.wait_until(0.03)
    given, age = port.latest(clock.now_s())
    assert given.u[0] == 0.2
    assert abs(age - 0.03) < 1e-12


def test_age_counts_from_when_an_input_came_not_from_its_nonce():
    port, clock = port_and_clock()
    nonce = port.issue_nonce()
    clock.wait_until(0.05)
    assert port.offer(push(0.1), nonce, 1)
    clock.wait_until(0.06)
    assert port.latest(clock.now_s())[1] == pytest.approx(0.01)
    assert port.nonce_age_s(nonce) == pytest.approx(0.06)


def test_the_opening_button_is_seen_as_long_as_it_is_held():
    port, _ = port_and_clock()
    nonce = port.issue_nonce()
    seen = []
    for number, opens in enumerate([False, True, True, False]):
        port.offer(Input(np.zeros(2), opens=opens), nonce, number)
        seen += [port.latest(0.0)[0].opens for _ in range(2)]
    assert seen == [False, False, True, True, True, True, False, False]


def test_among_many_nonces_the_newest_counts():
    port, _ = port_and_clock()
    nonces = [port.issue_nonce() for _ in range(3000)]
    assert port.offer(push(0.1), nonces[-1], 1)
    assert not port.offer(push(0.1), nonces[0], 2)


def test_nothing_from_before_the_clock_went_back_counts():
    class Back(Clock):
        time_s = 50.0

        def now_s(self):
            return self.time_s

        def wait_until(self, time_s):
            self.time_s = time_s

    clock = Back()
    port = InputPort(2, clock)
    old = port.issue_nonce()
    assert port.offer(push(0.1), old, 1)
    clock.time_s = 10.0
    assert port.latest(10.0)[1] == math.inf
    assert not port.offer(push(0.2), old, 2)
    assert port.offer(push(0.3), port.issue_nonce(), 3)
    assert port.latest(10.0)[1] == 0.0


def test_sequence_numbers_must_grow():
    port, _ = port_and_clock()
    nonce = port.issue_nonce()
    assert port.offer(push(0.1), nonce, 5)
    assert not port.offer(push(0.9), nonce, 5)
    assert not port.offer(push(0.9), nonce, 4)
    assert port.latest(0.0)[0].u[0] == 0.1


def test_an_old_or_foreign_nonce_is_stale():
    port, clock = port_and_clock()
    nonce = port.issue_nonce()
    clock.wait_until(0.201)
    assert not port.offer(push(0.1), nonce, 1)
    assert not port.offer(push(0.1), "made up", 2)
    assert port.offer(push(0.1), port.issue_nonce(), 3)


def test_an_input_does_not_outlive_its_nonce():
    port, clock = port_and_clock()
    nonce = port.issue_nonce()
    clock.wait_until(0.19)
    assert port.offer(push(0.1), nonce, 1)
    clock.wait_until(0.21)
    assert port.latest(clock.now_s())[1] == math.inf


def test_a_press_of_the_switch_survives_a_later_input_once():
    port, _ = port_and_clock()
    nonce = port.issue_nonce()
    port.offer(push(0.0, switch_mode=True), nonce, 1)
    port.offer(push(0.3), nonce, 2)
    assert port.latest(0.0)[0].switch_mode
    assert not port.latest(0.0)[0].switch_mode


def test_what_is_asked_of_the_gripper_survives_later_inputs_once_and_the_newest_counts():
    port, _ = port_and_clock()
    nonce = port.issue_nonce()
    for number, asked in enumerate(["close", "open", None, None]):
        port.offer(Input(np.zeros(2), gripper=asked), nonce, number)
    assert [port.latest(0.0)[0].gripper for _ in range(3)] == ["open", None, None]
    # Held, it is seen as held: what it is pressed for counts it once.
    port.offer(Input(np.zeros(2), gripper="toggle"), nonce, 9)
    assert [port.latest(0.0)[0].gripper for _ in range(2)] == ["toggle", "toggle"]


def test_the_sender_cannot_change_an_input_afterwards():
    port, _ = port_and_clock()
    u = np.zeros(2)
    port.offer(Input(u), port.issue_nonce(), 1)
    u[:] = 9.0
    assert not port.latest(0.0)[0].u.any()


@given(st.lists(st.tuples(st.floats(0.0, 0.3), st.integers(-5, 20), st.integers(0, 5)), max_size=30))
def test_whatever_arrives_the_sequence_grows_and_the_age_is_right(events):
    port, clock = port_and_clock()
    nonces, best, taken_at = [(port.issue_nonce(), 0.0)], -1, None
    for wait, sequence, back in events:
        clock.wait_until(clock.now_s() + wait)
        nonces.append((port.issue_nonce(), clock.now_s()))
        nonce, issued = nonces[max(len(nonces) - 1 - back, 0)]
        taken = port.offer(push(0.5), nonce, sequence)
        fresh = clock.now_s() - issued <= 0.2 and sequence > best
        assert taken == fresh
        if taken:
            best, taken_at = sequence, clock.now_s()
        if taken_at is None:
            assert port.latest(clock.now_s())[1] == math.inf


def test_threads_never_see_half_an_input():
    port = InputPort(2, MonotonicClock())
    done = threading.Event()

    def send():
        for sequence in range(3000):
            value = float(sequence % 2)
            port.offer(Input(np.array([value, value])), port.issue_nonce(), sequence)
        done.set()

    thread = threading.Thread(target=send)
    thread.start()
    while not done.is_set():
        given, age = port.latest(0.0)
        assert given.u[0] == given.u[1]
        assert age >= 0.0
    thread.join()
