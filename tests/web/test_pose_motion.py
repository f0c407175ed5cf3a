"""The arm drives back to its start under the safety filters, in simulated time."""

from dataclasses import replace

import numpy as np
import pytest

from latentarm.recordings.journal_reader import read_journal
from latentarm.robots.kinematics.obstacles import HalfSpace, Sphere
from latentarm.tasks.place import Place
from latentarm.web.arm_process.pose_motion import ARRIVED_RAD
from latentarm.web.protocol.orders import ChooseMode, Enable, Paced, Record, Return

AWAY_S = 1.6
"""When the arm has been driven away and let go."""


class Away:
    """Somebody enables the arm, drives it away, lets go, and asks for the way back at `AWAY_S`."""

    def __init__(self, desk):
        self.desk = desk
        self.then = lambda now_s: None
        self.u = (0.0, 0.0)
        self.gripper = None
        self.silent = False
        self.pace = None
        desk.each_tick = self.tick

    def tick(self, now_s):
        desk = self.desk
        if abs(now_s - 0.1) < 0.005:
            desk.order(Enable(driver=1, stops=desk.channel.stop.version))
        if abs(now_s - AWAY_S) < 0.005:
            desk.order(Return(on=True))
        self.then(now_s)
        if not self.silent:
            newest = desk.reports[-1].nonce if desk.reports else ""
            paced = None if self.pace is None else Paced(copilot=1, pace=self.pace(now_s), nonce=newest)
            u = (1.0, 1.0) if 0.3 <= now_s < 1.3 else self.u
            desk.give(*u, gripper=self.gripper, paced=paced)

    def reports(self, after_s=AWAY_S):
        return [report for report in self.desk.reports if report.time_s > after_s + 0.015]


@pytest.fixture
def away(desk):
    return Away(desk)


def away_from_start(desk, report):
    return np.abs(np.array(report.q) - desk.setup.start).max()


@pytest.mark.parametrize("pace", [0.0, 0.25])
def test_a_copilots_pace_binds_the_way_back(desk, away, pace):
    away.pace = lambda now_s: 1.0 if now_s < AWAY_S - 0.1 else pace
    desk.run(3.6)
    after = [record for record in desk.records if record.time_s > AWAY_S + 0.1]
    fastest = max(np.abs(record.command.velocity).max() for record in after)
    assert fastest <= pace * 0.5 + 1e-9
    assert (fastest > 0.0) == (pace > 0.0)


def test_it_arrives_slowly_and_says_so(desk, away):
    desk.run(5.0)
    before = next(report for report in desk.reports if report.time_s >= AWAY_S)
    assert away_from_start(desk, before) > 0.1
    assert not before.at_start
    last = desk.reports[-2]
    assert away_from_start(desk, last) <= ARRIVED_RAD
    assert last.at_start
    assert not last.returning
    said = {report.note.code for report in desk.reports if report.note is not None}
    assert said == {"at_start"}
    # Never a jump, never faster than the limits of any motion, and the belief is as at first.
    positions = np.array([record.state for record in desk.records])
    assert np.abs(np.diff(positions, axis=0)).max() < 0.5 * 0.01 + 1e-6
    tools = np.array([report.tool for report in desk.reports])
    assert np.linalg.norm(np.diff(tools, axis=0), axis=1).max() < 0.25 * 0.01
    table = next(one for one in desk.setup.task.obstacles if isinstance(one, HalfSpace))
    assert ((tools - table.point) @ table.normal).min() > 0.0
    way = [report for report in desk.reports if report.returning]
    assert len(way) > 50
    assert all(np.ptp(report.belief) < 1e-9 for report in way[1:])
    # The mode that people see is theirs, and the arm is enabled all the while.
    assert {report.mode for report in way} == {"latent"}
    assert {report.reason for report in way} == {None}
    assert last.phase == "ready"


@pytest.mark.parametrize("before", ["not enabled", "pushed", "moving"])
def test_it_does_not_begin_before_the_arm_is_enabled_and_let_go(desk, away, before):
    if before == "not enabled":
        away.tick = lambda now_s: None
        desk.each_tick = lambda now_s: (desk.give(0.0, 0.0), asked(desk, now_s))
    elif before == "pushed":
        away.then = lambda now_s: setattr(away, "u", (1.0, 0.0) if now_s > 1.5 else (0.0, 0.0))
    else:
        away.then = lambda now_s: asked(desk, now_s, at_s=1.0)
    desk.run(1.8)
    assert not any(report.returning for report in desk.reports if report.time_s < AWAY_S)
    if before != "moving":
        assert not any(report.returning for report in desk.reports)
    assert "return_not_now" in {report.note.code for report in desk.reports if report.note is not None}


def asked(desk, now_s, at_s=0.5):
    if abs(now_s - at_s) < 0.005:
        desk.order(Return(on=True))


def rest_after(desk, at_s):
    """Whether nothing moves any more 0.15 s later."""
    return not desk.speeds()[desk.times() > at_s + 0.15].any()


@pytest.mark.parametrize("ending", ["stop", "silence", "end", "mode", "gripper"])
def test_whatever_ends_it_the_arm_is_at_rest_at_once(desk, away, ending):
    at_s = 2.0

    def then(now_s):
        if abs(now_s - at_s) > 0.005:
            away.gripper = None
            return
        if ending == "stop":
            desk.channel.stop.write(b"Stop.")
        elif ending == "silence":
            away.silent = True
        elif ending == "end":
            desk.order(Return(on=False))
        elif ending == "mode":
            desk.order(ChooseMode(mode="end_effector", axes=0))
        else:
            away.gripper = "close"

    away.then = then
    desk.run(3.0)
    assert any(report.returning for report in desk.reports if 1.7 < report.time_s < 1.9)
    assert rest_after(desk, at_s)
    last = desk.reports[-2]
    assert not last.returning
    assert away_from_start(desk, last) > 0.05
    assert last.phase == ("disengaged" if ending in ("stop", "silence") else "ready")
    assert last.mode == ("end_effector" if ending == "mode" else "latent")


def test_a_push_ends_it_and_moves_the_arm_only_after_it_was_let_go(desk, away):
    def then(now_s):
        away.u = (-1.0, 0.0) if 2.0 <= now_s < 2.6 or now_s > 2.9 else (0.0, 0.0)

    away.then = then
    desk.run(3.4)
    times, speeds = desk.times(), desk.speeds()
    assert speeds[(times > 1.8) & (times < 2.0)].min() > 0.0
    assert not speeds[(times > 2.15) & (times < 2.9)].any()
    assert speeds[(times > 3.2) & (times < 3.4)].min() > 0.0
    said = [report.note.code for report in away.reports() if report.note is not None]
    assert set(said) == {"return_pushed"}
    # Who drives on reads what the arm does, not what ended before.
    assert desk.reports[-2].note is None


def test_a_way_back_with_something_in_it_is_not_begun(setup, desk_of):
    # Behind the tool at the start, so near that the filters let it leave but not come back.
    chain, u = setup.task.robot.chain, np.array([1.0, 1.0])
    context = setup.step().context(setup.start)
    pose = chain.forward(setup.start)
    velocity = setup.controller.action(setup.controller.latent(u, context, 0), context, 0)
    leaves = (chain.jacobian_at(chain.link_transforms(setup.start), pose) @ velocity)[:3]
    ball = Sphere("ball", pose.position - 0.02 * leaves / np.linalg.norm(leaves), 0.015)
    place = Place(setup.task.robot, setup.task.goals, (*setup.task.obstacles, ball))
    with desk_of(replace(setup, task=place)) as desk:
        Away(desk)
        desk.run(AWAY_S + 1.5)
        assert not desk.speeds()[desk.times() > AWAY_S + 0.1].any()
        blocked = next(report for report in desk.reports if report.note is not None)
        assert blocked.note.code == "return_blocked"
        assert blocked.note.parameters["second"] == "ball"
        assert desk.reports[-2].phase == "ready"


def test_an_episode_ends_before_the_way_back(desk, away, tmp_path):
    def then(now_s):
        if abs(now_s - 0.2) < 0.005:
            desk.order(Record(on=True, task=""))

    away.then = then
    desk.run(3.0)
    desk.writer.close()
    (path,) = (tmp_path / "teleop").glob("*.sqlite")
    (episode,) = read_journal(path)
    assert episode.complete
    assert max(record.time_s for record in episode.records) < AWAY_S + 0.05
    assert {record.mode for record in episode.records} == {0}
