"""Messages to the control process: the driver's inputs, and orders.

The server passes the `DriverOrder` of a page on as they are, and makes the others.
"""

from typing import Annotated, ClassVar, Final, Literal

from pydantic import Field, TypeAdapter, ValidationError

from latentarm.alignment.contract import Seat
from latentarm.core.types import GripperAsk
from latentarm.surroundings.touch import TouchKind
from latentarm.web.protocol.notice import Message

ModeName = Literal["latent", "assisted", "end_effector"]
"""``assisted`` is ``latent`` with the robot's help, at a level other than ``off``."""

HelpLevel = Literal["off", "low", "medium", "high"]

BuiltInPose = Literal["home", "tuck"]  # poses that a robot's model states

Deflection = Annotated[float, Field(ge=-1.0, le=1.0)]


class AskedGripper(Message):
    """The driver's last request to the gripper, with the stamps of its input.

    It goes with every later input too, because only the newest input is kept. The stamps make it count once,
    and not at all if its own input was late.
    """

    ask: GripperAsk
    seq: int
    nonce: str


class Paced(Message):
    """The share of the driver's speed that a co-pilot allows."""

    copilot: int  # counts the co-pilots
    pace: Annotated[float, Field(ge=0.0, le=1.0)]
    nonce: str  # the newest that the co-pilot's page had seen: it dates this message


class PersonInput(Message):
    """The part of a person's input that a `DriverInput` and a `Given` have in common."""

    extensible: ClassVar[bool] = True

    seq: Annotated[int, Field(ge=0, le=2**53)]  # grows with every input of a driver
    nonce: Annotated[str, Field(max_length=64)]  # of the newest `State` that the page has seen
    source: Literal["pointer", "keyboard", "dpad", "gamepad", "switch"]
    latched: bool  # continues without being held, for at most `Welcome.latch_max_s`
    device: Annotated[int, Field(ge=0, le=255)] = 0  # number among devices of that kind
    # the browser's id of a gamepad; mouse, touch or pen for a pointer
    name: Annotated[str, Field(max_length=80, pattern=r"^[A-Za-z0-9_ ()./:-]*$")] = ""
    # right and up from the device, before shaping and smoothing; null where they are ``u``
    raw: tuple[Deflection, Deflection] | None = None
    # whether the control is held down that opens the gripper of an arm that is not enabled
    opens: bool = False


class Given(PersonInput):
    """The driver's input."""

    driver: int  # counts the drivers, so that late inputs of the previous one are ignored
    u: tuple[float, ...]  # entries in [-1, 1], one for each axis
    gripper: AskedGripper | None = None  # this driver's newest request; None before the first
    paced: Paced | None = None  # the co-pilot's newest pace; None without a co-pilot


class Enable(Message):
    """Let the arm move, if the driver's input is neutral."""

    type: Literal["enable"] = "enable"
    driver: int  # the driver who asked
    stops: int  # version of the stop slot as the driver knew it: a later Stop wins


class ChooseMode(Message):
    """Steer in another way; ``axes`` is a pair of the end-effector's, None for the one before."""

    type: Literal["mode"] = "mode"
    mode: ModeName
    axes: Annotated[int, Field(ge=0, le=8)] | None = None


class ChooseHelp(Message):
    """Set the level of help with learned motions, at any time; ``off`` is the mode ``latent``."""

    type: Literal["help"] = "help"
    level: HelpLevel


class ChooseProfile(Message):
    """Use a person's alignment, or None for none; only while the arm is disengaged.

    ``seat`` is where they sit, which turns the stick of those without a profile; None for where the person
    before sat.
    """

    type: Literal["profile"] = "profile"
    name: Annotated[str, Field(max_length=64)] | None
    seat: Seat | None = None


class ChooseRun(Message):
    """Drive another run from its start, without an alignment; only while the arm is disengaged."""

    type: Literal["run"] = "run"
    run: str
    own_task: bool  # see `Spec`


class PoseToGoTo(Message):
    """A saved or built-in pose; ``q``: (n,), joint positions, rad."""

    name: str
    q: tuple[float, ...]


class Return(Message):
    """Move the arm slowly to a pose (None for its start), while the stick is let go; or end that."""

    type: Literal["return"] = "return"
    on: bool
    pose: PoseToGoTo | None = None


class Record(Message):
    """Begin an episode, or end it once the arm is at rest."""

    type: Literal["record"] = "record"
    on: bool
    task: str  # in words
    person: str = ""  # who does it; "" if unknown
    by_hand: bool = False  # whether the arm is guided by hand, rather than driven; ignored if it cannot be


class Guide(Message):
    """Let the arm be guided by hand, or end that; only while it is disengaged."""

    type: Literal["guide"] = "guide"
    on: bool
    stops: int  # version of the stop slot as the driver knew it: a later Stop wins


class KeepGuiding(Message):
    """Sent five times a second by the page from which the arm is guided; without it guiding ends.

    ``gripper`` is a request, only in the one message that makes it.
    """

    type: Literal["guided"] = "guided"
    gripper: GripperAsk | None = None


class Reconnect(Message):
    """Make a lost connection to the arm again; it stays disabled, and does not move."""

    type: Literal["reconnect"] = "reconnect"


class TouchThing(Message):
    """A person's word about a thing, with the tool where it stands now."""

    type: Literal["touch"] = "touch"
    thing: Annotated[str, Field(max_length=80)]
    kind: TouchKind


class Reset(Message):
    """Put the simulated arm back to its start; only while it is disengaged."""

    type: Literal["reset"] = "reset"


class BeginTask(Message):
    """Begin a run of the task from its start; only while the arm is disengaged."""

    type: Literal["begin_run"] = "begin_run"
    # index of what is to be done; None for the same again
    choice: Annotated[int, Field(ge=0, le=10_000)] | None = None
    anew: bool  # whether things are placed anew


DriverOrder = (
    ChooseMode | ChooseHelp | ChooseProfile | KeepGuiding | Reconnect | TouchThing | Reset | BeginTask
)
Change = ChooseProfile | ChooseRun | Reset | BeginTask | Reconnect
"""Orders that end the loop, to restart it with another setup."""

Order = DriverOrder | Enable | ChooseRun | Return | Record | Guide
_ORDERS: Final[TypeAdapter[Order]] = TypeAdapter(Annotated[Order, Field(discriminator="type")])


def parse_order(message: bytes) -> Order | None:
    """Parse an order from its pipe; None if it is invalid."""
    try:
        return _ORDERS.validate_json(message)
    except ValidationError:
        return None
