"""Messages from the page's server to the control process: the driver's inputs, and orders."""

from typing import Annotated, Final, Literal, final

from pydantic import Field, TypeAdapter, ValidationError

from latentarm.alignment.contract import Seat
from latentarm.core.types import GripperAsk
from latentarm.web.protocol.notice import Message

ModeName = Literal["latent", "assisted", "end_effector"]
"""``assisted`` is ``latent`` with the robot's help, at a level other than ``off``."""

HelpLevel = Literal["off", "low", "medium", "high"]

BuiltInPose = Literal["home", "tuck"]  # poses that a robot's model states


@final
class AskedGripper(Message):
    """The driver's last request to the gripper, with the stamps of its input.

    It goes with every later input too, because only the newest input is kept. The stamps make it count once,
    and not at all if its own input was late.
    """

    ask: GripperAsk
    seq: int
    nonce: str


@final
class Paced(Message):
    """The share of the driver's speed that a co-pilot allows."""

    copilot: int  # counts the co-pilots
    pace: Annotated[float, Field(ge=0.0, le=1.0)]
    nonce: str  # the newest that the co-pilot's page had seen: it dates this message


@final
class Given(Message):
    """The driver's input."""

    driver: int  # counts the drivers, so that late inputs of the previous one are ignored
    seq: int  # grows with every input of a driver
    nonce: str  # the newest that their page has seen
    u: tuple[float, ...]  # entries in [-1, 1]
    latched: bool  # continues without being held, for a limited time
    source: str = ""  # kind of device
    device: int = 0  # number among devices of that kind
    raw: tuple[float, ...] | None = None  # the device's own values; None where they are ``u``
    gripper: AskedGripper | None = None  # this driver's newest request; None before the first
    paced: Paced | None = None  # the co-pilot's newest pace; None without a co-pilot
    # whether the control is held down that opens the gripper of an arm that is not enabled
    opens: bool = False


@final
class Enable(Message):
    """Let the arm move, if the driver's input is neutral."""

    order: Literal["enable"] = "enable"
    driver: int  # the driver who asked
    stops: int  # version of the stop slot as the driver knew it: a later Stop wins


@final
class ChooseMode(Message):
    """Steer in another way; ``axes`` is a pair of the end-effector's, None for the one before."""

    order: Literal["mode"] = "mode"
    mode: ModeName
    axes: int | None


@final
class ChooseHelp(Message):
    """Set the level of help with learned motions; ``off`` is the mode ``latent``."""

    order: Literal["help"] = "help"
    level: HelpLevel


@final
class ChooseProfile(Message):
    """Use a person's alignment, or None for none; only while the arm is disengaged.

    ``seat`` is None for where the person before sat.
    """

    order: Literal["profile"] = "profile"
    name: str | None
    seat: Seat | None = None


@final
class ChooseRun(Message):
    """Drive another run from its start, without an alignment; only while the arm is disengaged."""

    order: Literal["run"] = "run"
    run: str


@final
class PoseToGoTo(Message):
    """A saved or built-in pose; ``q``: (n,), joint positions, rad."""

    name: str
    q: tuple[float, ...]


@final
class Return(Message):
    """Move the arm slowly to a pose (None for its start), while the stick is let go; or end that."""

    order: Literal["return"] = "return"
    on: bool
    pose: PoseToGoTo | None = None


@final
class Record(Message):
    """Begin an episode, or end it once the arm is at rest."""

    order: Literal["record"] = "record"
    on: bool
    task: str  # in words
    person: str = ""  # who does it; "" if unknown
    by_hand: bool = False  # whether the arm is guided by hand, rather than driven; ignored if it cannot be


@final
class Guide(Message):
    """Let the arm be guided by hand, or end that; only while it is disengaged."""

    order: Literal["guide"] = "guide"
    on: bool
    stops: int  # version of the stop slot as the driver knew it: a later Stop wins


@final
class KeepGuiding(Message):
    """The page from which the arm is guided is still there; ``gripper`` is a request, or None."""

    order: Literal["keep_guiding"] = "keep_guiding"
    gripper: GripperAsk | None = None


@final
class Reconnect(Message):
    """Make a lost connection to the arm again; it stays disabled."""

    order: Literal["reconnect"] = "reconnect"


@final
class Reset(Message):
    """Put the simulated arm back to its start; only while it is disengaged."""

    order: Literal["reset"] = "reset"


@final
class BeginTask(Message):
    """Begin a run of the task from its start; only while the arm is disengaged."""

    order: Literal["begin"] = "begin"
    choice: int | None  # index of what is to be done; None for the same again
    anew: bool  # whether things are placed anew


Order = (
    Enable
    | ChooseMode
    | ChooseHelp
    | ChooseProfile
    | ChooseRun
    | Return
    | Record
    | Guide
    | KeepGuiding
    | Reconnect
    | Reset
    | BeginTask
)
_ORDERS: Final[TypeAdapter[Order]] = TypeAdapter(Annotated[Order, Field(discriminator="order")])


def parse_order(message: bytes) -> Order | None:
    """Parse an order from its pipe; None if it is invalid."""
    try:
        return _ORDERS.validate_json(message)
    except ValidationError:
        return None


def parse_given(message: bytes) -> Given | None:
    """Parse an input from its slot; None if it is invalid."""
    try:
        return Given.model_validate_json(message)
    except ValidationError:
        return None
