import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from latentarm.assistance.annotation import annotate
from latentarm.core.errors import UserError
from latentarm.core.types import Pose
from latentarm.robots.kinematics.obstacles import HalfSpace
from latentarm.robots.kinematics.rotations import angle_between
from latentarm.tasks.table_top import HOVER, ITEMS, TABLE_HEIGHT

PAIRS = [(goal, manner) for goal in range(3) for manner in ("stab", "scoop")]


def lowest_points(robot, states):
    """Height of the lowest point of the moving arm, (T,), m."""
    start, end = robot.capsules.placed(robot.chain, robot.chain.link_transforms(states))
    moving = robot.capsules.link >= 0
    return (np.minimum(start[..., 2], end[..., 2]) - robot.capsules.radius)[:, moving].min(axis=1)


def test_goals_are_upright_above_the_items_and_well_apart(table_top):
    positions = np.stack([goal.pose.position for goal in table_top.goals])
    assert [goal.name for goal in table_top.goals] == list(ITEMS)
    assert positions[:, :2] == pytest.approx(np.array(list(ITEMS.values())), abs=1e-3)
    for goal in table_top.goals:
        assert goal.pose.rotation[:, 2] == pytest.approx([0.0, 0.0, -1.0], abs=1e-3)
        placed = table_top.robot.chain.forward(goal.configuration)
        assert placed.position == pytest.approx(goal.pose.position, abs=1e-12)
    apart = np.linalg.norm(positions[:, None] - positions, axis=-1)[np.triu_indices(3, 1)]
    assert apart.min() > 0.25


def test_goals_share_one_posture(table_top):
    home = table_top.robot.home
    for goal in table_top.goals:
        assert np.abs(goal.configuration[1:] - home[1:]).max() < 1.2
        assert goal.configuration[4] == pytest.approx(0.0, abs=0.2)


def test_stabbing_goes_straight_down_and_scooping_ends_low_and_tilted(table_top):
    for goal in range(3):
        above, stabbed = table_top.waypoints(goal, "stab")
        assert above.position - stabbed.position == pytest.approx([0.0, 0.0, HOVER], abs=1e-3)
        assert angle_between(above.rotation, stabbed.rotation) < 1e-3
        above, scooped = table_top.waypoints(goal, "scoop")
        assert above.position[2] - scooped.position[2] == pytest.approx(HOVER, abs=1e-3)
        assert angle_between(above.rotation, scooped.rotation) > 0.4


@pytest.mark.parametrize(("away", "turn", "there"), [(0.029, 19, True), (0.031, 0, False), (0.0, 21, False)])
def test_a_waypoint_is_reached_within_3_cm_and_20_degrees(table_top, away, turn, there):
    waypoint = table_top.goals[0].pose
    moved = Pose(
        waypoint.position + np.array([0.0, away, 0.0]),
        Rotation.from_euler("x", turn, degrees=True).as_matrix() @ waypoint.rotation,
    )
    assert table_top.reached(moved, waypoint) is there


def test_every_demonstration_does_what_it_says(table_top, shown):
    chain = table_top.robot.chain
    for index, episode in enumerate(shown.episodes):
        goal, manner = PAIRS[index % 3 * 2 + index // 3 % 2]
        assert episode.task == f"{manner} the {table_top.goals[goal].name}"
        above, end = table_top.waypoints(goal, manner)
        poses = [chain.forward(state) for state in episode.state]
        reached = [table_top.reached(pose, above) for pose in poses]
        assert any(reached)
        assert table_top.reached(poses[-1], end)


def test_all_goals_and_manners_are_shown_alike(shown):
    tasks = [episode.task for episode in shown.episodes]
    assert {tasks.count(task) for task in tasks} == {10}
    assert len(set(tasks)) == 6


def test_demonstrations_can_be_driven_along_within_the_default_safety_limits(table_top, shown):
    robot = table_top.robot
    for episode in shown.episodes:
        dt = np.diff(episode.timestamp)[:, None]
        assert dt == pytest.approx(1 / shown.rate_hz)
        assert np.abs(np.diff(episode.state, axis=0) / dt).max() < 0.5
        transforms = robot.chain.link_transforms(episode.state)
        for points in robot.capsules.placed(robot.chain, transforms):
            assert (np.linalg.norm(np.diff(points, axis=0), axis=-1) / dt).max() < 0.25
        limits = robot.limits
        assert np.minimum(episode.state - limits.lower, limits.upper - episode.state).min() > 0.1
        assert lowest_points(robot, episode.state).min() > TABLE_HEIGHT + 0.03


def test_the_table_is_an_obstacle(table_top):
    (table,) = table_top.obstacles
    assert isinstance(table, HalfSpace)
    assert table.point[2] == TABLE_HEIGHT


def test_motion_is_smooth_like_a_hand_without_tremor(shown):
    for episode in shown.episodes:
        velocity = np.diff(episode.state, axis=0) * shown.rate_hz
        jump = np.abs(np.diff(velocity, axis=0)).max()
        assert jump < 0.15
        power = (np.abs(np.fft.rfft(velocity, axis=0)) ** 2).sum(axis=1)
        frequency = np.fft.rfftfreq(len(velocity), 1 / shown.rate_hz)
        assert power[frequency > 4.0].sum() < 0.02 * power.sum()


def test_no_two_demonstrations_are_the_same(shown):
    alike = [episode for episode in shown.episodes if episode.task == shown.episodes[0].task]
    assert len({len(episode.state) for episode in alike}) > 3
    starts = np.stack([episode.state[0] for episode in alike])
    assert (starts.std(axis=0) > 0.01).all()
    ends = np.stack([episode.state[-1] for episode in alike])
    assert (ends.std(axis=0) > 0.001).all()


def test_the_same_seed_gives_the_same_demonstrations(table_top):
    once, again = (table_top.demonstrate(4, np.random.default_rng(5)) for _ in range(2))
    for a, b in zip(once.episodes, again.episodes, strict=True):
        assert np.array_equal(a.state, b.state)


def test_along_a_demonstration_the_belief_finds_the_goal_and_stays(shown):
    ends = [episode.extras["belief"][-1] for episode in annotate(shown).episodes]
    wanted = [index % 3 for index in range(len(ends))]
    assert np.argmax(ends, axis=1).tolist() == wanted
    assert np.mean([end[goal] for end, goal in zip(ends, wanted, strict=True)]) > 0.9


@pytest.mark.parametrize(("goal", "manner"), [(3, "stab"), (-1, "stab"), (0, "fry")])
def test_what_is_not_on_the_table_is_refused(table_top, goal, manner):
    with pytest.raises(UserError):
        table_top.waypoints(goal, manner)
