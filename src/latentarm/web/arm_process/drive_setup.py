"""The setup of a drive: the task, its modes and their controllers. Both processes use it."""

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from functools import partial
from pathlib import Path
from typing import Any, Final, final

import numpy as np

from latentarm.alignment.contract import Seat
from latentarm.arms.address import MARK, is_address
from latentarm.arms.catalogue import PHYSICAL_ARM, check_named
from latentarm.arms.contract import Arm, SceneArm
from latentarm.assistance.belief import BELIEF_PERIOD_S
from latentarm.assistance.boltzmann import BoltzmannBelief
from latentarm.assistance.controllers.end_effector import EndEffectorController
from latentarm.assistance.controllers.joined import JoinedController
from latentarm.assistance.controllers.latent import latent_controller
from latentarm.assistance.controllers.to_pose import ToPose
from latentarm.assistance.goal_blending import GoalBlending
from latentarm.control.step import Step
from latentarm.core.call_log import CallLog
from latentarm.core.context import BELIEF
from latentarm.core.errors import UserError
from latentarm.core.exact_json import as_text_json
from latentarm.core.journal_limits import JournalLimits
from latentarm.core.types import FloatArray, Pose, Provenance
from latentarm.demonstrations.provenance import provenance_now
from latentarm.recordings.journal_writer import EpisodeHeader
from latentarm.robots.kinematics.obstacles import Box, Obstacle
from latentarm.robots.scene.scene import Scene
from latentarm.robots.scene.thing import Part, Thing
from latentarm.runs.folder import Run, read_run, weights_fingerprint
from latentarm.runs.tasks import usual_arm
from latentarm.safety.config import SafetyConfig
from latentarm.safety.zones import Zone
from latentarm.surroundings.catalogue import SCENE, TOUCH, check_source
from latentarm.tasks.catalogue import HELD_OUT
from latentarm.tasks.place import Place, surroundings_of, watched
from latentarm.web.arm_process.fixed_drive import FixedDrive
from latentarm.web.arm_process.help import Help
from latentarm.web.arm_process.idle_limit import USUAL_MINUTES, idle_s_of
from latentarm.web.arm_process.initial_state import FREE, RobotOptions, begin, begin_real, with_scene
from latentarm.web.arm_process.page_inputs import INPUT_TIMEOUT_S
from latentarm.web.arm_process.speed_limits import Speeds
from latentarm.web.arm_process.task_run import Todo
from latentarm.web.protocol.orders import HelpLevel, ModeName

SEEDS: Final = 2**31

PERIOD_S: Final = 0.01
"""Period of the control loop: 100 Hz, the highest rate at which Python drives a real arm."""

INPUT_GRACE_S: Final = 0.07
"""If the connection drops for no longer than `INPUT_TIMEOUT_S` plus this, the arm slows down and need not be
enabled again."""

RELEASE_FRACTION: Final = 0.8  # as hard as a stop: after letting go the arm is at rest within 0.15 s
MOST_JOINTS: Final = 64
MOST_GOALS: Final = 200  # largest numbers of both that fit into a tick's report
MARKER_M: Final = 0.02  # radius of the ball that stands for a thing of unknown shape
COMMAND_PERIODS: Final = 5.0
"""Periods that a command lasts: a shared computer may hold the loop up for 50 ms before the arm stops."""


@final
@dataclass(frozen=True)
class Spec:
    """The setup to drive, as plain values that can be sent to another process.

    Raises UserError if the seed is out of range, a profile is named without a run, or a simulated arm gets a
    shadow.
    """

    run: Path | None = None  # a trained one; None for end-effector control alone at the table-top task
    profile: str | None = None  # the person whose alignment is used
    seed: int = 0  # for where the arm starts and where things stand
    out: Path = Path("teleop")  # folder for recordings
    journal: JournalLimits = field(default_factory=JournalLimits)
    arm: str | None = None  # as in `DriveSetup`; None for the task's usual one
    task: str | None = None  # a name of `tasks.catalogue`; None for the run's own, or the table-top task
    own_task: bool = False  # whether the run is driven at its own task, if it has one, not at ``task``
    choice: int = 0  # index of what is done first, of the task's choices or goals
    robot: RobotOptions = field(default_factory=RobotOptions)  # used where neither run nor task names one
    found: tuple[tuple[str, str], ...] = ()  # names and values found out about a real arm
    zones: tuple[Zone, ...] = ()  # where the arm is slow
    keep_out: tuple[Obstacle, ...] = ()  # obstacles besides the task's
    gripped: tuple[Box, ...] = ()  # what the gripper holds while it holds no known thing
    speeds: Speeds = field(default_factory=Speeds)  # limits everywhere
    incidents: bool = True  # whether calls are kept for a while, see `latentarm.web.arm_process.incident`
    seat: Seat | None = None  # where a person without a profile sits, see `latent_controller`; None for z = u
    shadow: bool = False  # whether a real arm is read and nothing is sent to it
    idle_s: float = idle_s_of(USUAL_MINUTES)  # without an input for so long, the arm is disabled, s
    objects: tuple[str, ...] = ()  # sources of where things are, see `latentarm.surroundings.catalogue`
    fixed: FixedDrive | None = None  # decides task, controls and help; None leaves them to run, task and page

    def __post_init__(self) -> None:
        if not 0 <= self.seed < SEEDS:
            raise UserError(f"The seed is {self.seed}: it must be from 0 to {SEEDS - 1}.")
        if self.run is None and self.profile is not None:
            raise UserError(
                "A profile belongs to a run: name one, as in `latentarm teleop RUN --profile NAME`."
            )
        for text in self.objects:
            check_source(text)
        if self.shadow and (self.arm is None or not is_address(self.arm)):
            raise UserError("--shadow watches a real arm: name its address with --arm SCHEME://HOST.")

    def with_run(self, run: Path, own_task: bool) -> "Spec":
        """The spec of another run, without a profile, at the first choice of its task."""
        return replace(self, run=run, profile=None, own_task=own_task, choice=0)

    def task_for(self, run: Run | None) -> str | None:
        """The task that is driven with a run, in so far as a name decides it."""
        own = None if run is None else run.task
        return own if self.own_task and own not in (None, HELD_OUT) else self.task or own

    def seated(self, seat: Seat | None) -> Seat | None:
        """The seat after a person says where they sit, or None for nothing; z = u stays."""
        return self.seat and (seat or self.seat)


@final
@dataclass(frozen=True, eq=False)
class DriveSetup:
    """A spec, loaded."""

    spec: Spec
    arm: str  # a name of `latentarm.arms.catalogue` or the address of a real arm
    task: Place
    # all modes: the latent actions first, if there are any, then the pairs of axes of the end-effector
    controller: JoinedController
    latent_dim: int  # d, axes of the latent actions; 0 without a run
    axes: tuple[str, ...]  # names of the pairs of axes of end-effector control
    help: Help
    # (n,), where a simulated arm starts, and where the way back leads, rad; for a real arm where it stood
    # when it was connected
    start: FloatArray
    todo: Todo
    run_fingerprint: str = ""  # of the run's weights; "" without a run
    scene: Scene | None = None  # the things about the arm; None where they do not count
    stand: bool = True  # whether things of a real arm stand as a task says, rather than anywhere

    @property
    def real(self) -> bool:
        """Whether the arm is real: it stays where it is."""
        return is_address(self.arm)

    @property
    def obstacles(self) -> tuple[Obstacle, ...]:
        """The task's obstacles and those of the spec."""
        return (*self.task.obstacles, *self.spec.keep_out)

    @property
    def modes(self) -> tuple[ModeName, ...]:
        """The modes to choose from; without goals there is no help."""
        if self.spec.fixed is not None:
            return ("latent",) if self.latent_dim else ("end_effector",)
        if not self.latent_dim:
            return ("end_effector",)
        return ("latent", "assisted", "end_effector") if self.task.goals else ("latent", "end_effector")

    def first_mode(self, help_: HelpLevel) -> ModeName:
        """The mode at first: latent actions, with help unless it is ``off``."""
        return "assisted" if "assisted" in self.modes and help_ != "off" else self.modes[0]

    @property
    def objects(self) -> tuple[str, ...]:
        """Names of the things that matter for the task; empty if it does not say."""
        return self.task.objects

    @property
    def tracked(self) -> tuple[Thing, ...]:
        """The things whose places come from sources and from people; none where the simulation tells them."""
        if self.scene is None or not (self.real or self.spec.objects):
            return ()
        return self.scene.things if self.real else tuple(self.scene.thing(name) for name in self.objects)

    @property
    def sources(self) -> tuple[str, ...]:
        """Kinds of sources that may say where things are."""
        return tuple(dict.fromkeys((SCENE, TOUCH, *(text.partition(":")[0] for text in self.spec.objects))))

    @property
    def shown(self) -> Scene | None:
        """The scene that pages draw: the one about the arm, else the task's."""
        if self.scene is None:
            return self.task.shown
        # What is followed may be anywhere, whatever a task fixes.
        followed = {thing.name for thing in self.tracked}
        things = (replace(one, fixed=one.fixed and one.name not in followed) for one in self.scene.things)
        return replace(self.scene, things=tuple(things))

    @property
    def settings(self) -> dict[str, Any]:
        """Settings and limits as readable JSON, without names of people and addresses."""
        spec = self.spec
        chosen = ("own_task", "choice", "seed", "seat", "shadow", "idle_s")
        return {
            "arm": self.arm.partition(MARK)[0],
            "task": self.todo.task,
            **{name: getattr(spec, name) for name in chosen},
            "safety": as_text_json(self._safety),
        }

    @property
    def _safety(self) -> SafetyConfig:
        limits = safety_limits(self.spec.speeds)
        return replace(limits, obstacles=self.obstacles, zones=self.spec.zones)

    def mode_index(self, mode: ModeName, axes: int) -> int:
        """Index into the controller's modes; ``axes`` is a pair of axes of end-effector control."""
        return (1 if self.latent_dim else 0) + axes if mode == "end_effector" else 0

    def episode(self, things: tuple[str, ...], controller: str, task: str, person: str) -> EpisodeHeader:
        """The header of an episode that begins now; ``controller``: how the arm is steered, or `BY_HAND`."""
        robot, spec = self.task.robot, self.spec
        return EpisodeHeader(
            robot=robot.name,
            joint_names=robot.joint_names,
            joint_limits=robot.limits,
            rate_hz=1.0 / PERIOD_S,
            task=task,
            goals=self.task.goals,
            modes=self.controller.modes,
            provenance=provenance_now(
                Provenance(
                    person=person,
                    run="" if spec.run is None else spec.run.name,
                    run_fingerprint=self.run_fingerprint,
                    profile=spec.profile or "",
                    controller=controller,
                    task_name="" if self.todo.task in (FREE, HELD_OUT) else self.todo.task,
                    shadow=spec.shadow,
                )
            ),
            end_effector=robot.end_effector,
            limits=robot.stated_limits,
            things=things,
            objects=tuple(name for name in self.objects if name in things),
            sources=self.sources if things else (),
            settings=self.settings,
        )

    @property
    def way_back(self) -> int:
        """Index of the mode after those of the controller: slow motions to a pose."""
        return len(self.controller.modes)

    def to_pose(self) -> ToPose:
        """A controller of slow motions to a pose; to the start at first."""
        return ToPose(self.task.robot, self.start)

    def with_things(self, arm: Arm | None) -> SceneArm | None:
        """The arm, if it was made with the things of this setup; an arm in physics may have none about it."""
        return arm if self.scene is not None and isinstance(arm, SceneArm) else None

    def surroundings(self, arm: Arm | None) -> Callable[[], FloatArray] | None:
        """Where the things are that the controller uses; None for ``arm`` takes their initial poses."""
        objects = self.controller.objects
        if self.scene is None:
            return surroundings_of(self.task.goals, objects)
        if (seen := self.with_things(arm)) is not None:
            return watched(lambda: seen.scene_state().poses, objects)
        begun = {thing.name: thing.pose for thing in self.scene.things}
        return watched(lambda: begun, objects)

    def step(
        self,
        surroundings: Callable[[], FloatArray] | None = None,
        to_pose: ToPose | None = None,
        calls: CallLog | None = None,
    ) -> Step:
        """Algorithm 1 with its safety filters, disengaged; things stand where they begin by default."""
        goals = np.array([goal.configuration for goal in self.task.goals])
        fixed, rule, assists = self.spec.fixed, BoltzmannBelief, partial(GoalBlending, arbitration=self.help)
        if fixed is not None:
            rule, assists = fixed.rule, fixed.assistance
        return Step(
            self.task.robot,
            JoinedController([self.controller, to_pose or self.to_pose()]),
            self._safety,
            goals=self.task.goals,
            belief=rule(goals, period_s=BELIEF_PERIOD_S) if self.task.goals else None,
            assistance=assists(goals) if self.task.goals and assists is not None else None,
            dt_s=PERIOD_S,
            surroundings=surroundings or self.surroundings(None),
            calls=calls,
            follows=not self.spec.shadow,
        )


def safety_limits(speeds: Speeds) -> SafetyConfig:
    """The page's limits, with nothing about the arm."""
    return SafetyConfig(
        joint_speed=speeds.joint,
        link_speed=speeds.link,
        input_timeout_s=INPUT_TIMEOUT_S,
        input_grace_s=INPUT_GRACE_S,
        release_fraction=RELEASE_FRACTION,
        command_periods=COMMAND_PERIODS,
    )


def with_profile(setup: DriveSetup, profile: str | None, seat: Seat | None) -> DriveSetup:
    """The same setup with another alignment and seat; neither dataset nor robot is read again.

    Raises UserError if the profile or the model cannot be used.
    """
    spec = replace(setup.spec, profile=profile, seat=seat)
    if spec.run is None:
        return setup
    robot = setup.task.robot
    latent = latent_controller(spec.run, profile, robot, seat)
    return replace(setup, spec=spec, controller=JoinedController([latent, EndEffectorController(robot)]))


def load_setup(spec: Spec) -> DriveSetup:
    """Load a spec. Raises UserError if a part of it cannot be loaded, or the parts do not fit each other."""
    if spec.fixed is not None:
        return _fixed_setup(spec, spec.fixed)
    run = None if spec.run is None else read_run(spec.run)
    name = spec.task_for(run)
    arm = spec.arm or usual_arm(name)
    check_named(arm)  # so that the error appears where the command was typed
    if is_address(arm):
        begun = begin_real(run, name, spec.choice, spec.robot)
    else:
        begun = begin(run, name, arm, spec.choice, spec.robot, np.random.default_rng(spec.seed))
    task = begun.place
    latent = None if spec.run is None else latent_controller(spec.run, spec.profile, task.robot, spec.seat)
    if task.robot.dof > MOST_JOINTS or len(task.goals) > MOST_GOALS:
        raise UserError(
            f"{spec.run} has {task.robot.dof} joints and {len(task.goals)} goals: the page drives"
            f" {MOST_JOINTS} joints and shows {MOST_GOALS} goals at most."
        )
    end_effector = EndEffectorController(task.robot)
    setup = DriveSetup(
        spec=spec,
        arm=arm,
        task=task,
        controller=JoinedController([end_effector] if latent is None else [latent, end_effector]),
        latent_dim=0 if latent is None else latent.input_dim,
        axes=end_effector.modes,
        help=Help(),
        start=begun.start,
        todo=begun.todo,
        run_fingerprint="" if spec.run is None else weights_fingerprint(spec.run),
        scene=begun.scene,
    )
    if setup.real and run is not None:
        if BELIEF in run.context and not setup.task.goals:
            # Nothing detects goals about a real arm.
            raise UserError(
                f"{run.folder} sees a belief over goals, and nothing sees where they are about a real arm:"
                " train a model that does not, with --context joints."
            )
        setup = _with_markers(setup)
    if spec.objects and not setup.tracked:
        raise UserError(
            "--objects says where the things of a task are, and there are none here: name a task with things"
            " in physics, or a real arm with a run that looks at things."
        )
    missing = set(setup.controller.objects) - {thing.name for thing in setup.tracked}
    if missing and (setup.real or spec.objects):
        raise UserError(
            f"{spec.run} looks at {', '.join(sorted(missing))}, which this task does not have: name the task"
            " that it was trained for with --task."
        )
    setup.step()  # what cannot be driven fails now rather than later
    return setup


def _fixed_setup(spec: Spec, fixed: FixedDrive) -> DriveSetup:
    arm = spec.arm or PHYSICAL_ARM
    check_named(arm)
    begun = with_scene(fixed.task, spec.choice, fixed.begin(), arm)
    controller = fixed.controller()
    setup = DriveSetup(
        spec=spec,
        arm=arm,
        task=begun.place,
        controller=JoinedController([controller]),
        latent_dim=controller.input_dim if fixed.latent else 0,
        axes=() if fixed.latent else controller.modes,
        help=Help(),
        start=begun.start,
        todo=begun.todo,
        scene=begun.scene,
    )
    setup.step()
    return setup


def _with_markers(setup: DriveSetup) -> DriveSetup:
    """The setup with a marker for each thing that the model looks at, where no task knows their shapes."""
    if setup.scene is not None or not setup.controller.objects:
        return setup
    stood = Pose(np.zeros(3), np.eye(3))
    marks = tuple(
        Thing(name, (Part("sphere", (MARKER_M,)),), 0.1, stood) for name in setup.controller.objects
    )
    return replace(setup, scene=Scene(marks), stand=False)
