"""Notices to people: a code and parameters, which each language puts into words."""

from contextlib import suppress
from typing import Any, ClassVar, Literal, Self, final

from pydantic import BaseModel, ConfigDict, ValidationError

from latentarm.alignment.contract import Refusal
from latentarm.core.errors import UserError
from latentarm.core.types import Stop, StopCode
from latentarm.core.untrusted.terminal import one_line
from latentarm.web.words.catalogue import DEFAULT, languages

PersonName = str | int  # a guest without a name is called by a number

NoticeCode = Literal[
    Refusal, StopCode, "arm_lost", "arm_process_ended", "arm_process_silent", "arm_stopped", "asking",
    "asking_already", "at_pose", "at_start", "cameras_full", "cameras_gone", "checklist_first",
    "checking_run", "copilot_began", "copilot_changed", "copilot_ended", "copilot_gone", "copilot_late",
    "disk_full", "disk_too_slow", "drive_over", "driver_changed", "driver_expired", "driver_gone",
    "driver_released", "episodes_too_short", "error", "expired", "full", "guiding_ended",
    "guiding_page_gone", "handed_over", "idle", "import_invalid", "journal_full", "journal_lost",
    "journal_unwritable", "joints_unreadable", "latch_ended", "loading_run", "message_invalid",
    "model_unknown", "name_invalid", "no_hello", "no_run", "not_loaded", "page_refused", "page_stopped",
    "path_blocked", "person_driving", "person_name_invalid", "person_name_taken", "person_unknown",
    "pin_needed", "pin_wait", "pin_wrong", "pose_name_invalid", "pose_pushed", "pose_stuck",
    "pose_unreachable", "profile_exists", "question_began", "reconnected", "reconnecting",
    "record_unknown", "record_unreadable", "recording_cut", "recording_ended", "recording_in_use",
    "recording_left_out", "recording_still", "recording_unreadable", "recordings_of_rates",
    "recordings_of_robots", "recordings_of_tasks", "request_invalid", "return_blocked", "return_not_now",
    "return_pushed", "return_stuck", "run_exists", "run_too_slow", "setup_locked", "shadow_stays",
    "stop_first", "stop_pressed", "stop_pressed_by", "thing_lost", "thing_moved", "thing_unseen",
    "too_few_episodes", "too_many_axes", "too_many_people", "too_many_poses", "touch_refused",
    "work_broke_off",
]  # fmt: skip
"""Texts have the key ``notice.<code>``."""


class Message(BaseModel):
    """Base of all messages between processes and pages. Those that are not ``extensible`` are final."""

    model_config = ConfigDict(extra="forbid", frozen=True, strict=True, allow_inf_nan=False)
    extensible: ClassVar[bool] = True

    @classmethod
    def __pydantic_init_subclass__(cls, **kwargs: Any) -> None:
        """Raise TypeError for a subclass of a final message."""
        if not all("extensible" in vars(base) for base in cls.__bases__):
            raise TypeError(f"{cls.__name__} extends a message, which is final")

    @classmethod
    def parse(cls, content: bytes) -> Self | None:
        """Parse a message from JSON; None if it is invalid."""
        with suppress(ValidationError):
            return cls.model_validate_json(content)


class Notice(Message):
    """A notice to a person."""

    code: NoticeCode  # of its text
    # of the text. ``name`` is a `PersonName` where it is a person's. ``because`` is the code of another
    # notice, whose parameters are here too. ``text`` exists only in English, such as the message of an
    # error; pages show it and never parse it.
    parameters: dict[str, str | int] = {}

    @property
    def text(self) -> str:
        """The text in English, for logs, journals and the terminal."""
        words, spoken = languages()[DEFAULT], {**self.parameters}
        if isinstance(name := spoken.get("name"), int):
            spoken["name"] = words.say("driver.guest", {"number": name})
        if "because" in spoken:
            spoken["because"] = words.say(f"notice.{spoken['because']}", spoken)
        return words.say(f"notice.{self.code}", spoken)

    @property
    def unnamed(self) -> str:
        """The same without the name of a person, for what is kept about the arm and sent to others."""
        nobody = {"name": "Somebody"} if "name" in self.parameters else {}
        return self.model_copy(update={"parameters": {**self.parameters, **nobody}}).text


@final
class NoticeError(UserError):
    """A problem that the user can fix, with a text in every language."""

    def __init__(self, code: NoticeCode, **parameters: str | int) -> None:
        self.notice = Notice(code=code, parameters=parameters)
        super().__init__(self.notice.text)


def notice_of(error: Exception) -> Notice:
    """The notice for an error; one that is no `UserError` comes from a file that was loaded."""
    if isinstance(error, NoticeError):
        return error.notice
    if isinstance(error, UserError):
        return sentence(str(error))
    return Notice(code="not_loaded", parameters={"text": one_line(repr(error))})


def notice_of_stop(stop: Stop) -> Notice:
    """The notice for a stop; one without a code is a sentence."""
    if stop.code is None:
        return Notice(code="arm_stopped", parameters={"text": one_line(stop.reason)})
    return Notice(code=stop.code, parameters=dict(stop.parameters))


def sentence(text: str) -> Notice:
    """A notice for a sentence without a code."""
    return Notice(code="error", parameters={"text": one_line(text)})
