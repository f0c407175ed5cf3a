"""Things about the arm: held by friction, stabbed, cut, poured, and the same each time."""

import hashlib
import subprocess
import sys

import numpy as np
import pytest
from hypothesis import Phase, given, settings
from hypothesis import strategies as st

from latentarm.arms.catalogue import make_scene_arm
from latentarm.arms.mujoco import MujocoArm
from latentarm.control.clock import SimulatedClock
from latentarm.core.errors import UserError
from latentarm.core.types import Command, GripperCommand, Pose
from latentarm.robots.catalogue import load_robot
from latentarm.robots.panda import HOME
from latentarm.robots.scene.containers import WALL_M, bowl, cup, packed
from latentarm.robots.scene.scene import Scene
from latentarm.robots.scene.thing import Bond, Food, Grains, Part, Thing
from latentarm.tasks.inverse_kinematics import solve

DOWN = np.diag([1.0, -1.0, -1.0])
SOFT = Food(pierce_n=2.0, depth_m=0.008, grip_n=1.5)


def upright(x, y, z=0.0):
    return Pose(np.array([x, y, z]), np.eye(3))


class World:
    """An arm with a scene, moved by velocities of its tool."""

    def __init__(self, robot, scene, start):
        self.robot = load_robot(robot)
        self.clock = SimulatedClock()
        self.arm = MujocoArm(self.robot, start, self.clock.now_s, scene=scene)
        self.arm.connect()
        self.arm.enable()

    @classmethod
    def above(cls, robot, scene, position, rotation=DOWN):
        """With the hand pointing down."""
        return cls(robot, scene, solve(load_robot(robot), Pose(np.array(position), rotation), HOME))

    def drive(self, dq, seconds, gripper=None):
        """The scene after the joints have moved, rad/s."""
        for _ in range(round(seconds * 100)):
            self._tick(np.array(dq, dtype=float), gripper)
        return self.arm.scene_state()

    def move(self, velocity=(0.0, 0.0, 0.0), seconds=1.0, gripper=None):
        """The scene after the tool has moved, m/s, without turning."""
        for _ in range(round(seconds * 100)):
            jacobian = self.robot.chain.jacobian(self.arm.read().q)
            self._tick(np.linalg.pinv(jacobian) @ np.array([*velocity, 0.0, 0.0, 0.0]), gripper)
        return self.arm.scene_state()

    def _tick(self, dq, gripper):
        self.arm.send(Command(dq, duration_s=0.025, gripper=gripper))
        self.clock.wait_until(self.clock.now_s() + 0.01)


def in_hand(state, name):
    return state.tool.rotation.T @ (state.poses[name].position - state.tool.position)


def test_a_cup_is_gripped_lifted_and_carried_without_slipping_and_dropped():
    scene = Scene((Thing("cup", cup().parts, 0.2, upright(0.5, 0.0)),))
    world = World.above("panda", scene, (0.5, 0.0, 0.06))
    assert world.arm.read().gripper.width_m == pytest.approx(0.08)
    assert not world.move(seconds=0.2).gripped
    gripped = world.move(gripper=GripperCommand(0.0, 0.05, 30.0))
    assert gripped.gripped == {"cup"}
    assert world.arm.read().gripper.holding
    assert world.arm.read().gripper.width_m == pytest.approx(0.07, abs=1e-3)
    assert gripped.force_n["cup", "tool"] > 10.0
    # Without a word about the gripper it goes on holding, also when the arm stops and is disabled.
    lifted = world.move((0.0, 0.0, 0.1))
    assert lifted.poses["cup"].position[2] == pytest.approx(0.1, abs=5e-3)
    world.arm.stop()
    world.arm.disable()
    world.clock.wait_until(world.clock.now_s() + 0.5)
    world.arm.enable()
    carried = world.move((0.0, 0.15, 0.0))
    assert carried.poses["cup"].position[1] > 0.12
    assert np.abs(in_hand(carried, "cup") - in_hand(lifted, "cup")).max() < 1e-3
    assert world.arm.read().gripper.holding
    dropped = world.move(gripper=GripperCommand(0.08, 0.1, 30.0))
    assert dropped.poses["cup"].position[2] < 0.05
    assert not dropped.gripped
    assert not world.arm.read().gripper.holding


@settings(max_examples=6, phases=[Phase.explicit, Phase.generate])
@given(
    commands=st.lists(
        st.builds(GripperCommand, st.floats(0.0, 0.08), st.floats(0.0, 0.2), st.floats(5.0, 100.0)),
        min_size=1,
        max_size=4,
    )
)
def test_a_gripper_is_never_faster_or_stronger_than_it_was_told(the_panda, commands):
    clock = SimulatedClock()
    arm = MujocoArm(the_panda, the_panda.home, clock.now_s)
    arm.connect()
    arm.enable()
    width = arm.read().gripper.width_m
    for command in commands:
        arm.send(Command(np.zeros(7), 0.01, gripper=command))
        for tick in range(15):
            clock.wait_until(clock.now_s() + 0.01)
            gripper = arm.read().gripper
            # What it was told before takes some hundredths of a second to fade.
            speed = the_panda.gripper.speed_m_s if tick < 3 else min(command.speed_m_s, 0.1)
            assert abs(gripper.width_m - width) <= 0.01 * speed + 1e-5
            assert np.abs(arm.data.actuator_force[-2:]).max() <= min(command.force_n, 70.0) + 1e-9
            assert not gripper.holding
            width = gripper.width_m


def marshmallow(food=SOFT):
    part = Part("cylinder", (0.02, 0.012), (0.0, 0.0, 0.012))
    return Thing("marshmallow", (part,), 0.01, upright(0.5, 0.0), food=food)


def test_food_is_stabbed_lifted_and_scraped_off():
    rail = Thing("rail", (Part("box", (0.02, 0.05, 0.01)),), 1.0, upright(0.588, 0.0, 0.12), fixed=True)
    world = World.above("panda_fork", Scene((marshmallow(), rail)), (0.5, 0.0, 0.03))
    stabbed = world.move((0.0, 0.0, -0.05), 0.45)
    assert stabbed.stabbed == {"marshmallow"}
    assert 2.0 <= stabbed.force_n["marshmallow", "tool"] < 20.0
    assert world.arm.scene_state().force_n == stabbed.force_n, "asked again, no force is lost"
    for _ in range(5):
        assert world.move((0.0, 0.0, -0.05), 0.01).stabbed, "pressed deeper, it is held all the while"
    lifted = world.move((0.0, 0.0, 0.05))
    assert lifted.poses["marshmallow"].position[2] > 0.03
    under = world.move((0.06, 0.0, 0.0))
    assert under.stabbed == {"marshmallow"}
    scraped = world.move((0.0, 0.0, 0.06), 1.2)
    assert not scraped.stabbed
    assert scraped.poses["marshmallow"].position[2] < 0.05
    assert scraped.force_n["marshmallow", "rail"] > 1.0


def test_an_apple_that_falls_into_a_bowl_does_not_come_out_below():
    dish = bowl(0.08)
    apple = Thing("apple", (Part("sphere", (0.03,)),), 0.1, upright(0.5, 0.0, 0.33 + 0.05))
    stand = Thing("bowl", dish.parts, 0.3, upright(0.5, 0.0, 0.3), fixed=True, interior=dish.interior)
    world = World("panda", Scene((apple, stand)), HOME)
    heights = [world.move(seconds=0.01).poses["apple"].position[2] for _ in range(60)]
    assert min(heights) > 0.33
    assert heights[-1] == pytest.approx(0.33 + WALL_M, abs=1e-3)


def test_a_touch_does_not_stab():
    world = World.above("panda_fork", Scene((marshmallow(Food(50.0, 0.008, 1.5)),)), (0.5, 0.0, 0.03))
    touched = world.move((0.0, 0.0, -0.02), 0.4)
    assert touched.force_n["marshmallow", "tool"] > 0.1
    left = world.move((0.0, 0.0, 0.05), 0.5)
    assert not left.stabbed
    assert left.poses["marshmallow"].position[2] < 0.002
    assert ("marshmallow", "tool") not in world.move(seconds=0.01).force_n, "forces begin anew"


@pytest.mark.parametrize(("degrees", "cut"), [(0.0, True), (60.0, False)])
def test_an_edge_cuts_only_in_its_plane(degrees, cut):
    half = 0.02
    tofu = tuple(
        Thing(name, (Part("box", (half, 0.03, half), (0.0, 0.0, half)),), 0.05, upright(x, 0.0), food=SOFT)
        for name, x in (("first", 0.5 - half), ("second", 0.5 + half))
    )
    bond = Bond("first", "second", (half, 0.0, half), (1.0, 0.0, 0.0), 0.03, np.deg2rad(15.0))
    turn = np.deg2rad(degrees)
    turned = np.array(
        [[np.cos(turn), -np.sin(turn), 0.0], [np.sin(turn), np.cos(turn), 0.0], [0.0, 0.0, 1.0]]
    )
    world = World.above("panda_fork", Scene(tofu, bonds=(bond,)), (0.5, 0.0, 0.05), DOWN @ turned)
    above = world.move((0.0, 0.0, -0.05), 0.3)
    assert above.bonds == {("first", "second")}
    through = world.move((0.0, 0.0, -0.05), 0.55)
    assert bool(through.bonds) is not cut
    assert bool(through.stabbed) is not cut
    up = world.move((0.0, 0.0, 0.1), 0.8)
    apart = up.poses["second"].position - up.poses["first"].position
    assert np.linalg.norm(apart) == pytest.approx(2 * half, abs=2e-3)


ROOM = bowl(0.08).interior
CUP = cup()
BESIDE = np.array([0.5, 0.3, 0.0, -1.8, 0.0, 3.67, 0.785])
"""The hand level, its x axis up, a quarter of a metre beside the bowl."""


def pouring():
    """A cup with 24 grains in the hand, still on its stand, and a bowl farther down."""
    x, y, z = load_robot("panda").chain.forward(BESIDE).position
    stood = upright(x, y, z - 0.05)
    slab = (Part("box", (0.04, 0.04, 0.01), (0.0, 0.0, -0.01)),)
    things = (
        Thing("cup", CUP.parts, 0.15, stood),
        Thing("stand", slab, 1.0, stood, fixed=True),
        Thing("bowl", bowl(0.08).parts, 0.3, upright(np.hypot(x, y), 0.06, z - 0.3), fixed=True),
    )
    rice = Grains("rice", 0.006, 5e-4, packed(CUP.interior, stood, 24, 0.006))
    world = World("panda", Scene(things, (rice,)), BESIDE)
    world.drive(np.zeros(7), 1.0, GripperCommand(0.0, 0.05, 30.0))
    return world


def test_grains_stay_in_a_level_cup_and_are_counted_where_they_are_poured():
    world = pouring()
    level = world.drive((-0.25, 0, 0, 0, 0, 0, 0), 2.0)
    assert level.inside("rice", "cup", CUP.interior).all()
    assert not level.inside("rice", "bowl", ROOM).any()
    world.drive((0, 0, 0, 0, 0, 0, -1.0), 2.2)
    poured = world.drive(np.zeros(7), 1.0)
    assert poured.inside("rice", "bowl", ROOM).sum() >= 22
    world.clock.wait_until(world.clock.now_s() + 2.0)
    rest = world.arm.scene_state()
    later = world.drive(0.1 * np.ones(7), 0.2)
    # Grains that have come to rest are asleep: they do not move by a bit.
    np.testing.assert_array_equal(rest.grains["rice"], later.grains["rice"])


def digest():
    """Of grains half poured, with every bit of how they move."""
    world = pouring()
    world.drive((-0.2, 0, 0, 0, 0, 0, -2.0), 0.9)
    return hashlib.sha256(world.arm.data.qpos.tobytes() + world.arm.data.qvel.tobytes()).hexdigest()


def test_the_same_commands_move_everything_the_same_to_the_bit():
    program = "import test_scene; print(test_scene.digest())"
    other = subprocess.run(
        [sys.executable, "-c", program], cwd=__file__.rpartition("/")[0], capture_output=True, check=True
    )
    assert digest() == digest() == other.stdout.decode().strip()


def test_only_an_arm_in_physics_has_a_scene(the_panda):
    with pytest.raises(UserError, match=r"kinematic has no things about it.*--arm mujoco"):
        make_scene_arm("kinematic", the_panda, the_panda.home, lambda: 0.0, Scene())
    arm = make_scene_arm("mujoco", the_panda, the_panda.home, lambda: 0.0, Scene())
    assert arm.scene_state().poses == {}
    assert arm.spec.gripper == the_panda.gripper


@given(st.floats(0.003, 0.008), st.integers(1, 30))
def test_grains_begin_inside_without_touching_each_other(radius_m, count):
    made = cup(0.03, 0.2)
    places = packed(made.interior, upright(0.0, 0.0), count, radius_m)
    assert len(places) == count
    assert (np.hypot(places[:, 0], places[:, 1]) <= made.interior.radius_m - radius_m).all()
    assert (places[:, 2] >= made.interior.bottom_m + radius_m).all()
    apart = np.linalg.norm(places[:, None] - places, axis=-1) + np.eye(count)
    assert apart.min() > 2.0 * radius_m
