"""Learned motions end where a thing is unknown, and a held stick does nothing after a jump."""

import time
from dataclasses import replace
from multiprocessing import Pipe

import numpy as np
import pytest
from wooden_server import wooden_server

from latentarm.core.errors import UserError
from latentarm.core.types import Demonstrations, Episode, Pose
from latentarm.demonstrations.dataset import write_dataset
from latentarm.demonstrations.things import ENVIRONMENT
from latentarm.recordings.journal_reader import read_journal
from latentarm.runs.options import TrainOptions
from latentarm.runs.training import train_run
from latentarm.surroundings.contract import Sighting
from latentarm.surroundings.process import as_message
from latentarm.tasks.catalogue import make_scene_task
from latentarm.web.arm_process.drive_setup import Spec, load_setup
from latentarm.web.protocol.orders import ChooseMode, Enable, Record, TouchThing

NAMES = ("left marshmallow", "middle marshmallow", "right marshmallow")
PLACES = np.array([[0.5, 0.06, 0.074], [0.56, 0.0, 0.074], [0.5, -0.06, 0.074]])
HTTP = "http:8470"
FAR = np.array([0.0, 0.0, 0.1])


@pytest.fixture(scope="module")
def run(tmp_path_factory):
    """A run of a model that looks at three things."""
    rng, robot = np.random.default_rng(0), make_scene_task("marshmallows").robot
    episodes = []
    for _ in range(4):
        way = np.linspace(0.0, 1.0, 40)[:, None] * rng.uniform(-0.4, 0.4, robot.dof)
        rows = np.concatenate(
            [PLACES + rng.normal(0.0, 0.02, (3, 3)), np.tile([1.0, 0, 0, 0], (3, 1))], axis=1
        )
        seen = {ENVIRONMENT: np.tile(rows.ravel(), (40, 1))}
        episodes.append(Episode(robot.home + way, np.arange(40) / 20.0, extras=seen))
    folder = tmp_path_factory.mktemp("looking")
    joints = Demonstrations(tuple(episodes), 20.0, robot.joint_names, robot.name, objects=NAMES)
    write_dataset(joints, folder / "data")
    train_run(
        TrainOptions((folder / "data",), "cae", context=("joints", "objects"), out=folder / "run", seeds=1)
    )
    return folder / "run"


@pytest.fixture(scope="module")
def looking(run):
    """The run at a simulated arm that sources tell where the things are."""
    setup = load_setup(Spec(run, task="marshmallows", arm="mujoco", objects=("touch", HTTP)))
    return replace(setup, arm="kinematic", todo=replace(setup.todo, steps=(), failures=()))


class Room:
    """Shows things to the loop ten times a second, while `shown` says where they are."""

    def __init__(self, writing):
        self.writing = writing
        self.shown = {}
        self.next_s = 0.0

    def tick(self, now_s):
        if now_s < self.next_s:
            return
        self.next_s = now_s + 0.1
        for name, place in self.shown.items():
            pose = Pose(np.asarray(place), np.eye(3))
            seen = Sighting(name, pose, time.monotonic(), 0.005, 0.1)
            self.writing.send_bytes(as_message(seen, HTTP, 2.0))


def drive(desk_of, setup, script, for_s):
    """Drive by a script of acts at times, s; the arm is enabled at 0.1 s."""
    reading, writing = Pipe(duplex=False)
    with desk_of(setup, reading) as desk:
        room = Room(writing)
        u = [0.0, 0.0]

        def tick(now_s):
            if abs(now_s - 0.1) < 0.005:
                desk.order(Enable(driver=1, stops=0))
            for at_s, act in script:
                if abs(now_s - at_s) < 0.005:
                    act(desk, room, u)
            room.tick(now_s)
            desk.give(*u)

        desk.each_tick = tick
        desk.run(for_s)
    return desk


def everything(desk, room, u):
    room.shown = dict(zip(NAMES, PLACES, strict=True))


def latent(desk, room, u):
    desk.order(ChooseMode(mode="latent"))


def push(desk, room, u):
    u[:] = [1.0, 0.3]


def let_go(desk, room, u):
    u[:] = [0.0, 0.0]


def nothing(desk, room, u):
    room.shown = {}


def moves(desk, begin_s, end_s):
    return desk.speeds()[(desk.times() > begin_s) & (desk.times() < end_s)].max() > 1e-6


def modes(desk, begin_s, end_s):
    return {one.mode for one in desk.reports if begin_s < one.time_s < end_s}


def test_learned_motions_begin_once_things_are_seen_and_end_when_one_is_lost(desk_of, looking):
    script = [(0.3, latent), (0.6, everything), (1.6, latent), (1.8, push), (2.5, nothing)]
    desk = drive(desk_of, looking, [*script, (5.5, let_go), (5.8, push)], 6.5)
    assert modes(desk, 0.02, 1.6) == {"end_effector"}
    notes = [one.note.code for one in desk.reports if one.note]
    assert notes[0] == "thing_unseen"
    assert modes(desk, 1.65, 4.4) == {"latent"}
    assert moves(desk, 2.0, 4.4)
    # The last sighting was of 2.5 s and counts for 2 s.
    assert modes(desk, 4.6, 6.5) == {"end_effector"}
    lost = next(one for one in desk.reports if one.note and one.note.code == "thing_lost")
    assert lost.time_s == pytest.approx(4.45, abs=0.07)
    assert lost.let_go_first
    assert not moves(desk, 4.8, 5.7)
    assert moves(desk, 6.0, 6.5)


def test_after_a_jump_that_is_believed_a_held_stick_does_nothing(desk_of, looking):
    def moved(desk, room, u):
        room.shown[NAMES[1]] = PLACES[1] + FAR

    script = [(0.3, everything), (1.2, latent), (1.4, push), (2.0, moved)]
    desk = drive(desk_of, looking, [*script, (4.5, let_go), (4.7, push)], 5.5)
    assert modes(desk, 1.3, 5.5) == {"latent"}
    assert moves(desk, 2.0, 3.4)
    jumped = next(one.time_s for one in desk.reports if one.let_go_first and one.time_s > 1.5)
    assert 3.5 <= jumped <= 3.8
    assert not moves(desk, jumped + 0.3, 4.6)
    assert moves(desk, 5.0, 5.5)


def test_a_person_shows_where_things_are_with_the_tool_alone(desk_of, looking):
    def touch(thing, kind):
        return lambda desk, room, u: desk.order(TouchThing(thing=thing, kind=kind))

    script = [(0.2 + 0.1 * index, touch(name, "place")) for index, name in enumerate(NAMES)]
    desk = drive(desk_of, looking, [*script, (1.0, latent), (2.0, touch(NAMES[0], "undo"))], 2.5)
    assert modes(desk, 1.1, 1.9) == {"latent"}
    told = {one.name: one for one in next(r.things for r in desk.reports if r.things and r.time_s > 1.5).seen}
    assert {one.seen for one in told.values()} == {"seen"}
    assert {one.source for one in told.values()} == {"touch"}
    assert modes(desk, 2.1, 2.5) == {"end_effector"}


def test_a_recording_keeps_who_said_where_each_thing_is_and_how_long_ago(desk_of, looking, tmp_path):
    def touch(kind):
        return lambda desk, room, u: desk.order(TouchThing(thing=NAMES[0], kind=kind))

    def others(desk, room, u):
        room.shown = dict(zip(NAMES[1:], PLACES[1:], strict=True))

    def record(*, on):
        return lambda desk, room, u: desk.order(Record(on=on, task="stab", person="Ada"))

    shown = [(0.2, touch("place")), (0.3, others), (1.5, touch("undo")), (2.0, nothing)]
    driven = [(1.0, record(on=True)), (1.7, push), (2.2, let_go), (2.5, record(on=False))]
    drive(desk_of, looking, shown + driven, 3.0)
    (journal,) = (tmp_path / "teleop").glob("*.sqlite")
    (episode,) = read_journal(journal)
    header, records = episode.header, episode.records
    assert header.sources == ("scene", "touch", "http")
    assert header.things == NAMES
    for name, source in zip(NAMES, ("touch", "http", "http"), strict=True):
        number = header.things.index(name)
        by, age_s = np.array([one.sightings[number] for one in records]).T
        time_s = np.array([one.time_s for one in records])
        assert {header.sources[int(one)] for one in by} == {source}
        if source == "touch":
            # Also after it was taken back, when nobody knows where the thing is.
            np.testing.assert_allclose(age_s, time_s - 0.2, atol=0.021)
            assert np.ptp([one.things[number] for one in records], axis=0).max() == 0.0
        else:
            assert age_s[time_s < 2.0].max() <= 0.15
            np.testing.assert_allclose(age_s[-1], time_s[-1] - 2.0, atol=0.15)


def test_about_a_real_arm_a_person_shows_the_things_from_the_page(serve, run, tmp_path):
    with (
        wooden_server(make_scene_task("marshmallows").robot) as wooden,
        serve(Spec(run, arm=wooden.address, out=tmp_path)) as site,
        site.page() as page,
    ):
        state = page.wait(lambda state: state["you"] and state["things"])
        assert {one["seen"] for one in state["things"]["seen"]} == {"unseen"}
        assert state["mode"] == "end_effector"
        for name in NAMES:
            page.send(type="touch", thing=name, kind="place")
        page.wait(
            lambda state: {one["seen"] for one in (state["things"] or {"seen": []})["seen"]} == {"seen"}
        )
        page.send(type="mode", mode="latent", axes=None)
        page.wait(lambda state: state["mode"] == "latent")
        page.send(type="touch", thing=NAMES[0], kind="undo")
        page.wait(lambda state: state["mode"] == "end_effector" and state["note"]["code"] == "thing_unseen")


def test_a_source_that_is_none_is_refused_where_it_was_typed(run):
    with pytest.raises(UserError, match="--objects names the source of where things are 'radar'"):
        Spec(objects=("radar:1",))
    with pytest.raises(UserError, match="there are none here"):
        load_setup(Spec(objects=("touch",)))
    with pytest.raises(UserError, match=r"looks at left marshmallow, .*, which this task does not have"):
        load_setup(Spec(run, task="dessert", objects=("touch",)))
