"""Whatever people, devices and the browser do at the inputs: the arm moves for what somebody does now."""

import pytest

from input_walk import report, walking

EVENTS = 250


@pytest.mark.parametrize("seed", [1, 2])
def test_the_arm_moves_only_for_a_fresh_push_that_began_at_rest_and_changes(chromium, address, seed):
    """20,000 events are a command: `tests/input_walk.py` says which."""
    context = chromium.new_context(viewport={"width": 1100, "height": 720})
    events = []
    try:
        with walking(context.new_page(), address, seed, events.append) as walk:
            walk.go(EVENTS)
            words, faults = report(walk)
    finally:
        context.close()
    assert faults == 0, "\n".join([words, *events])
    # It was about something.
    assert len(walk.world.kinds(walk.watcher.samples)) >= 2, words
