"""Things about the arm reach the pages: their shapes once, their places while they move."""

import json
from dataclasses import replace
from multiprocessing import Pipe

import numpy as np
import pytest

from latentarm.arms.catalogue import make_scene_arm
from latentarm.arms.kinematic import KinematicArm
from latentarm.control.clock import SimulatedClock
from latentarm.core.errors import UserError
from latentarm.core.types import Pose
from latentarm.demonstrations.contexts import context_layout
from latentarm.demonstrations.dataset import read_dataset, write_dataset
from latentarm.demonstrations.things import ENVIRONMENT
from latentarm.recordings.dataset_export import demonstrations_of
from latentarm.recordings.journal_reader import read_journal
from latentarm.robots.catalogue import load_robot
from latentarm.robots.kinematics.rotations import angle_between
from latentarm.robots.scene.containers import cup
from latentarm.robots.scene.scene import Scene, SceneState
from latentarm.robots.scene.thing import Grains, Part, Thing
from latentarm.tasks.eating import dessert
from latentarm.tasks.inverse_kinematics import solve
from latentarm.tasks.place import Place
from latentarm.web.arm_process.drive import Drive
from latentarm.web.arm_process.drive_setup import Spec, load_setup
from latentarm.web.arm_process.episode_writer import EpisodeWriter
from latentarm.web.arm_process.steering import Steering
from latentarm.web.arm_process.thing_poses import ThingPoses
from latentarm.web.protocol.channel import Channel
from latentarm.web.protocol.orders import AskedGripper, Enable, Given, Record
from latentarm.web.protocol.report import Report, Things
from latentarm.web.protocol.scene import described, drawable, things_at
from latentarm.web.server.states import PageMemory

UPRIGHT = np.eye(3)
ON_ITS_SIDE = np.array([[1.0, 0.0, 0.0], [0.0, 0.0, -1.0], [0.0, 1.0, 0.0]])
CUP = Thing(
    "cup",
    (Part("cylinder", (0.03, 0.05)), Part("box", (0.01, 0.01, 0.02), (0.04, 0.0, 0.0))),
    0.1,
    Pose(np.zeros(3), UPRIGHT),
)
RICE = Grains("rice", 0.004, 1e-4, np.array([[0.1, 0.2, 0.3], [0.4, 0.5, 0.6]]))
SCENE = Scene((CUP, replace(CUP, name="bowl")), (RICE,))


def state(cup: Pose) -> SceneState:
    return SceneState(
        time_s=0.0,
        tool=cup,
        poses={"bowl": Pose(np.ones(3), UPRIGHT), "cup": cup},
        speed_m_s={},
        stabbed=frozenset(),
        gripped=frozenset(),
        bonds=frozenset(),
        grains={"rice": RICE.positions + 1.0},
        force_n={},
    )


def test_a_thing_is_described_by_its_parts_as_a_body_by_its_geoms():
    about = json.loads(json.dumps(described(SCENE)))
    cup, bowl = about["things"]
    assert (cup["name"], bowl["name"]) == ("cup", "bowl")
    assert [geom["type"] for geom in cup["geoms"]] == ["cylinder", "box"]
    assert [geom["size"] for geom in cup["geoms"]] == [[0.03, 0.05, 0.0], [0.01, 0.01, 0.02]]
    assert cup["pose"] == [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0]
    (rice,) = about["grains"]
    assert rice["positions"] == [0.1, 0.2, 0.3, 0.4, 0.5, 0.6]


def test_icing_is_drawn_where_the_food_must_go_and_apart_from_what_is_solid():
    icing = dessert.icing("icing", 0.4, -0.2)
    (shown,) = described(Scene((icing,)))["things"]
    assert len(shown["geoms"]) == len(icing.parts)
    (soft,) = shown["soft"]
    radius, half, _ = soft["size"]
    bottom, top = soft["pos"][2] - half, soft["pos"][2] + half
    assert (radius, bottom, top) == pytest.approx(
        (dessert.WET.radius_m, dessert.WET.bottom_m, dessert.WET.top_m)
    )
    assert soft["rgba"][3] < 1.0


def told(state):
    return things_at(SCENE, state.poses, state.grains, ())


def test_places_are_in_the_order_of_the_scene():
    found = told(state(Pose(np.array([0.12347, 0.0, 0.5]), ON_ITS_SIDE)))
    cup, bowl = found.poses
    assert cup == pytest.approx((0.1235, 0.0, 0.5, np.sqrt(0.5), np.sqrt(0.5), 0.0, 0.0), abs=1e-4)
    assert bowl[:3] == (1.0, 1.0, 1.0)
    assert found.grains == ((1.1, 1.2, 1.3, 1.4, 1.5, 1.6),)


def test_a_page_is_sent_what_has_moved_since_it_was_last_sent_something():
    first, second = PageMemory(), PageMemory()
    here = told(state(CUP.pose))
    there = told(state(Pose(np.array([0.0, 0.0, 0.1]), UPRIGHT)))
    assert [first.new_things(one) for one in (here, here, Things(**dict(here)), there, here)] == [
        True,
        False,
        False,
        True,
        True,
    ]
    assert second.new_things(here)


def test_the_fingers_of_a_gripper_open_away_from_each_other():
    robot = load_robot("panda")
    scene = drawable(Place(robot, (), ()), (), None).description
    first, second = scene["fingers"]
    np.testing.assert_allclose(np.add(first["opens"], second["opens"]), 0.0, atol=1e-5)
    assert first["body"] == second["body"] == robot.dof
    # Closed, their pads meet: no geom of one is farther on the other's side than it is thick.
    middles = [np.mean([geom["pos"] for geom in one["geoms"]], axis=0) for one in (first, second)]
    assert 0.0 < np.dot(middles[0] - middles[1], first["opens"]) < 0.03
    assert first["at"] == pytest.approx(robot.gripper.width_m / 2.0)


def test_things_are_looked_at_25_times_a_second_where_the_arm_knows_of_them():
    setup = load_setup(Spec(task="marshmallows"))
    arm = make_scene_arm("mujoco", setup.task.robot, setup.start, lambda: 0.0, setup.scene)
    seen = [ThingPoses(setup, arm, None, lambda: 0.0).look(tick) for tick in range(100)]
    assert sum(one is not None for one in seen) == 25
    first = [thing["pose"] for thing in described(setup.scene)["things"]]
    np.testing.assert_allclose(seen[0].poses, first, atol=1e-3)
    ghost = KinematicArm(setup.task.robot, setup.start, lambda: 0.0)
    assert ThingPoses(setup, setup.with_things(ghost), None, lambda: 0.0).look(0) is None


def test_a_recording_says_where_things_went_and_a_model_can_see_them(tmp_path):
    """A ball is let go above the table, and a cup stands on it: all are recorded, and the ball matters."""
    ball = Thing("ball", (Part("sphere", (0.02,)),), 0.05, Pose(np.array([0.5, 0.2, 0.1]), UPRIGHT))
    cup = replace(CUP, pose=Pose(np.array([0.5, -0.2, 0.05]), UPRIGHT))
    begun = load_setup(Spec(task="marshmallows", arm="mujoco"))
    assert begun.objects == ("left marshmallow", "middle marshmallow", "right marshmallow")
    setup = replace(
        begun,
        task=Place(begun.task.robot, (), (), objects=("ball",)),
        todo=replace(begun.todo, steps=(), failures=()),
        scene=Scene((cup, ball)),
    )
    reading, orders = Pipe(duplex=False)
    clock, writer, channel = SimulatedClock(), EpisodeWriter(tmp_path / "teleop"), Channel(reading)

    def push(record):
        """The arm moves too: a recording in which it does not is not kept."""
        tick = round(record.time_s * 100)
        nonce = Report.parse(channel.report.read()[1]).nonce
        given = Given(
            driver=1, seq=tick, nonce=nonce, u=(float(tick > 10), 0.0), latched=False, source="keyboard"
        )
        channel.given.write(given.model_dump_json().encode())

    with make_scene_arm("mujoco", setup.task.robot, setup.start, clock.now_s, setup.scene) as arm:
        for order in (Record(on=True, task="watch", person="Ada"), Enable(driver=1, stops=0)):
            orders.send_bytes(order.model_dump_json().encode())
        steering = Steering("end_effector")
        Drive(setup, arm, channel, clock, writer, lambda: False, steering, observers=[push]).run(60)
    writer.end()
    writer.close()
    orders.close()
    reading.close()

    (journal,) = (tmp_path / "teleop").glob("*.sqlite")
    first = read_journal(journal)[0]
    assert first.header.things == ("cup", "ball")
    height = np.array([record.things[1, 2] for record in first.records])
    assert height[0] > 0.09
    np.testing.assert_allclose(height[-1], 0.02, atol=2e-3)  # it lies on the table
    np.testing.assert_allclose(first.records[-1].things[0, :3], cup.pose.position, atol=2e-3)

    write_dataset(demonstrations_of(read_journal(journal), source="drive"), tmp_path / "driven")
    driven = read_dataset(tmp_path / "driven")
    assert driven.objects == ("ball",)
    seen = driven.episodes[0].extras[ENVIRONMENT]
    np.testing.assert_allclose(seen, [record.things[1] for record in first.records], atol=1e-6)
    assert context_layout(driven, ("joints", "objects")).objects == ("ball",)


def test_a_task_with_things_needs_an_arm_that_can_touch_them():
    with pytest.raises(UserError, match="--arm kinematic has no things about it"):
        load_setup(Spec(task="marshmallows", arm="kinematic"))


def test_a_cup_is_picked_up_as_part_of_the_arm_and_put_down_upright_where_it_stood(tmp_path):
    begun = load_setup(Spec(task="pour", arm="mujoco"))
    robot, above = begun.task.robot, Pose(np.array([0.5, 0.0, 0.06]), np.diag([1.0, -1.0, -1.0]))
    scene = Scene((Thing("cup", cup().parts, 0.2, Pose(np.array([0.5, 0.0, 0.0]), UPRIGHT)),))
    setup = replace(
        begun,
        task=Place(robot, (), (scene.table,)),
        todo=replace(begun.todo, steps=(), failures=()),
        scene=scene,
        start=solve(robot, above, robot.home),
    )
    reading, orders = Pipe(duplex=False)
    clock, writer, channel = SimulatedClock(), EpisodeWriter(tmp_path / "teleop"), Channel(reading)
    reports, poses = [], []

    def give(record):
        reports.append(Report.parse(channel.report.read()[1]))
        poses.append(arm.scene_state().poses["cup"])
        tick, nonce = len(reports), reports[-1].nonce
        asked = AskedGripper(ask="close" if tick < 450 else "open", seq=tick, nonce=nonce)
        u = (1.0 if 120 < tick < 180 else -1.0 if 200 < tick < 440 else 0.0, 0.0)
        given = Given(driver=1, seq=tick, nonce=nonce, u=u, latched=False, source="keyboard")
        given = given.model_copy(update={"gripper": asked if tick > 20 else None})
        channel.given.write(given.model_dump_json().encode())

    with make_scene_arm("mujoco", setup.task.robot, setup.start, clock.now_s, scene) as arm:
        orders.send_bytes(Enable(driver=1, stops=0).model_dump_json().encode())
        steering = Steering("end_effector", axes=setup.axes.index("z-yaw"))
        Drive(setup, arm, channel, clock, writer, lambda: False, steering, observers=[give]).run(500)
    writer.close()
    orders.close()
    reading.close()
    assert [reports[tick].held for tick in (0, 115, 430, -1)] == [(), ("cup",), ("cup",), ()]
    assert poses[190].position[2] > 0.05
    assert 0.0 <= poses[440].position[2] < 0.004
    assert angle_between(poses[440].rotation, UPRIGHT) < np.deg2rad(2.0)
    assert np.abs(poses[440].position - poses[0].position)[:2].max() < 0.005
