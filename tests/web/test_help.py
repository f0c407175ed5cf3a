"""How much the robot helps, as a person chooses it while they drive; in simulated time."""

import numpy as np
import pytest

from latentarm.web.arm_process.drive_setup import RELEASE_FRACTION, DriveSetup, Spec, load_setup
from latentarm.web.arm_process.help import LEVELS, USUAL_HELP
from latentarm.web.protocol.orders import ChooseHelp, ChooseMode, Enable

CERTAIN = np.array([0.98, 0.01, 0.01])
UNSURE = np.array([0.4, 0.3, 0.3])
PUSH, REST = np.array([1.0, 0.0]), np.zeros(2)


@pytest.mark.parametrize("level", LEVELS)
def test_no_level_helps_a_person_who_lets_go_or_whose_goal_nobody_knows(level):
    assert LEVELS[level].alpha(REST, CERTAIN) == 0.0
    assert LEVELS[level].alpha(PUSH, UNSURE) == 0.0
    assert not LEVELS[level].acts_at_rest


def test_each_level_helps_more_than_the_one_below_and_none_takes_over():
    shares = [float(one.alpha(PUSH, CERTAIN)) for one in LEVELS.values()]
    assert shares[0] == 0.0
    assert shares == sorted(set(shares))
    assert shares[-1] < 0.5
    # Help never comes faster than the person pushes.
    halves = [float(one.alpha(0.15 * PUSH, CERTAIN)) for one in LEVELS.values()]
    assert halves == pytest.approx([share / 2.0 for share in shares])


def test_help_is_on_at_first_where_there_is_something_to_help_with(setup: DriveSetup):
    assert USUAL_HELP == "medium"
    assert setup.first_mode(USUAL_HELP) == "assisted"
    assert setup.first_mode("off") == "latent"
    assert load_setup(Spec()).first_mode(USUAL_HELP) == "end_effector"


def driven(desk, orders, until_s=2.5, let_go=()):
    """Push from 0.5 s on, but for the spans in which one lets go; the orders by when they are given, s."""

    def tick(now_s):
        pushed = now_s >= 0.5 and not any(begin <= now_s < end for begin, end in let_go)
        desk.give(1.0 if pushed else 0.0, 0.0)
        for at_s, order in {0.1: Enable(driver=1, stops=desk.channel.stop.version), **orders}.items():
            if abs(now_s - at_s) < 0.005:
                desk.order(order)

    desk.each_tick = tick
    desk.run(until_s)


def shown(desk, at_s):
    report = min(desk.reports, key=lambda one: abs(one.time_s - at_s))
    return report.mode, report.help


def test_a_level_is_a_mode_too(desk):
    driven(
        desk,
        {
            0.2: ChooseHelp(level="high"),
            0.8: ChooseHelp(level="off"),
            1.1: ChooseMode(mode="assisted", axes=None),
            1.4: ChooseMode(mode="end_effector", axes=1),
            1.7: ChooseHelp(level="low"),
            2.0: ChooseMode(mode="assisted", axes=None),
            2.2: ChooseMode(mode="latent", axes=None),
        },
    )
    times = (0.1, 0.6, 1.0, 1.3, 1.6, 1.9, 2.1, 2.4)
    assert [shown(desk, at_s) for at_s in times] == [
        ("latent", "off"),
        ("assisted", "high"),
        ("latent", "off"),
        ("assisted", "medium"),
        ("end_effector", "medium"),
        ("end_effector", "low"),
        ("assisted", "low"),
        ("latent", "off"),
    ]
    # Straight lines are the person's alone.
    assert not any(record.alpha for record in desk.records if 1.45 < record.time_s < 1.95)


def test_a_level_takes_hold_once_the_stick_was_let_go_and_the_arm_never_jumps(desk):
    driven(
        desk,
        {0.2: ChooseHelp(level="high"), 1.5: ChooseHelp(level="off"), 2.5: ChooseHelp(level="high")},
        3.5,
        let_go=((1.8, 1.9), (2.6, 2.7)),
    )
    alphas = {
        at_s: max(r.alpha for r in desk.records if abs(r.time_s - at_s) < 0.05) for at_s in (1.4, 2.3, 3.4)
    }
    assert alphas[2.3] == 0.0
    assert max(alphas[1.4], alphas[3.4]) > 0.0
    speeds, times = desk.speeds(), desk.times()
    assert not speeds[(times > 1.5 + 0.15) & (times < 1.8)].any()
    assert speeds[(times > 2.2) & (times < 2.5)].min() > 0.0
    commands = np.array([record.command.velocity for record in desk.records if record.time_s < 3.5])
    gained = np.abs(np.diff(commands, axis=0))
    assert (gained <= RELEASE_FRACTION * desk.setup.task.robot.limits.acceleration * 0.01 + 1e-9).all()
