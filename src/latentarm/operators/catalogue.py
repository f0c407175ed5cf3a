"""The simulated operators by name, and the one place that constructs them."""

from typing import Final, Literal

from latentarm.operators.boltzmann import BoltzmannConfig, BoltzmannOperator
from latentarm.operators.foresight import Foresight
from latentarm.operators.operator import Operator
from latentarm.operators.planning import PlanningConfig, PlanningOperator
from latentarm.robots.robot import Robot

OperatorName = Literal["greedy", "planning"]

PLANNING: Final[dict[OperatorName, PlanningConfig | None]] = {"greedy": None, "planning": PlanningConfig()}
"""How far each operator plans: the greedy one of equation 24 looks one step ahead."""


def usual_operator(task: str) -> OperatorName:
    """The operator for a task where none is named.

    Along held-out episodes the greedy operator ends in local dead ends after a few waypoints, whatever the
    model can do, so there the operator plans. Elsewhere it is the paper's.

    Args:
        task: name of the task.
    """
    return "planning" if task == "held_out" else "greedy"


def make_operator(
    robot: Robot,
    config: BoltzmannConfig,
    planning: PlanningConfig | None,
    foresight: Foresight | None,
    period_s: float,
) -> Operator:
    """Construct a simulated operator.

    Args:
        robot: the arm.
        config: how the operator thinks of one step (equation 24).
        planning: how far the operator plans where one step leads no nearer; None never plans.
        foresight: where a greedy operator expects an input to lead; the operator knows the arm where None.
        period_s: time between two inputs, s.
    """
    if planning is None:
        return BoltzmannOperator(robot, config, period_s=period_s, foresight=foresight)
    return PlanningOperator(robot, config, planning, period_s=period_s)
