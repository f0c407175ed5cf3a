"""Messages from the server to pages on the socket ``/drive``: JSON in text frames.

It answers `Hello` with `Welcome`, again whenever the setup has changed, then `State` up to 50 times a second
to the driver and 30 to watchers, and `Refused` before it closes the connection.
"""

from typing import Literal, final

from latentarm.tasks.steps import StepKind
from latentarm.web.protocol.copilot_messages import CopilotState, Person
from latentarm.web.protocol.notice import Message, Notice, PersonName
from latentarm.web.protocol.orders import BuiltInPose, ModeName
from latentarm.web.protocol.report import ArmState, Point


@final
class NamedGoal(Message):
    """A goal: its name and the tool's position at it, m."""

    name: str
    position: Point


@final
class NamedThing(Message):
    """A thing about the arm: its name and its position at the start, m."""

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
    """A fact found out about a real arm before it was driven, in English."""

    name: str
    value: str


@final
class RealArm(Message):
    """A real arm."""

    facts: tuple[FoundFact, ...]


@final
class StepToDo(Message):
    """A step of the task; texts have the key ``task.step.<kind>``."""

    kind: StepKind
    thing: str


@final
class TaskToDo(Message):
    """The task.

    Attributes:
        seed: decides where things are placed.
        choices: names of things or goals to choose from.
        choice: index of the one of this run.
        steps: in order; empty where nothing counts as done.
    """

    name: str
    seed: int
    choices: tuple[str, ...]
    choice: int
    steps: tuple[StepToDo, ...]


@final
class Welcome(Message):
    """The setup that is driven.

    Attributes:
        server: of the running `latentarm teleop`: each start has another one.
        latent_dim: axes of the latent actions; 0 without a run.
        goals: in the order of the belief.
        things: in the order of `State.things`.
        zones: where the arm is slow.
        keep_out: names of obstacles that a person has added.
        end_effector_modes: names of the pairs of axes.
        gripper_width_m: its widest opening, m, or null where no gripper can be driven.
        real: null if the arm is simulated.
        poses: of the robot's model.
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
    """The arm's state, and who drives it.

    Attributes:
        bodies: x, y, z, qw, qx, qy, qz in the order of ``/scene.json``, m.
        belief: over the goals; null for a task without goals.
        bound_m: how far from the likeliest goal help lets the tool be, m, to first order; or null.
        watchers: number of other pages.
        copilot_asking: the person who asks to be the co-pilot, or null.
        recording: null before the first.
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
