"""How full cups and bowls are is told where something is poured."""

import numpy as np
import pytest

from latentarm.core.types import Pose
from latentarm.robots.scene.scene import SceneState
from latentarm.tasks.catalogue import SCENE_TASKS, make_scene_task
from latentarm.tasks.predicates import Poured
from latentarm.web.arm_process.fill_level import SETTLES_S, FillLevels, vessels

NONE = frozenset()
HERE = Pose(np.zeros(3), np.eye(3))


@pytest.fixture(scope="module")
def begun():
    return make_scene_task("pour").begin(0, np.random.default_rng(0))


def state_of(scene, grains):
    poses = {thing.name: thing.pose for thing in scene.things}
    return SceneState(0.0, HERE, poses, {}, NONE, NONE, NONE, {"grains": grains}, {})


def test_a_cup_that_is_shared_is_full_at_first_and_each_bowl_says_how_much_is_enough(begun):
    found = vessels(begun)
    grains = begun.scene.grains[0].positions
    fills = FillLevels(found)
    fills.see(state_of(begun.scene, grains), 0.0)
    assert [(one.thing, one.share, one.enough) for one in fills.now] == [
        ("cup", 1.0, None),
        ("left bowl", 0.0, 0.2),
        ("right bowl", 0.0, 0.2),
    ]


def test_what_is_told_to_be_enough_is_what_the_step_asks_for(begun):
    grains = begun.scene.grains[0].positions.copy()
    bowl = begun.scene.thing("left bowl")
    fills = FillLevels(vessels(begun))
    (poured,) = (step.done for step in begun.steps if step.kind == "poured" and step.thing == "left bowl")
    for count in range(len(grains) + 1):
        grains[:count] = bowl.pose.position + np.array([0.0, 0.0, bowl.room.bottom_m + 0.005])
        state = state_of(begun.scene, grains)
        fills.see(state, 0.0)
        cup, fill, _ = fills.now
        assert fill.share == pytest.approx(count / len(grains), abs=0.001)
        assert poured(state) == (count / len(grains) >= fill.enough)
        assert cup.share + fill.share == pytest.approx(1.0, abs=0.002)


def test_a_cup_that_is_emptied_into_one_of_two_bowls_is_told_once_nothing_falls_any_more(begun):
    grains = begun.scene.grains[0].positions.copy()
    full = state_of(begun.scene, grains.copy())
    grains[:] = begun.scene.thing("left bowl").pose.position + np.array([0.0, 0.0, 0.3])
    falling = state_of(begun.scene, grains)
    fills = FillLevels(vessels(begun))
    told = []
    for time_s, state in (
        (0.0, full),
        (5.0, full),
        (5.1, falling),
        (5.9, falling),
        (5.0 + SETTLES_S, falling),
    ):
        fills.see(state, time_s)
        told.append(fills.short)
    assert told == [False, False, False, False, True]


@pytest.mark.parametrize("name", SCENE_TASKS)
def test_every_pouring_is_told(name):
    task = make_scene_task(name)
    for choice in range(len(task.choices)):
        begun = task.begin(choice, np.random.default_rng(0))
        into = {step.done.container for step in begun.steps if isinstance(step.done, Poured)}
        told = {one.name for one in vessels(begun) if one.enough is not None}
        assert told == into
        assert len(vessels(begun)) == len(into) + bool(into)
