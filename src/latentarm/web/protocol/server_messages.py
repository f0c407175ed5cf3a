"""What the server says to pages on the socket ``/drive``: JSON in text frames.

It answers `Hello` with `Welcome`, again whenever what is driven has changed, then `State` up to 50 times a
second to the driver and 30 to watchers, and `Refused` before it closes the connection.
"""

from typing import Literal, final

from latentarm.tasks.steps import StepKind
from latentarm.web.protocol.copilot_messages import CopilotState, Person
from latentarm.web.protocol.notice import Message, Notice, PersonName
from latentarm.web.protocol.orders import BuiltInPose, ModeName
from latentarm.web.protocol.report import ArmState, Point


@final
class NamedGoal(Message):
    """A goal: its name and where the tool is at it, m."""

    name: str
    position: Point


@final
class NamedThing(Message):
    """A thing about the arm: its name and where it is in the beginning, m."""

    name: str
    position: Point


@final
class NamedZone(Message):
    """A zone in which the arm is slow: its name, and the largest speed there, m/s."""

    name: str
    speed: float


@final
class Limits(Message):
    """Limits that a page must know."""

    latch_max_s: float


@final
class FoundFact(Message):
    """Something that was found out about a real arm before it was driven, in English."""

    name: str
    value: str


@final
class RealArm(Message):
    """A real arm.

    Attributes:
        facts: what was found out about it.
    """

    facts: tuple[FoundFact, ...]


@final
class StepToDo(Message):
    """A step of the task.

    Attributes:
        kind: what is done; texts have the key ``task.step.<kind>``.
        thing: name of the thing that it is done to, or where it is done.
    """

    kind: StepKind
    thing: str


@final
class TaskToDo(Message):
    """What is to be done.

    Attributes:
        name: of the task.
        seed: says where things were placed: with another one they are placed otherwise.
        choices: what a person may choose to do: names of things or goals.
        choice: index of what is done in this run.
        steps: in order; empty where nothing counts as done.
    """

    name: str
    seed: int
    choices: tuple[str, ...]
    choice: int
    steps: tuple[StepToDo, ...]


@final
class Welcome(Message):
    """What is driven.

    Attributes:
        id: of this page.
        server: of the running `latentarm teleop`: each start has another one.
        dof: joints of the arm.
        latent_dim: axes of the latent actions; 0 without a run.
        robot: its name.
        run: the run's name, or null.
        profiles: people whose alignment can be chosen.
        modes: how the arm can be steered.
        goals: in the order of the belief.
        things: what stands about the arm, in the order of `State.things`.
        zones: where the arm is slow.
        keep_out: names of what it keeps clear of because a person said so.
        end_effector_modes: names of the pairs of axes.
        limits: see `Limits`.
        gripper_width_m: how wide its gripper opens, m, or null where it has none that can be driven.
        task: see `TaskToDo`.
        real: what is known of the arm where it is a real one; null where it is simulated.
        poses: that the robot has without anybody's saving them.
    """

    type: Literal["welcome"] = "welcome"
    version: Literal[1] = 1
    id: str
    server: str
    dof: int
    latent_dim: int
    robot: str
    run: str | None
    profiles: tuple[str, ...]
    modes: tuple[ModeName, ...]
    goals: tuple[NamedGoal, ...]
    things: tuple[NamedThing, ...]
    zones: tuple[NamedZone, ...]
    keep_out: tuple[str, ...]
    end_effector_modes: tuple[str, ...]
    limits: Limits
    gripper_width_m: float | None
    task: TaskToDo
    real: RealArm | None
    poses: tuple[BuiltInPose, ...]


@final
class RecordingState(Message):
    """See `latentarm.web.protocol.report.Recording`."""

    on: bool
    samples: int
    episodes: int
    problem: Notice | None


@final
class State(ArmState):
    """What the arm does now, and who drives it.

    Attributes:
        bodies: x, y, z, qw, qx, qy, qz in the order of ``/scene.json``, m.
        belief: over the goals; null for a task without goals.
        bound_m: how far from the likeliest goal help lets the tool be, m, to first order; or null.
        driver: id of the page that drives, or null.
        driver_name: what its person is called.
        watchers: how many other pages.
        asking: id of the page that asks to drive, or null.
        asking_name: what its person is called.
        copilot: who may slow the driver down, or null.
        copilot_asking: who asks to be that, or null.
        recording: null where nothing was ever recorded.
        trail: counts how often the trail was emptied.
        you: whether this page drives.
    """

    type: Literal["state"] = "state"
    bodies: tuple[tuple[float, ...], ...]
    belief: tuple[float, ...] | None
    bound_m: float | None
    driver: str | None
    driver_name: PersonName | None
    watchers: int
    asking: str | None
    asking_name: PersonName | None
    copilot: CopilotState | None
    copilot_asking: Person | None
    recording: RecordingState | None
    trail: int
    you: bool


@final
class Poses(Message):
    """The saved poses of a page's person for the robot that is driven.

    Attributes:
        names: in the order in which they were saved.
        problem: why the last one could not be kept, or null.
    """

    type: Literal["poses"] = "poses"
    names: tuple[str, ...]
    problem: Notice | None


@final
class Refused(Message):
    """Why the server closes the connection."""

    type: Literal["refused"] = "refused"
    notice: Notice
