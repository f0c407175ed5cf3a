"""Messages about a co-pilot: a second person who may slow or stop the arm, with the driver's consent."""

from typing import Annotated, Literal, final

from pydantic import Field

from latentarm.web.protocol.notice import Message, PersonName


@final
class AskToCopilot(Message):
    """A watcher asks to be the driver's co-pilot."""

    type: Literal["ask_to_copilot"]


@final
class AcceptCopilot(Message):
    """The driver accepts the page that has asked; the arm stops, and must be enabled again."""

    type: Literal["accept_copilot"]
    to: Annotated[str, Field(max_length=32)]


@final
class EndCopilot(Message):
    """The driver or the co-pilot ends it, or what was asked; the arm stops where there was one."""

    type: Literal["end_copilot"]


@final
class CopilotPace(Message):
    """What the co-pilot leaves of the driver's speed, 10 times a second: without it the arm stops.

    Attributes:
        pace: share of the driver's speed, in [0, 1].
        nonce: of the newest `State` that the page has seen.
    """

    type: Literal["copilot_pace"]
    pace: Annotated[float, Field(ge=0.0, le=1.0)]
    nonce: Annotated[str, Field(max_length=64)]


CopilotMessage = AskToCopilot | AcceptCopilot | EndCopilot | CopilotPace


@final
class Person(Message):
    """The person at a page.

    Attributes:
        id: of the page.
        name: what they are called.
    """

    id: str
    name: PersonName


@final
class CopilotState(Message):
    """The co-pilot.

    Attributes:
        id: of the page.
        name: what they are called.
        pace: share of the driver's speed that they leave, in [0, 1].
    """

    id: str
    name: PersonName
    pace: float
