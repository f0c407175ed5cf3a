"""A second person may slow or stop the arm, with the driver's consent, and never speed it up."""

import numpy as np
import pytest

from latentarm.web.arm_process.page_inputs import COPILOT_TIMEOUT_S
from latentarm.web.protocol.orders import Enable, Paced
from latentarm.web.server.connected_pages import ConnectedPages


def driven(desk, pace, until_s=2.5, begin_s=0.0, end_s=np.inf, heard_until_s=np.inf):
    """Push from 0.5 s on, with a co-pilot whose pace depends on the time, s."""
    heard = {"nonce": "", "pace": 1.0}

    def tick(now_s):
        if now_s < heard_until_s and desk.reports:
            heard.update(nonce=desk.reports[-1].nonce, pace=pace(now_s))
        paced = Paced(copilot=1, **heard) if begin_s <= now_s < end_s else None
        desk.give(0.0 if now_s < 0.5 else 1.0, 0.0, paced=paced)
        if abs(now_s - 0.1) < 0.005:
            desk.order(Enable(driver=1, stops=desk.channel.stop.version))

    desk.each_tick = tick
    desk.run(until_s)
    return desk.times(), desk.speeds()


def steady(desk, times, speeds, at_s):
    return speeds[np.abs(times - at_s) < 0.02].mean()


def test_the_arm_moves_at_the_share_that_the_copilot_leaves(desk):
    times, speeds = driven(desk, lambda now_s: 1.0 if now_s < 1.5 else 0.5)
    assert steady(desk, times, speeds, 2.4) == pytest.approx(0.5 * steady(desk, times, speeds, 1.45), rel=0.1)


def test_a_copilot_stops_the_arm_and_lets_it_go_on_while_the_driver_pushes(desk):
    times, speeds = driven(desk, lambda now_s: 0.0 if 1.0 < now_s < 1.8 else 1.0)
    assert not speeds[(times > 1.3) & (times < 1.8)].any()
    assert steady(desk, times, speeds, 2.4) > 0.05
    assert all(report.phase != "disengaged" for report in desk.reports if 0.5 < report.time_s < 2.4)


@pytest.mark.parametrize("pace", [0.0, 0.3, 0.8, 1.0])
def test_no_copilot_makes_the_arm_faster(desk, pace):
    _, speeds = driven(desk, lambda now_s: pace)
    commands = np.array([record.command.velocity for record in desk.records])
    wanted = np.array([record.action_human for record in desk.records])
    assert np.abs(commands).max() <= pace * np.abs(wanted).max() + 1e-9
    assert speeds.max() <= pace * np.abs(wanted).max() + 1e-9


def test_a_copilot_who_is_not_heard_of_stops_the_arm(desk):
    times, speeds = driven(desk, lambda now_s: 0.6, heard_until_s=1.2)
    moving = times[speeds > 0.0]
    assert 1.2 + COPILOT_TIMEOUT_S - 0.05 < moving[-1] < 1.2 + COPILOT_TIMEOUT_S + 0.2
    assert desk.reports[-1].reason.code == "copilot_late"
    # Not even until then is it faster than the last that was said.
    before = steady(desk, times, speeds, 1.15)
    assert speeds[times > 1.2].max() <= 1.05 * before


def test_nothing_moves_before_the_copilot_is_heard_of(desk):
    _, speeds = driven(desk, lambda now_s: 1.0, heard_until_s=0.0)
    assert not speeds.any()


@pytest.mark.parametrize("change", [{"begin_s": 1.2}, {"end_s": 1.2}])
def test_the_arm_stops_when_a_copilot_comes_or_goes(desk, change):
    times, speeds = driven(desk, lambda now_s: 0.3, **change)
    assert times[speeds > 0.0][-1] < 1.2 + 0.15
    assert desk.reports[-1].reason.code == "copilot_changed"


def sat():
    connected = ConnectedPages()
    return connected, *(connected.join(name) for name in ("Ada", "Bob", "Eve"))


def test_a_copilot_asks_and_the_driver_accepts():
    connected, ada, bob, eve = sat()
    copilot = connected.copilot
    assert not copilot.accept(bob.id)
    copilot.ask(bob.id)
    copilot.ask(eve.id)
    assert not copilot.accept(eve.id)
    assert copilot.accept(bob.id)
    copilot.says(eve.id, 0.1, "n")
    assert copilot.paced.pace == 1.0
    copilot.says(bob.id, 0.2, "n")
    assert copilot.paced.pace == 0.2
    copilot.ask(eve.id)
    assert copilot.asking is None
    assert connected.drives(ada)


def test_a_copilot_goes_with_the_driver_and_by_either():
    connected, ada, bob, _ = sat()
    copilot = connected.copilot
    for end in (lambda: copilot.leaves(bob.id), copilot.end, lambda: connected.release(ada)):
        copilot.ask(bob.id)
        assert copilot.accept(bob.id)
        assert end()
        assert (copilot.page, copilot.paced) == (None, None)


def test_the_next_copilot_is_another_one():
    connected, _, bob, eve = sat()
    numbers = []
    for page in (bob, eve):
        connected.copilot.ask(page.id)
        connected.copilot.accept(page.id)
        numbers.append(connected.copilot.paced.copilot)
        connected.copilot.end()
    assert numbers[0] != numbers[1]
