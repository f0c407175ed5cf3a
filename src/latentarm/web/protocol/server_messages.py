"""Messages from the server to pages on the socket ``/drive``: JSON in text frames.

It answers `Hello` with `Welcome`, again whenever the setup has changed, then `State` up to 50 times a second
to the driver and 30 to watchers, and `Refused` before it closes the connection.
"""

from typing import Literal

from latentarm.tasks.steps import StepKind
from latentarm.web.protocol.notice import Message, Notice, PersonName
from latentarm.web.protocol.orders import BuiltInPose, ModeName
from latentarm.web.protocol.report import ArmState, Point


class NamedPlace(Message):
    """A goal with the tool's position there, or a thing with its position at the start, m."""

    name: str
    position: Point


class NamedZone(Message):
    """A zone in which the arm is slow: its name, and the largest speed there, m/s."""

    name: str
    speed: float


class RealArm(Message):
    """A real arm."""

    facts: tuple[tuple[str, str], ...]  # names and values, found out before it was driven, in English
    shadow: bool  # whether it is only read, and nothing is sent to it


class StepToDo(Message):
    """A step of the task; texts have the key ``task.step.<kind>``."""

    kind: StepKind
    thing: str


class TaskToDo(Message):
    """The task."""

    name: str
    seed: int  # decides where things are placed
    choices: tuple[str, ...]  # names of things or goals to choose from
    choice: int  # index of the one of this run
    steps: tuple[StepToDo, ...]  # in order; empty where nothing counts as done


class Welcome(Message):
    """The setup that is driven."""

    type: Literal["welcome"] = "welcome"
    version: Literal[1] = 1
    id: str
    server: str  # of the running `latentarm teleop`: each start has another one
    dof: int
    latent_dim: int  # axes of the latent actions; 0 without a run
    robot: str
    run: str | None
    profiles: tuple[str, ...]
    modes: tuple[ModeName, ...]
    goals: tuple[NamedPlace, ...]  # in the order of the belief
    things: tuple[NamedPlace, ...]  # in the order of `State.things`
    zones: tuple[NamedZone, ...]  # where the arm is slow
    keep_out: tuple[str, ...]  # names of obstacles that a person has added
    end_effector_modes: tuple[str, ...]  # names of the pairs of axes
    latch_max_s: float  # how long a latched deflection counts, s
    gripper_width_m: float | None  # its widest opening, m, or null where no gripper can be driven
    task: TaskToDo
    real: RealArm | None  # null if the arm is simulated
    poses: tuple[BuiltInPose, ...]  # of the robot's model


class Person(Message):
    """The person at a page; ``id`` is the page's."""

    id: str
    name: PersonName


class CopilotState(Message):
    """The co-pilot; ``id`` is the page's."""

    id: str
    name: PersonName
    pace: float  # share of the driver's speed that they allow, in [0, 1]


class State(ArmState):
    """The arm's state, and who drives it."""

    type: Literal["state"] = "state"
    bodies: tuple[tuple[float, ...], ...]  # x, y, z, qw, qx, qy, qz in the order of ``/scene.json``, m
    belief: tuple[float, ...] | None  # over the goals; null for a task without goals
    driver: str | None
    driver_name: PersonName | None
    watchers: int  # number of other pages
    asking: str | None
    asking_name: PersonName | None
    copilot: CopilotState | None
    copilot_asking: Person | None  # the person who asks to be the co-pilot, or null
    trail: int  # counts how often the trail was emptied
    arm_start: int  # counts how often the connection to the arm was lost; see `ConfirmChecklist`
    you: bool  # whether this page drives


class Poses(Message):
    """The saved poses of a page's person for the robot that is driven."""

    type: Literal["poses"] = "poses"
    names: tuple[str, ...]  # in the order in which they were saved
    problem: Notice | None  # why the last one could not be kept, or null


class Refused(Message):
    """Why the server closes the connection."""

    type: Literal["refused"] = "refused"
    notice: Notice
