"""What steers in `latentarm drive`, who gives inputs, and what the figures depend on."""

from dataclasses import asdict, dataclass, replace
from typing import Final

from latentarm.assistance.assistance import AssistanceRule
from latentarm.assistance.belief import Rule
from latentarm.assistance.blending import ConfidenceAlpha, FixedAlpha
from latentarm.assistance.catalogue import BELIEFS
from latentarm.assistance.controllers.axis_modes import TWO_STICKS
from latentarm.assistance.controllers.contract import Controller
from latentarm.assistance.controllers.end_effector import EndEffectorController
from latentarm.assistance.controllers.latent import latent_controller
from latentarm.assistance.goal_blending import blending
from latentarm.core.errors import UserError
from latentarm.robots.robot import Robot
from latentarm.runs.folder import Run, weights_fingerprint
from latentarm.runs.tasks import usual_arm
from latentarm_research.assistance.published_help import published_assistance, published_belief
from latentarm_research.baselines.retargeting import RetargetingController
from latentarm_research.commands.drive_options import MODE_SWITCHED, DriveOptions
from latentarm_research.people.catalogue import PEOPLE, usual_operator
from latentarm_research.people.names import OperatorName
from latentarm_research.people.person import Person

USUAL_BELIEF: Final = "boltzmann"  # the rule of the belief where none is named


@dataclass(frozen=True, eq=False)
class Steering:
    """Settings that all drives of one command share."""

    config: DriveOptions
    task: str
    robot: Robot
    run: Run | None  # the run that was named, or None
    controller: Controller  # what the operator steers with
    arbitration: FixedAlpha | ConfidenceAlpha | None  # how much the robot helps by equation 2, if it does

    @property
    def arm(self) -> str:
        """What moves."""
        return self.config.arm or usual_arm(self.task)

    @property
    def operator(self) -> OperatorName:
        """Who gives inputs."""
        return self.config.operator or usual_operator(self.task)

    @property
    def person(self) -> Person:
        """The same, as rational as was asked for."""
        person = PEOPLE[self.operator]
        return replace(person, decides=replace(person.decides, beta=self.config.beta))

    @property
    def assistance(self) -> AssistanceRule | None:
        """How the robot helps."""
        if self.config.assistance is not None:
            return published_assistance(self.config.assistance, self.robot)
        return None if self.arbitration is None else blending(self.arbitration)

    @property
    def rule(self) -> Rule:
        """How inputs change the belief."""
        if self.config.assistance is not None and self.config.belief is None:
            return published_belief(self.robot)
        return BELIEFS.find(self.config.belief or USUAL_BELIEF, "--belief")

    @property
    def model(self) -> str | None:
        """The model that steers; None with mode switching."""
        return None if self.run is None or self.config.driver in MODE_SWITCHED else self.run.model

    def about(self, time_limit_s: float) -> dict[str, object]:
        """Settings that the figures depend on."""
        config, robot, run = self.config, self.robot, self.run
        return {
            "study": "drive",
            "run": str(config.run),
            "model": None if run is None or self.model is None else weights_fingerprint(run.folder),
            "controller": config.driver,
            "task": self.task,
            "robot": robot.name,
            "arm": self.arm,
            "end_effector": robot.chain.tools[0].name,
            "limit_sources": {**robot.limits.sources, "tool_speed": robot.tool_speed_source},
            "profile": config.profile,
            "seat": config.seat,
            "drives_per_goal": config.drives,
            "seed": config.seed,
            "operator": "simulated",
            "operator_name": self.operator,
            "beta": config.beta,
            "belief": config.belief or (USUAL_BELIEF if config.assistance is None else "hindsight"),
            "assistance": config.assistance,
            "arbitration": None if self.arbitration is None else config.arbitration or "fixed",
            "alpha": None if self.arbitration is None else asdict(self.arbitration),
            "time_limit_s": time_limit_s,
        }


def steering_of(
    config: DriveOptions,
    run: Run | None,  # the run that was named, or None
    task: str,
    robot: Robot,
) -> Steering:
    """The controller and the arbitration that the options name."""
    arbitration = _arbitration(config)
    return Steering(config, task, robot, run, _controller(config, robot), arbitration)


def _arbitration(config: DriveOptions) -> FixedAlpha | ConfidenceAlpha | None:
    if config.driver != "latent_assist" or config.assistance is not None:
        return None
    if config.arbitration == "confidence":
        return ConfidenceAlpha() if config.alpha is None else ConfidenceAlpha(config.alpha)
    return FixedAlpha() if config.alpha is None else FixedAlpha(config.alpha)


def _controller(config: DriveOptions, robot: Robot) -> Controller:
    if config.driver == "end_effector":
        return EndEffectorController(robot)
    if config.driver == "two_sticks":
        return EndEffectorController(robot, modes=TWO_STICKS)
    if config.driver == "retargeting":
        return RetargetingController(robot)
    if config.run is None:
        raise UserError("Latent actions need a trained run: name one, as in `latentarm drive RUN`.")
    return latent_controller(config.run, config.profile, robot, config.seat)
