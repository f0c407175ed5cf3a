"""Slots: a reader gets a whole message or none, whatever the writer is doing."""

import multiprocessing
import threading

import pytest
from hypothesis import given
from hypothesis import strategies as st

from latentarm.web.protocol.shared_memory import Flag, LatestSlot


@given(st.lists(st.binary(max_size=64), min_size=1))
def test_the_newest_message_is_read(messages):
    slot = LatestSlot(64)
    assert slot.read() is None
    for number, message in enumerate(messages, start=1):
        slot.write(message)
        assert slot.read() == (2 * number, message)
    assert slot.version == 2 * len(messages)


def test_a_message_that_is_too_long_is_refused_and_changes_nothing():
    slot = LatestSlot(4)
    slot.write(b"abcd")
    with pytest.raises(ValueError, match="too long"):
        slot.write(b"abcde")
    assert slot.read() == (2, b"abcd")


@given(st.binary(min_size=1, max_size=64), st.data())
def test_a_message_that_was_half_written_is_never_read(message, data):
    slot = LatestSlot(64)
    slot.write(message)
    memory = memoryview(slot._memory).cast("B")
    at = data.draw(st.integers(16, 15 + len(message)))
    memory[at] ^= data.draw(st.integers(1, 255))
    assert slot.read() is None
    memory[0] |= 1
    assert slot.read() is None


def scribble(slot, stop):
    number = 0
    while not stop.count:
        number += 1
        slot.write(bytes([number % 256]) * (1 + number % 200))


def test_no_message_is_torn_while_another_process_writes_as_fast_as_it_can():
    slot, stop = LatestSlot(200), Flag()
    writer = multiprocessing.get_context("spawn").Process(target=scribble, args=(slot, stop), daemon=True)
    writer.start()
    try:
        seen = set()
        whole = 0
        while whole < 5000 or len(seen) < 50:
            found = slot.read()
            if found is None:
                continue
            version, message = found
            assert version % 2 == 0
            assert set(message) == {(version // 2) % 256}
            assert len(message) == 1 + (version // 2) % 200
            seen.add(version)
            whole += 1
    finally:
        stop.raise_()
        writer.join(10)
        assert writer.exitcode == 0


def test_many_readers_may_read():
    slot = LatestSlot(8)
    slot.write(b"same")
    found = []
    threads = [threading.Thread(target=lambda: found.append(slot.read())) for _ in range(8)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert found == [(2, b"same")] * 8
