"""When pages are told of the arm."""

import asyncio
import time

import pytest

from latentarm.web.protocol.report import Report
from latentarm.web.server.connected_pages import ConnectedPages
from latentarm.web.server.states import States

LONG_S = 0.4


class AnyRun:
    def shows(self, report):
        return True


class Control:
    """A control process that says where the tool is, once for each look."""

    alive = True

    def __init__(self, heights):
        self.heights = list(heights)

    def newest(self):
        return report(self.heights.pop(0)) if self.heights else None


def report(height):
    known = dict.fromkeys(Report.model_fields)
    return Report.model_construct(**{**known, "tool": (0.3, 0.0, height), "loading": False})


@pytest.mark.parametrize(
    ("heights", "at_once"),
    [([0.5] * 9, False), ([0.5] * 5 + [0.5 + 1e-9] * 4, False), ([0.5] * 5 + [0.501, 0.502], True)],
)
def test_a_pause_ends_as_soon_as_the_arm_sets_off(heights, at_once):
    async def paused_s():
        states = States(AnyRun(), Control(heights), ConnectedPages(), None)
        following = asyncio.create_task(states.follow())
        began_s = time.monotonic()
        await states.pause(LONG_S)
        following.cancel()
        return time.monotonic() - began_s

    assert (asyncio.run(paused_s()) < LONG_S) == at_once
