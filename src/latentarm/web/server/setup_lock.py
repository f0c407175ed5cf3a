"""Set up, locked by the host: what a person's record says still counts, and nothing else is changed."""

from typing import Final, final

from latentarm.web.arm_process.help import USUAL_HELP
from latentarm.web.protocol import page_messages
from latentarm.web.protocol.learning_messages import PickRun, Train
from latentarm.web.protocol.orders import ChooseHelp, ChooseMode, ChooseProfile
from latentarm.web.protocol.personalise_messages import PersonaliseMessage
from latentarm.web.records.people import People
from latentarm.web.server.states import States

_USUAL_SEAT: Final = "facing"  # of a page whose person has not said otherwise
_NO_PROFILE: Final = "-"  # in the settings of a person who wants none
_WHERE_ALL_IS_FIXED: Final = (
    page_messages.DriverInput,
    page_messages.Press,
    page_messages.HandOver,
    ChooseMode,
)
"""Messages that count in a `latentarm.web.arm_process.fixed_drive.FixedDrive`, beside Stop."""


@final
class SetupLock:
    """Refuses what changes how the arm behaves."""

    def __init__(self, people: People, states: States, *, on: bool) -> None:
        self._people = people
        self._states = states
        self.on = on  # whether the host has locked it

    def refuses(self, person: str | None, message: page_messages.ClientMessage) -> bool:
        """True if a message is refused from the page of this person, an id, or None for a guest."""
        if self._states.loaded.spec.fixed is not None:
            return not isinstance(message, _WHERE_ALL_IS_FIXED)
        if not self.on:
            return False
        known = self._people.find(person)
        settings = {} if known is None else known.settings
        match message:
            case ChooseHelp(level=level):
                return level != settings.get("help", USUAL_HELP)
            case ChooseProfile(name=name, seat=seat):
                report, chosen = self._states.report, settings.get("profile")
                kept = [] if report is None else [report.profile]
                kept += [None if chosen == _NO_PROFILE else chosen] if chosen else []
                return name not in kept or seat not in (None, settings.get("seat", _USUAL_SEAT))
            case page_messages.EditPoses() | PickRun() | Train():
                return True
            case _:
                return isinstance(message, PersonaliseMessage)
