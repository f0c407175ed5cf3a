"""Notices to people, as sent: a code and its parameters, which each language puts into words."""

from typing import Literal, final

from pydantic import BaseModel, ConfigDict

from latentarm.errors import UserError
from latentarm.untrusted.terminal import one_line
from latentarm.web.words.catalogue import DEFAULT, languages

NoticeCode = Literal[
    "arm_process_ended",
    "arm_process_silent",
    "arm_stopped",
    "at_start",
    "asking",
    "asking_already",
    "checking_run",
    "copilot_began",
    "copilot_changed",
    "copilot_ended",
    "copilot_gone",
    "copilot_late",
    "disk_too_slow",
    "driver_changed",
    "driver_expired",
    "driver_gone",
    "driver_released",
    "episodes_too_short",
    "error",
    "expired",
    "full",
    "handed_over",
    "import_invalid",
    "input_late",
    "joints_unreadable",
    "latch_ended",
    "let_go_first",
    "loading_run",
    "loop_late",
    "message_invalid",
    "model_unknown",
    "name_invalid",
    "no_hello",
    "no_run",
    "not_enabled",
    "nothing_recorded",
    "page_refused",
    "page_stopped",
    "person_driving",
    "person_name_invalid",
    "person_name_taken",
    "person_unknown",
    "profile_exists",
    "question_began",
    "record_unknown",
    "recording_ended",
    "return_not_now",
    "return_pushed",
    "return_stuck",
    "recording_in_use",
    "request_invalid",
    "run_exists",
    "run_too_slow",
    "stop_first",
    "stop_pressed",
    "stop_pressed_by",
    "too_few_episodes",
    "too_many_axes",
    "too_many_people",
    "work_broke_off",
]
"""Texts have the key ``notice.<code>``."""


class Message(BaseModel):
    """Base of all messages between processes and pages."""

    model_config = ConfigDict(extra="forbid", frozen=True, strict=True, allow_inf_nan=False)


@final
class Notice(Message):
    """A notice to a person.

    Attributes:
        code: which text it is. ``arm_stopped`` and ``error`` carry an English sentence in their parameter
            ``text``; pages show it and never look into it.
        parameters: what the text names.
    """

    code: NoticeCode
    parameters: dict[str, str | int] = {}

    @property
    def text(self) -> str:
        """The text in English, for logs, journals and the terminal."""
        return languages()[DEFAULT].say(f"notice.{self.code}", self.parameters)


@final
class NoticeError(UserError):
    """A problem that the user can fix, which every language has words for.

    Args:
        code: of the notice.
        parameters: of the notice.
    """

    def __init__(self, code: NoticeCode, **parameters: str | int) -> None:
        self.notice = Notice(code=code, parameters=parameters)
        super().__init__(self.notice.text)


def notice_of(error: UserError) -> Notice:
    """The notice for an error."""
    return error.notice if isinstance(error, NoticeError) else sentence(str(error))


def sentence(text: str) -> Notice:
    """A notice for a sentence without a code."""
    return Notice(code="error", parameters={"text": one_line(text)})
