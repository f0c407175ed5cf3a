"""Messages between the page's server and the control process, and how they travel.

Neither ever waits for the other. Inputs and reports are latest-wins; a stop has a separate slot, so that it
arrives however full the pipe of orders is. Nothing is unpickled: everything is JSON of a strict schema.
"""

from dataclasses import dataclass
from multiprocessing.connection import Connection
from typing import Annotated, Final, Literal, final

from pydantic import Field, TypeAdapter, ValidationError

from latentarm.tasks.mishap import MishapKind
from latentarm.types import GripperAsk
from latentarm.web.protocol.notice import Message, Notice
from latentarm.web.protocol.shared_memory import Flag, LatestSlot

ORDER_LIMIT: Final = 4096
"""The longest order, bytes; short enough that the pipe takes it whole or not at all."""

_REPORT_LIMIT: Final = 262144
_GIVEN_LIMIT: Final = 1024
_REASON_LIMIT: Final = 512

ModeName = Literal["latent", "assisted", "end_effector"]
"""``assisted`` is ``latent`` with the robot's help, at a level other than ``off``."""

HelpLevel = Literal["off", "low", "medium", "high"]
HeldBack = Literal["clearance", "freshness", "workspace", "joint_position"]
Phase = Literal["disengaged", "neutral_needed", "ready", "moving", "stopping"]
Point = tuple[float, float, float]
PoseRow = tuple[float, float, float, float, float, float, float]
"""x, y, z (m) and a quaternion w, x, y, z."""


@final
class AskedGripper(Message):
    """What the driver last asked of the gripper, with the stamps of the input that it came with.

    It goes with every later input too, because only the newest input is kept. The stamps make it count once,
    and not at all where its own input came too late.

    Attributes:
        ask: what is asked.
        seq: of that input.
        nonce: that it echoed.
    """

    ask: GripperAsk
    seq: int
    nonce: str


@final
class Paced(Message):
    """What a driver's co-pilot leaves of the driver's speed.

    Attributes:
        copilot: counts the co-pilots.
        pace: share of the driver's speed, in [0, 1].
        nonce: the newest that the co-pilot's page had seen: it says how old this is.
    """

    copilot: int
    pace: Annotated[float, Field(ge=0.0, le=1.0)]
    nonce: str


@final
class Given(Message):
    """The driver's input.

    Attributes:
        driver: counts the drivers, so that late inputs of the previous one are ignored.
        seq: grows with every input of a driver.
        nonce: the newest that their page has seen.
        u: entries in [-1, 1].
        latched: continues without being held, for a limited time.
        source: with what kind of device.
        gripper: the newest thing that this driver has asked of the gripper; None before the first.
        paced: the newest that the driver's co-pilot has said; None without a co-pilot.
    """

    driver: int
    seq: int
    nonce: str
    u: tuple[float, ...]
    latched: bool
    source: str = ""
    gripper: AskedGripper | None = None
    paced: Paced | None = None


@final
class Enable(Message):
    """Let the arm move, if the driver's input is neutral.

    Attributes:
        driver: who asked.
        stops: version of the stop slot as the driver knew it: a later Stop wins.
    """

    order: Literal["enable"] = "enable"
    driver: int
    stops: int


@final
class ChooseMode(Message):
    """Steer in another way; ``axes`` is which pair of the end-effector's, None for the one before."""

    order: Literal["mode"] = "mode"
    mode: ModeName
    axes: int | None


@final
class ChooseHelp(Message):
    """How much the robot helps with learned motions; ``off`` is the mode ``latent``."""

    order: Literal["help"] = "help"
    level: HelpLevel


@final
class ChooseProfile(Message):
    """Take another person's alignment, or None for z = u; only while the arm stands disengaged."""

    order: Literal["profile"] = "profile"
    name: str | None


@final
class ChooseRun(Message):
    """Drive another run from its start, without anybody's alignment; only while the arm stands disengaged."""

    order: Literal["run"] = "run"
    run: str


@final
class Return(Message):
    """Move the arm back to its start, while it is enabled and the stick is let go; or end that."""

    order: Literal["return"] = "return"
    on: bool


@final
class Record(Message):
    """Begin an episode of what is driven, or end it once the arm is at rest."""

    order: Literal["record"] = "record"
    on: bool
    task: str
    person: str = ""


@final
class Reset(Message):
    """Put the simulated arm back to its start; only while it stands disengaged."""

    order: Literal["reset"] = "reset"


@final
class BeginTask(Message):
    """Begin a run of the task from its start; only while the arm stands disengaged.

    Attributes:
        choice: index of what is to be done; None for the same again.
        anew: whether things are placed anew; else they stand where they stood in the beginning.
    """

    order: Literal["begin"] = "begin"
    choice: int | None
    anew: bool


Order = Enable | ChooseMode | ChooseHelp | ChooseProfile | ChooseRun | Return | Record | Reset | BeginTask
_ORDERS: Final[TypeAdapter[Order]] = TypeAdapter(Annotated[Order, Field(discriminator="order")])


@final
class Ghosts(Message):
    """Where each full deflection would take the tool over the next second: points, m."""

    up: tuple[Point, ...]
    down: tuple[Point, ...]
    left: tuple[Point, ...]
    right: tuple[Point, ...]


@final
class Recording(Message):
    """A recording under way or done.

    Attributes:
        on: whether an episode is under way.
        samples: of this episode so far.
        episodes: whole ones in the journal.
        problem: why the last episode was broken off, or None.
        journal: its path.
    """

    on: bool
    samples: int
    episodes: int
    problem: Notice | None
    journal: str


@final
class GripperState(Message):
    """The gripper.

    Attributes:
        width_m: opening between the fingers, m.
        holding: whether something is held between them.
        closing: whether it was last told to close; None if it was told nothing yet.
    """

    width_m: float
    holding: bool
    closing: bool | None


@final
class Things(Message):
    """Where things and grains are, in the order of ``/scene.json``.

    Attributes:
        poses: of the things.
        grains: for each kind, x, y, z of one grain after the other, m.
    """

    poses: tuple[PoseRow, ...]
    grains: tuple[tuple[float, ...], ...]


@final
class Why(Message):
    """Why a run of a task has failed.

    Attributes:
        code: what went wrong.
        thing: name of the thing, or of the grains, that it happened to.
    """

    code: MishapKind
    thing: str


@final
class TaskState(Message):
    """How far a run of the task has come.

    Attributes:
        choice: index of what is to be done.
        done: how many of its steps have been done.
        outcome: null while it goes on.
        why: why it has failed.
        time_s: since the arm was first enabled in this run, until its outcome, s.
    """

    choice: int
    done: int
    outcome: Literal["success", "failure"] | None
    why: Why | None
    time_s: float


@final
class Report(Message):
    """Report of the control process in every tick.

    Attributes:
        nonce: for the driver to echo.
        tick: grows.
        time_s: the control process's clock.
        driver: whose inputs it takes.
        phase: ``disengaged``, ``neutral_needed`` (the stick must be let go), ``ready`` (enabled and standing
            still), ``moving``, ``stopping``.
        note: shown for a while instead of what the arm does; None for nothing.
        reason: why the arm may not move; None if it may.
        held_back: why it moves slower than asked; None if it does not.
        returning: whether it is on its way back to its start.
        at_start: whether it is there.
        let_go_first: whether the stick does something else by now: it must be let go before it moves the arm.
        late_stops: how often the arm has stopped because no input came in time, since this driver began to
            drive this.
        mode: how the arm is steered.
        axes: which pair of the end-effector's axes.
        help: how much the robot helps with learned motions; None where it cannot.
        run: path of the run that is driven, as it was named; None without one.
        seed: says where things were placed and where the arm started.
        profile: whose alignment.
        loading: whether something else is being loaded; there are no further reports until it is.
        q: (n,), joint positions as they were last read, rad.
        speed: the fastest joint's, rad/s.
        tool: the tool's position, m.
        gripper: as it was last read; None without one.
        task: how far it has come.
        things: where they are, sent in every few reports; None in the others and in an empty scene.
        ghosts: what each direction would do now.
        belief: over the goals; empty where there are none.
        alpha: how much the robot helps.
        bound_rad: the radius of equation 14, where there is help.
        recording: where something is recorded.
        late_share: share of the loop's deadlines that were missed.
        late_p99_ms: 99th percentile of the time from a tick's due time until its command was sent.
    """

    nonce: str
    tick: int
    time_s: float
    driver: int
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
    run: str | None
    seed: int
    profile: str | None
    loading: bool
    q: tuple[float, ...]
    speed: float
    tool: Point
    gripper: GripperState | None
    task: TaskState
    things: Things | None
    ghosts: Ghosts | None
    belief: tuple[float, ...]
    alpha: float
    bound_rad: float | None
    recording: Recording | None
    late_share: float
    late_p99_ms: float


@final
@dataclass(frozen=True)
class Channel:
    """The control process's side.

    Attributes:
        given: the newest input.
        report: the newest report.
        stop: the newest reason to stop, a `Notice`; every new one stops the arm.
        ending: raised to make the control process bring the arm to rest and end.
        orders: everything else; bounded, so that a slow reader loses orders and never blocks the writer.
    """

    given: LatestSlot
    report: LatestSlot
    stop: LatestSlot
    ending: Flag
    orders: Connection

    def read_orders(self, most: int) -> list[Order]:
        """Orders that have arrived, oldest first; invalid ones are skipped.

        Raises:
            EOFError: the other side is gone.
        """
        found: list[Order] = []
        while len(found) < most and self.orders.poll(0):
            try:
                found.append(_ORDERS.validate_json(self.orders.recv_bytes(ORDER_LIMIT)))
            except ValidationError:
                continue
            except OSError as error:
                raise EOFError from error
        return found


def new_channel(orders: Connection) -> Channel:
    """Slots and flags for a new control process that reads its orders from ``orders``."""
    return Channel(
        given=LatestSlot(_GIVEN_LIMIT),
        report=LatestSlot(_REPORT_LIMIT),
        stop=LatestSlot(_REASON_LIMIT),
        ending=Flag(),
        orders=orders,
    )


def parse_given(message: bytes) -> Given | None:
    """Parse an input from its slot; None if it is invalid."""
    try:
        return Given.model_validate_json(message)
    except ValidationError:
        return None


def parse_stop(message: bytes) -> Notice:
    """Parse a reason to stop from its slot; anything there is a reason to stop."""
    try:
        return Notice.model_validate_json(message)
    except ValidationError:
        return Notice(code="stop_pressed")


def parse_report(message: bytes) -> Report | None:
    """Parse a report from its slot; None if it is invalid."""
    try:
        return Report.model_validate_json(message)
    except ValidationError:
        return None
