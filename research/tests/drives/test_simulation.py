from typing import Any

import numpy as np
import pytest

from latentarm.assistance.belief import Rule
from latentarm.assistance.blending import Arbitration, ConfidenceAlpha, FixedAlpha
from latentarm.assistance.boltzmann import BoltzmannBelief
from latentarm.assistance.catalogue import BELIEFS
from latentarm.assistance.controllers.contract import Controller
from latentarm.assistance.controllers.end_effector import EndEffectorController
from latentarm.assistance.goal_blending import blending
from latentarm.core.types import Context, FloatArray, Input, StepRecord
from latentarm.robots.catalogue import load_robot
from latentarm.robots.planar import planar
from latentarm.safety.config import SafetyConfig
from latentarm.tasks.goal_task import GoalTask
from latentarm.tasks.reach import Reach
from latentarm.tasks.table_top import TableTop
from latentarm.tasks.task import Task
from latentarm_research.drives.drive import Setup, drive
from latentarm_research.drives.drives import drive_all, plan_drives
from latentarm_research.people.person import Person, SimulatedPerson


def setup(
    task: Task,
    manner: str,
    arbitration: Arbitration | None = None,
    time_limit_s: float = 60.0,
    rule: Rule = BoltzmannBelief,
) -> Setup:
    controller = EndEffectorController(task.robot)
    help_by = None if arbitration is None else blending(arbitration)
    return Setup(GoalTask(task, manner, time_limit_s), controller, Person(), help_by, rule=rule)


def test_mode_switching_reaches_and_stabs() -> None:
    trace = drive(setup(TableTop(), "stab"), 1, np.random.default_rng(0))
    assert trace.figures.success
    assert trace.figures.mode_switches > 0
    # The end of a stab is well below where it began, above the item.
    assert trace.position[-1, 2] < TableTop().goals[1].pose.position[2] - 0.08


def test_time_runs_out() -> None:
    trace = drive(setup(TableTop(), "stab", time_limit_s=1.0), 0, np.random.default_rng(0))
    assert not trace.figures.success
    assert trace.figures.time_s == pytest.approx(1.0)


def test_every_command_keeps_the_limits_and_help_believes_in_the_goal_to_the_end() -> None:
    records: list[StepRecord] = []
    task = TableTop()
    trace = drive(
        setup(task, "scoop", FixedAlpha()), 2, np.random.default_rng(3), record=lambda _: records.append
    )
    assert trace.belief[-1].argmax() == 2
    velocity = np.stack([record.command.velocity for record in records])
    acceleration = np.diff(velocity, axis=0) * 100.0
    assert np.isfinite(velocity).all()
    assert np.abs(velocity).max() <= 0.5 + 1e-9
    assert (np.abs(acceleration) <= 0.8 * task.robot.limits.acceleration + 1e-6).all()
    tool = task.robot.chain.forward(np.stack([record.state for record in records])).position
    assert np.linalg.norm(np.diff(tool, axis=0), axis=1).max() * 100.0 <= 0.25 + 1e-6


@pytest.mark.parametrize(
    ("rule", "arbitration"),
    [*((rule, FixedAlpha()) for rule in BELIEFS.values()), (BoltzmannBelief, ConfidenceAlpha())],
    ids=[*BELIEFS, "with confidence"],
)
def test_every_rule_is_sure_of_the_goal_on_the_way(rule: Rule, arbitration: Arbitration) -> None:
    trace = drive(setup(TableTop(), "stab", arbitration, 8.0, rule), 2, np.random.default_rng(0))
    assert trace.belief[0] == pytest.approx(1 / 3)
    assert trace.belief[:, 2].max() > max(0.5, *trace.belief[:, :2].max(axis=0))
    assert trace.belief.sum(axis=1) == pytest.approx(1.0)


def test_processes_change_nothing() -> None:
    task = Reach(load_robot("planar"))
    planned = plan_drives([[setup(task, "reach", time_limit_s=2.0)]], 2, seed=7)
    (alone,), (beside,) = (drive_all([planned], jobs) for jobs in (1, 2))
    for one, other in zip(alone, beside, strict=True):
        np.testing.assert_array_equal(one.position, other.position)


def test_another_seed_is_another_drive() -> None:
    task = Reach(load_robot("planar"))
    setups = [[setup(task, "reach", time_limit_s=0.1)]]
    one, other = (plan_drives(setups, 1, seed)[0].drive() for seed in (0, 1))
    assert not np.array_equal(one.position[0], other.position[0])


class TooFast(Controller):
    """An axis for each joint, twenty times as fast as the loop lets it be."""

    @property
    def modes(self) -> tuple[str, ...]:
        return ("only",)

    @property
    def input_dim(self) -> int:
        return 2

    def latent(self, u: FloatArray, context: Context, mode: int) -> FloatArray:
        return u

    def action(self, z: FloatArray, context: Context, mode: int) -> FloatArray:
        return 10.0 * z


def test_nobody_gives_a_push_that_the_loop_takes_for_rest(monkeypatch: pytest.MonkeyPatch) -> None:
    given: list[float] = []
    act = SimulatedPerson.act

    def watched(self: SimulatedPerson, *seen: Any) -> Input:
        meant = act(self, *seen)
        given.append(float(np.linalg.norm(meant.u)))
        return meant

    monkeypatch.setattr(SimulatedPerson, "act", watched)
    way = Setup(GoalTask(Reach(planar(2)), "reach", 15.0), TooFast(), Person())
    drive_all([plan_drives([[way]], 1, seed=0)], 1)
    lengths = np.array(given)
    assert (lengths > 0).any()
    assert lengths[lengths > 0].min() > SafetyConfig().dead_zone
