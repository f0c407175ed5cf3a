"""Messages from pages to the server on the socket ``/drive``: JSON in text frames.

The first message is `Hello`. Anything outside this schema ends the connection and stops the arm. The answers
are in `latentarm.web.protocol.server_messages`.
"""

from typing import Annotated, Final, Literal

from pydantic import Field, TypeAdapter

from latentarm.core.types import GripperAsk
from latentarm.web.protocol.learning_messages import PickRun, Train
from latentarm.web.protocol.notice import Message
from latentarm.web.protocol.orders import BuiltInPose, Deflection, DriverOrder, PersonInput
from latentarm.web.protocol.personalise_messages import PersonaliseMessage

FRAME_LIMIT: Final = 4096  # the longest frame from a page, bytes

Name = Annotated[str, Field(max_length=40)]
Id = Annotated[str, Field(max_length=32)]
PoseName = Annotated[str, Field(max_length=80)]


class Hello(Message):
    """A page introduces itself. The first page drives; the others watch until they ask."""

    type: Literal["hello"]
    version: Literal[1]  # of these messages
    name: Name | None = None  # counts only for a person without a record
    person: Id | None = None  # id of their record


class DriverInput(PersonInput):
    """The person's input, 50 times a second while the arm is enabled, including neutral.

    Also while they hold down the control that opens the gripper of an arm that is not enabled. The process
    that owns the arm judges, by its own clock, how long it was held.
    """

    type: Literal["input"]
    # entries in [-1, 1], right and up positive; axes that are not named are zero
    u: Annotated[tuple[Deflection, ...], Field(min_length=1, max_length=8)]
    gripper: GripperAsk | None = None  # a request; only in the one input that makes it


class ConfirmChecklist(Message):
    """A person confirms all points about a real arm. Without this, no ``enable`` of this page counts."""

    type: Literal["confirm"]
    arm_start: int  # of the `State` that they saw; counts only as long as it is the newest
    stop: Literal[True]
    area: Literal[True]
    payload: Literal[True]


class PressStop(Message):
    """Stop the arm, from any page."""

    type: Literal["stop"]
    # a person pressed Stop, or the page can no longer be sure of its person (left, hidden, a control lost,
    # a dialog opened)
    why: Literal["pressed", "page"] = "pressed"


class Press(Message):
    """A press of a button.

    ``enable`` lets the arm move: a fresh neutral input must come within 0.3 s, before or after. ``release``
    lets others drive; ``cancel_training`` ends the training and discards it. These three come from the page
    that drives. ``ask_to_drive`` drives if nobody does, else it asks the driver to hand over;
    ``trail_clear`` empties the trail of the tool on every page.
    """

    type: Literal["enable", "ask_to_drive", "release", "trail_clear", "cancel_training"]


class HandOver(Message):
    """Hand over to the page that has asked to drive, or accept the one that has asked to be the co-pilot.

    The arm stops, and must be enabled again.
    """

    type: Literal["hand_over", "accept_copilot"]
    to: Id


class RecordEpisode(Message):
    """Begin an episode, or end it once the arm is at rest; a change of the driver ends it too.

    ``by_hand``: whether the arm is guided by hand, rather than driven.
    """

    type: Literal["record"]
    on: bool
    task: Annotated[str, Field(max_length=80)] = ""
    by_hand: bool = False


class MotionWithoutStick(Message):
    """Begin or end a motion without the stick.

    ``guide`` lets the arm be guided by hand, while it is not enabled. ``return`` moves it back to its start,
    while it is enabled and the stick is let go: as long as neutral inputs come, until any push or any Stop.
    """

    type: Literal["guide", "return"]
    on: bool


class GoToPose(Message):
    """Move the arm slowly to a pose, as ``return`` does to its start."""

    type: Literal["to_pose"]
    name: PoseName  # of a saved pose; for a built-in one, the page's name of it
    built_in: BuiltInPose | None = None  # one of the robot's own; null for a saved one


class EditPoses(Message):
    """Save where the arm is, while it stands still, in place of a pose of the same name; or delete a pose."""

    type: Literal["save_pose", "delete_pose"]
    name: PoseName


class PressCopilot(Message):
    """A watcher asks to be the driver's co-pilot, who may slow or stop the arm, or one of the two ends that.

    The arm stops if there was a co-pilot.
    """

    type: Literal["ask_to_copilot", "end_copilot"]


class CopilotPace(Message):
    """The share of the driver's speed that the co-pilot allows, 10 times a second, or the arm stops."""

    type: Literal["copilot_pace"]
    pace: Annotated[float, Field(ge=0.0, le=1.0)]
    nonce: Annotated[str, Field(max_length=64)]  # of the newest `State` that the page has seen


ClientMessage = (
    Hello | DriverInput | ConfirmChecklist | Press | PressStop | HandOver | RecordEpisode | MotionWithoutStick
    | GoToPose | EditPoses | Train | PickRun | PersonaliseMessage | PressCopilot | CopilotPace | DriverOrder
)  # fmt: skip
_CLIENT: Final[TypeAdapter[ClientMessage]] = TypeAdapter(
    Annotated[ClientMessage, Field(discriminator="type")]
)


def parse_message(frame: str) -> ClientMessage:
    """Parse a page's message. Raises ValueError, as pydantic's ``ValidationError``, if it is invalid."""
    return _CLIENT.validate_json(frame)
