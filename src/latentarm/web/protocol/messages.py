"""Messages between pages and the server on the socket ``/drive``: JSON in text frames.

The first message is `Hello`. Anything outside this schema ends the connection and stops the arm. The server
answers with `Welcome`, again whenever what is driven has changed, then `State` up to 50 times a second to
the driver and 30 to watchers, and `Refused` before it closes the connection.
"""

from typing import Annotated, Final, Literal, final

from pydantic import Field, TypeAdapter

from latentarm.tasks.steps import StepKind
from latentarm.types import GripperAsk
from latentarm.web.protocol.channel import (
    Ghosts,
    GripperState,
    HeldBack,
    HelpLevel,
    ModeName,
    Phase,
    Point,
    TaskState,
    Things,
)
from latentarm.web.protocol.copilot_messages import CopilotMessage, CopilotState, Person
from latentarm.web.protocol.learning_messages import CancelTraining, PickRun, Train
from latentarm.web.protocol.notice import Message, Notice, PersonName
from latentarm.web.protocol.personalise_messages import PersonaliseMessage

VERSION: Final = 1
FRAME_LIMIT: Final = 4096
"""The longest frame from a page, bytes."""

Name = Annotated[str, Field(max_length=40)]
Id = Annotated[str, Field(max_length=32)]
Deflection = Annotated[float, Field(ge=-1.0, le=1.0)]


@final
class Hello(Message):
    """A page introduces itself. The first page drives; the others watch until they ask.

    Attributes:
        version: of these messages.
        name: what its person wants to be called; counts only where they have no record.
        person: id of their record.
    """

    type: Literal["hello"]
    version: Literal[1]
    name: Name | None = None
    person: Id | None = None


@final
class DriverInput(Message):
    """The person's input, 50 times a second while the arm is enabled, including neutral.

    Attributes:
        seq: grows.
        nonce: of the newest `State` that the page has seen.
        u: entries in [-1, 1], right and up positive; axes that are not named are zero.
        source: with what.
        latched: continues without being held, for at most `Limits.latch_max_s`.
        gripper: what is asked of the gripper with this input; only in the one input that asks.
    """

    type: Literal["input"]
    seq: Annotated[int, Field(ge=0, le=2**53)]
    nonce: Annotated[str, Field(max_length=64)]
    u: Annotated[tuple[Deflection, ...], Field(min_length=1, max_length=8)]
    source: Literal["pointer", "keyboard", "dpad", "gamepad", "switch"]
    latched: bool
    gripper: GripperAsk | None = None


@final
class PressEnable(Message):
    """Let the arm move. A fresh neutral input must come within 0.3 s, before or after."""

    type: Literal["enable"]


@final
class PressStop(Message):
    """Stop the arm, from any page.

    Attributes:
        why: a person pressed Stop, or the page could not be sure of its person any more (left, hidden, a
            control lost, a dialog opened).
    """

    type: Literal["stop"]
    why: Literal["pressed", "page"] = "pressed"


@final
class Mode(Message):
    """Steer in another way; at any time."""

    type: Literal["mode"]
    mode: ModeName
    axes: Annotated[int, Field(ge=0, le=8)] | None = None


@final
class HelpFromRobot(Message):
    """How much the robot helps with learned motions; at any time."""

    type: Literal["help"]
    level: HelpLevel


@final
class Profile(Message):
    """Use a person's alignment, or null for none; while the arm is not enabled."""

    type: Literal["profile"]
    name: Annotated[str, Field(max_length=64)] | None


@final
class AskToDrive(Message):
    """Drive if nobody does, else ask the driver to hand over."""

    type: Literal["ask_to_drive"]


@final
class HandOver(Message):
    """Hand over to the page that has asked to drive."""

    type: Literal["hand_over"]
    to: Id


@final
class Release(Message):
    """Let others drive."""

    type: Literal["release"]


@final
class TrailClear(Message):
    """Empty the trail of the tool on every page."""

    type: Literal["trail_clear"]


@final
class RecordEpisode(Message):
    """Begin an episode, or end it once the arm is at rest; a change of the driver ends it too."""

    type: Literal["record"]
    on: bool
    task: Annotated[str, Field(max_length=80)] = ""


@final
class ReturnArm(Message):
    """Move the arm back to its start, while it is enabled and the stick is let go; or end that.

    It goes on as long as neutral inputs come; any push ends it, and Stop, as always.
    """

    type: Literal["return"]
    on: bool


@final
class ResetArm(Message):
    """Put the simulated arm back to its start; while it is not enabled."""

    type: Literal["reset"]


@final
class BeginRun(Message):
    """Begin the task from its start, while the arm is not enabled.

    Attributes:
        choice: index of what is to be done; null for the same again.
        anew: whether things are placed anew.
    """

    type: Literal["begin_run"]
    choice: Annotated[int, Field(ge=0, le=10_000)] | None = None
    anew: bool


ClientMessage = (
    Hello
    | DriverInput
    | PressEnable
    | PressStop
    | Mode
    | HelpFromRobot
    | Profile
    | AskToDrive
    | HandOver
    | Release
    | TrailClear
    | RecordEpisode
    | ReturnArm
    | ResetArm
    | BeginRun
    | Train
    | CancelTraining
    | PickRun
    | PersonaliseMessage
    | CopilotMessage
)
_CLIENT: Final[TypeAdapter[ClientMessage]] = TypeAdapter(
    Annotated[ClientMessage, Field(discriminator="type")]
)


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
class Limits(Message):
    """Limits that a page must know."""

    latch_max_s: float


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
        dof: joints of the arm.
        latent_dim: axes of the latent actions; 0 without a run.
        robot: its name.
        run: the run's name, or null.
        profiles: people whose alignment can be chosen.
        modes: how the arm can be steered.
        goals: in the order of the belief.
        things: what stands about the arm, in the order of `State.things`.
        end_effector_modes: names of the pairs of axes.
        limits: see `Limits`.
        gripper_width_m: how wide its gripper opens, m, or null where it has none that can be driven.
        task: see `TaskToDo`.
    """

    type: Literal["welcome"] = "welcome"
    version: Literal[1] = 1
    id: str
    dof: int
    latent_dim: int
    robot: str
    run: str | None
    profiles: tuple[str, ...]
    modes: tuple[ModeName, ...]
    goals: tuple[NamedGoal, ...]
    things: tuple[NamedThing, ...]
    end_effector_modes: tuple[str, ...]
    limits: Limits
    gripper_width_m: float | None
    task: TaskToDo


@final
class RecordingState(Message):
    """See `latentarm.web.protocol.channel.Recording`."""

    on: bool
    samples: int
    episodes: int
    problem: Notice | None


@final
class State(Message):
    """What the arm does now.

    Attributes:
        nonce: to be echoed by the next input.
        tick: grows.
        phase: see `latentarm.web.protocol.channel.Report`.
        note: shown instead of the arm's state, or null.
        reason: why the arm may not move, or null if it may.
        held_back: why it moves slower than asked, or null.
        returning: whether it moves back to its start.
        at_start: whether it is there.
        let_go_first: whether the stick does something else by now: it must be let go before it moves the arm.
        late_stops: how often the arm has stopped in this drive because no input came in time.
        mode: how the arm is steered.
        axes: which pair of the end-effector's.
        help: how much the robot helps with learned motions, or null where it cannot.
        profile: whose alignment.
        bodies: x, y, z, qw, qx, qy, qz in the order of ``/scene.json``, m.
        tool: m.
        gripper: null where it has none, or before it was read.
        task: how far it has come.
        things: where they are; null if the scene has no things, or nothing has moved since the last.
        ghosts: where each direction would take the tool; null if nothing has moved by 1 mm since the last.
        belief: over the goals, or null where there are none.
        alpha: how much the robot helps, in [0, 1].
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
        late_share: share of the control loop's deadlines that were missed.
        you: whether this page drives.
    """

    type: Literal["state"] = "state"
    nonce: str
    tick: int
    phase: Phase
    note: Notice | None
    reason: Notice | None
    held_back: HeldBack | None
    returning: bool
    at_start: bool
    let_go_first: bool
    late_stops: int
    mode: ModeName
    axes: int
    help: HelpLevel | None
    profile: str | None
    bodies: tuple[tuple[float, ...], ...]
    tool: Point
    gripper: GripperState | None
    task: TaskState
    things: Things | None
    ghosts: Ghosts | None
    belief: tuple[float, ...] | None
    alpha: float
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
    late_share: float
    you: bool


@final
class Refused(Message):
    """Why the server closes the connection."""

    type: Literal["refused"] = "refused"
    notice: Notice


def parse_message(frame: str) -> ClientMessage:
    """Parse a page's message.

    Raises:
        ValueError: the text is not a valid message (as pydantic's ``ValidationError``).
    """
    return _CLIENT.validate_json(frame)
