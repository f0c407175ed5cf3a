"""Drives by a simulated person who expects other things of their stick."""

import math
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from matplotlib.image import imread

from latentarm.alignment.contract import identity
from latentarm.alignment.demonstrated import demonstrated_motions
from latentarm.assistance.controllers.latent import LatentController
from latentarm.core.context import ContextLayout
from latentarm.core.figure_style import save_figure
from latentarm.core.types import Goal, Pose
from latentarm.robots.catalogue import load_robot
from latentarm.tasks.goal_task import GoalTask
from latentarm.tasks.inverse_kinematics import solve
from latentarm.tasks.table_top import TableTop
from latentarm.tasks.task import Task, within
from latentarm_research.drives.drive import Setup
from latentarm_research.drives.drives import Planned
from latentarm_research.people.expectation import Expectation
from latentarm_research.people.person import Person
from latentarm_research.studies.alignment.drives import (
    DRIVEN,
    HELPED,
    KNOWS,
    AlignedDrive,
    DrivesResult,
    drive,
    drive_all,
)
from latentarm_research.studies.alignment.drives_learning import (
    TURN_RAD,
    AlignedDriveCell,
    Learned,
    learn,
    turned_person,
)
from latentarm_research.studies.alignment.figures import drives_figure
from latentarm_research.studies.alignment.preset import (
    ALL_PRIORS,
    IDEAL,
    NO_ALIGN,
    PRESETS,
    TOOL_SPACE,
    WITHOUT_PRIORS,
    Drives,
)
from latentarm_research.studies.alignment.rows import AlignmentResults
from latentarm_research.studies.alignment.study import STUDY
from latentarm_research.studies.alignment.tables import drives_rows, misses
from latentarm_research.studies.study import Request

PANDA = load_robot("panda")
HERE = PANDA.chain.forward(PANDA.home)
SIDEWAYS = np.array([0.0, 1.0, 0.0])
FORWARD_AND_DOWN = np.array([0.6, 0.0, -0.8])
# Not along the one line in which the turned and mirrored stick is as before.
THERE = Pose(HERE.position - 0.15 * SIDEWAYS + 0.1 * FORWARD_AND_DOWN, HERE.rotation)
TINY = replace(
    PRESETS["smoke"],
    name="small",
    steps=2,
    ideal_steps=2,
    surroundings=40,
    ideal_answers=20,
    test_motions=20,
    drives=Drives(seeds=2, episodes=6, epochs=1, answers=2, to_each_goal=2, limit_s=0.5),
)


class OneGoal(Task):
    """A goal 0.15 m sideways, and 0.1 m forward and down, of the ready pose."""

    name = "one_goal"
    robot = PANDA
    manners = ("come",)
    obstacles = ()

    goals = (Goal("there", solve(PANDA, THERE, PANDA.home), THERE),)

    def sample_start(self, goal, rng):
        return PANDA.home

    def waypoints(self, goal, manner):
        return (self.goals[goal].pose,)

    def reached(self, pose, waypoint):
        return within(pose, waypoint)

    def demonstrate(self, episodes, rng):
        raise NotImplementedError


class TwoDirections:
    """A decoder linear in z: axis 1 moves the tool sideways, axis 2 forward and down, without a turn."""

    layout = ContextLayout(("joints",), joints=7)
    context_dim = 7
    latent_dim = 2

    def decode(self, z, context):
        twist = np.zeros((*z.shape[:-1], 6))
        twist[..., :3] = 0.1 * (z @ np.stack([SIDEWAYS, FORWARD_AND_DOWN]))
        return twist @ np.linalg.pinv(PANDA.chain.jacobian(context)).T


PLAIN = Expectation(PANDA.chain, np.stack([SIDEWAYS, FORWARD_AND_DOWN]), 0.1)
TURNED = PLAIN.turned_and_mirrored(TURN_RAD)


def perfect(u, context):
    """By hand: what `TURNED` means by u, on a stick that is not turned."""
    cos, sin = math.cos(TURN_RAD), math.sin(TURN_RAD)
    return np.stack([cos * u[..., 0] + sin * u[..., 1], sin * u[..., 0] - cos * u[..., 1]], axis=-1)


def driven(alignment, person=TURNED):
    controller = LatentController(TwoDirections(), alignment)
    setup = Setup(GoalTask(OneGoal(), "come", 6.0), controller, Person(imagines=person))
    return drive(OneGoal(), Planned(setup, choice=0, repeat=0, seed=0), 0)


def test_with_a_perfect_alignment_of_a_linear_decoder_the_goal_is_reached_nearly_straight():
    there = driven(perfect)
    assert there.done
    # 0.25 m in all at 0.1 m/s along each axis, the goal 0.03 m wide.
    assert 1.0 < there.reached_s < 4.0


def test_without_alignment_the_same_person_does_not_reach_it_and_another_does():
    assert driven(identity).reached_s is None
    assert driven(identity, PLAIN).reached_s < 4.0


def learned():
    """Two models that are the same, and alignments that differ."""
    alignments = {NO_ALIGN: identity, WITHOUT_PRIORS: identity, ALL_PRIORS: identity}
    alignments |= {TOOL_SPACE: perfect, IDEAL: perfect}
    return Learned(
        model=SimpleNamespace(decoder=lambda seed: TwoDirections()),
        alignments=(alignments, alignments),
        person=TURNED,
        errors={name: np.array([0.5, 0.7]) for name in alignments},
    )


def test_all_conditions_have_the_same_starts_and_chances():
    brief = replace(TINY, drives=replace(TINY.drives, limit_s=0.15))
    cell = AlignedDriveCell(brief, 0)
    every = {condition: drive_all(cell, learned(), condition) for condition in DRIVEN}
    for drives in every.values():
        assert [one.goal for one in drives] == [0, 0, 1, 1, 2, 2]
        assert [one.model_seed for one in drives] == [0, 1, 0, 1, 0, 1]
        starts = np.stack([one.path[0] for one in drives])
        np.testing.assert_array_equal(starts, [one.path[0] for one in every[NO_ALIGN]])
        assert len(np.unique(starts, axis=0)) == len(starts)
    # With the same alignment the whole drive is the same; knowing the arm or help makes another.
    for alike, other in ((WITHOUT_PRIORS, KNOWS), (IDEAL, HELPED)):
        base = NO_ALIGN if alike == WITHOUT_PRIORS else TOOL_SPACE
        for one, same, different in zip(every[base], every[alike], every[other], strict=True):
            np.testing.assert_array_equal(one.path, same.path)
            assert not np.array_equal(one.path, different.path)


def test_another_seed_starts_elsewhere():
    brief = replace(TINY, drives=replace(TINY.drives, to_each_goal=1, limit_s=0.1))
    one, other = (drive_all(AlignedDriveCell(brief, seed), learned(), NO_ALIGN)[0] for seed in (0, 1))
    assert not np.array_equal(one.path[0], other.path[0])


def test_learning_gives_every_condition_its_alignment_and_the_same_figures_again():
    one, again = (learn(AlignedDriveCell(TINY, 3)) for _ in range(2))
    assert list(one.errors) == [NO_ALIGN, WITHOUT_PRIORS, ALL_PRIORS, TOOL_SPACE, IDEAL]
    assert len(one.alignments) == 2
    for name, errors in one.errors.items():
        assert errors.shape == (2,)
        np.testing.assert_array_equal(errors, again.errors[name])
    assert one.alignments[0][NO_ALIGN] is identity
    np.testing.assert_allclose(one.person.directions @ one.person.directions.T, np.eye(2), atol=1e-9)


def test_the_person_expects_the_demonstrated_directions_on_a_turned_and_mirrored_stick():
    task = TableTop()
    chain = task.robot.chain
    motions = demonstrated_motions(
        task.demonstrate(6, np.random.default_rng(0)), 2000, np.random.default_rng(0)
    )
    person = turned_person(motions, chain)
    plain = person.turned_and_mirrored(TURN_RAD)  # turned and mirrored twice is not at all
    moved = chain.forward(motions.end).position - chain.forward(motions.start).position
    kept = np.square(moved @ plain.directions.T).sum(axis=0) / np.square(moved).sum()
    assert kept[0] >= kept[1]
    assert kept.sum() > 0.7
    # Nearly all motions can be asked for without pushing beyond 1.
    assert (np.abs(moved @ plain.directions.T) / (0.5 * plain.speed_m_s) <= 1).all(axis=1).mean() > 0.98


def result(reached):
    """Made-up drives: condition -> how many of the first drives reach their goal, of 6."""
    goals = TableTop().goals

    def made(number, there):
        off = 0.05 * TURNED.directions[0] + 0.02 * np.cross(*TURNED.directions)
        end = goals[number % 3].pose.position + (0.0 if there else off)
        return AlignedDrive(number % 3, number % 2, 0.1 + 0.01 * number if there else None, there, end[None])

    return DrivesResult(
        cell=AlignedDriveCell(TINY, 0),
        drives={
            name: tuple(made(number, number < reached.get(name, 0)) for number in range(6)) for name in DRIVEN
        },
        errors=learned().errors,
        directions=TURNED.directions,
        speed_m_s=0.1,
    )


def test_rows_count_all_the_time_for_a_drive_that_never_gets_there():
    rows = {(row.condition, row.measure): row for row in drives_rows(result({ALL_PRIORS: 3}))}
    assert rows[ALL_PRIORS, "arrival_rate"].mean == pytest.approx(0.5)
    assert rows[ALL_PRIORS, "time_s"].mean == pytest.approx((0.10 + 0.11 + 0.12 + 3 * 0.5) / 6)
    assert rows[NO_ALIGN, "time_s"].mean == pytest.approx(0.5)
    assert rows[ALL_PRIORS, "relative_alignment_error"].n == 2
    assert (KNOWS, "relative_alignment_error") not in rows


def test_misses_are_parted_into_what_the_person_steers_and_what_nobody_does():
    np.testing.assert_allclose(misses(result({NO_ALIGN: 4}), NO_ALIGN), [[0.05, 0.02]] * 2, atol=1e-9)
    assert misses(result({NO_ALIGN: 6}), NO_ALIGN).shape == (0, 2)


def test_the_page_has_the_drives():
    found = result({TOOL_SPACE: 6, WITHOUT_PRIORS: 6, KNOWS: 6})
    page = STUDY.report(Request(Path("out"), TINY, ("table_top",)), AlignmentResults([], [], [], found)).page
    assert "**simulated**" in page
    assert "turned by 60 degrees and mirrored" in page
    assert f"| {TOOL_SPACE} | 0.60 ± 0.14 | 6 of 6 (100%) |" in page
    assert f"| {NO_ALIGN} | 0.60 ± 0.14 | 0 of 6 (0%) | 0.500 | 50, 20 | 0 of 6 (0%) |" in page


def test_the_paths_are_drawn(tmp_path):
    save_figure(drives_figure(result({ALL_PRIORS: 3})), tmp_path / "paths.png")
    pixels = imread(tmp_path / "paths.png")[..., :3]
    blank = (pixels > 0.99).all(axis=(1, 2))
    assert blank.mean() < 0.25, "panels leave much of the figure blank"
