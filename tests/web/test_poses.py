"""Saved poses: the arm goes there slowly, under the same filters and the same Stop as any motion."""

import asyncio

import numpy as np
import pytest

from latentarm.web.arm_process.pose_motion import ARRIVED_RAD, STUCK_S
from latentarm.web.protocol.orders import Enable, PoseToGoTo, Return
from latentarm.web.records.people import People
from latentarm.web.records.poses import MOST_POSES, POSES_NAME
from latentarm.web.server.pose_book import PoseBook

ASKED_S = 0.5


def go(desk, pose, then=lambda now_s: None):
    def tick(now_s):
        if abs(now_s - 0.1) < 0.005:
            desk.order(Enable(driver=1, stops=desk.channel.stop.version))
        if abs(now_s - ASKED_S) < 0.005:
            desk.order(Return(on=True, pose=pose))
        then(now_s)
        desk.give(0.0, 0.0)

    desk.each_tick = tick


def said(desk):
    return [report.note for report in desk.reports if report.note is not None]


def test_the_arm_goes_to_a_saved_pose_slowly_and_says_so(desk):
    goal = desk.setup.start.copy()
    goal[0] += 0.3
    go(desk, PoseToGoTo(name="Drink", q=tuple(goal.tolist())))
    desk.run(4.0)
    last = desk.reports[-2]
    assert np.abs(np.array(last.q) - goal).max() <= ARRIVED_RAD
    assert not last.returning
    assert last.phase == "ready"
    assert {(note.code, note.parameters["pose"]) for note in said(desk)} == {("at_pose", "Drink")}
    assert {report.bound_for for report in desk.reports if report.returning} == {"Drink"}
    positions = np.array([record.state for record in desk.records])
    assert np.abs(np.diff(positions, axis=0)).max() < 0.5 * 0.01 + 1e-6
    tools = np.array([report.tool for report in desk.reports])
    assert np.linalg.norm(np.diff(tools, axis=0), axis=1).max() < 0.25 * 0.01


def test_stop_ends_the_way_to_a_pose(desk):
    goal = desk.setup.start.copy()
    goal[0] += 1.0

    def then(now_s):
        if abs(now_s - 1.0) < 0.005:
            desk.channel.stop.write(b"Stop.")

    go(desk, PoseToGoTo(name="Drink", q=tuple(goal.tolist())), then)
    desk.run(2.0)
    assert desk.speeds()[desk.times() < 1.0].max() > 0.1
    assert not desk.speeds()[desk.times() > 1.15].any()
    assert desk.reports[-2].phase == "disengaged"
    assert desk.reports[-2].bound_for is None


@pytest.mark.parametrize("wrong", ["short", "beyond"])
def test_a_pose_that_is_not_this_arms_is_refused_in_words_and_nothing_moves(desk, wrong):
    q = desk.setup.start[:3] if wrong == "short" else desk.setup.start + 10.0
    go(desk, PoseToGoTo(name="Drink", q=tuple(q.tolist())))
    desk.run(1.0)
    assert not desk.speeds().any()
    assert {note.code for note in said(desk)} == {"pose_unreachable"}


def test_a_way_with_something_in_it_is_not_begun_and_what_it_is_is_said(desk):
    low = desk.setup.start.copy()
    low[1] += 1.5
    go(desk, PoseToGoTo(name="Floor", q=tuple(low.tolist())))
    desk.run(2.0)
    assert not desk.speeds().any()
    (note,) = {(note.code, note.parameters["second"]) for note in said(desk)}
    assert note == ("path_blocked", "table")
    assert not desk.reports[-2].returning
    assert desk.reports[-2].phase == "ready"


def test_an_arm_that_is_held_back_says_so_after_a_stated_time(desk):
    goal = desk.setup.start.copy()
    goal[6] = desk.setup.task.robot.limits.upper[6] - 0.02  # nearer to its end than the filters let it go
    go(desk, PoseToGoTo(name="Turned", q=tuple(goal.tolist())))
    desk.run(ASKED_S + np.abs(goal - desk.setup.start).max() / 0.35 + STUCK_S + 1.5)
    assert "joint_position" in {report.held_back for report in desk.reports if report.returning}
    (note,) = {(note.code, note.parameters["pose"], note.parameters["seconds"]) for note in said(desk)}
    assert note == ("pose_stuck", "Turned", 3)
    assert not desk.reports[-2].returning
    assert desk.reports[-2].phase == "ready"


def test_poses_are_kept_by_person_and_robot_and_outlive_the_server(tmp_path):
    people = People(tmp_path / "people")
    ada = people.add("Ada").id

    async def use(act):
        book = PoseBook(people, tmp_path)
        found = act(book)
        await book.settled()
        return found

    def save(book):
        book.save(ada, "panda", "Drink", (0.1, 0.2))
        book.save(ada, "panda", "drink", (0.3, 0.4))  # the same name: in its place
        book.save(ada, "planar", "Drink", (0.5,))
        book.save(None, "panda", "Tuck", (0.6, 0.7))

    asyncio.run(use(save))
    assert asyncio.run(use(lambda book: book.told(ada, "panda").names)) == ("drink",)
    assert asyncio.run(use(lambda book: book.find(ada, "panda", "drink").q)) == (0.3, 0.4)
    assert asyncio.run(use(lambda book: book.find(ada, "panda", "Tuck"))) is None
    assert asyncio.run(use(lambda book: book.told(None, "panda").names)) == ("Tuck",)
    asyncio.run(use(lambda book: book.delete(ada, "panda", "drink")))
    assert asyncio.run(use(lambda book: book.told(ada, "panda").names)) == ()
    assert asyncio.run(use(lambda book: book.told(ada, "planar").names)) == ("Drink",)
    people.remove(ada)
    assert not list((tmp_path / "people").rglob(POSES_NAME))


def test_what_cannot_be_kept_is_said(tmp_path):
    async def use():
        book = PoseBook(People(tmp_path / "people"), tmp_path)
        book.save(None, "panda", " ", (0.1,))
        nameless = book.told(None, "panda")
        for number in range(MOST_POSES + 1):
            book.save(None, "panda", f"pose {number}", (0.1,))
        full = book.told(None, "panda")
        await book.settled()
        return nameless, full

    nameless, full = asyncio.run(use())
    assert nameless.problem.code == "pose_name_invalid"
    assert full.problem.code == "too_many_poses"
    assert len(full.names) == MOST_POSES


def test_a_damaged_file_is_said(tmp_path):
    (tmp_path / POSES_NAME).write_text("{")
    told = PoseBook(People(tmp_path / "people"), tmp_path).told(None, "panda")
    assert told.names == ()
    assert told.problem.code == "error"
