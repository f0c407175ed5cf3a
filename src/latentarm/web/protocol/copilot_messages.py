"""Messages about a co-pilot: a second person who may slow or stop the arm, with the driver's consent."""

from typing import Annotated, Literal, final

from pydantic import Field

from latentarm.web.protocol.notice import Message, PersonName


@final
class PressCopilot(Message):
    """A watcher asks to be the driver's co-pilot, or one of the two ends the role or the request.

    The arm stops if there was a co-pilot.
    """

    type: Literal["ask_to_copilot", "end_copilot"]


@final
class CopilotPace(Message):
    """The share of the driver's speed that the co-pilot allows, 10 times a second, or the arm stops."""

    type: Literal["copilot_pace"]
    pace: Annotated[float, Field(ge=0.0, le=1.0)]
    nonce: Annotated[str, Field(max_length=64)]  # of the newest `State` that the page has seen


CopilotMessage = PressCopilot | CopilotPace


@final
class Person(Message):
    """The person at a page; ``id`` is the page's."""

    id: str
    name: PersonName


@final
class CopilotState(Message):
    """The co-pilot; ``id`` is the page's."""

    id: str
    name: PersonName
    pace: float  # share of the driver's speed that they allow, in [0, 1]
