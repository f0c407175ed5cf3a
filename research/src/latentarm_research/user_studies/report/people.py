"""People's input, practice and consent in words, as they were in the run that is reported."""

from latentarm.evaluation.table import ABSENT
from latentarm_research.user_studies.drive_record import devices_of
from latentarm_research.user_studies.recorded import Recorded


def input_words(recorded: Recorded) -> str:
    """The devices that people held; as planned where that is not recorded."""
    if recorded.participants:
        return "each person's own choice on the page, made in the first practice"
    planned = recorded.definition.input
    return planned if recorded.people_are == "simulated" else f"planned: {planned}"


def practice_words(recorded: Recorded) -> str:
    """The practice before trials, as it was carried out; as planned where that is not recorded."""
    minutes = recorded.definition.practice_min
    if recorded.people_are == "simulated":
        return f"{minutes:g} minutes, before each condition at each task" if minutes else "none"
    if not recorded.participants:
        return f"planned for up to {minutes:g} minutes before each condition" if minutes else "none planned"
    from latentarm_research.user_studies.serving.way import FIRST_PRACTICE_S  # with SQLAlchemy

    task = recorded.definition.tasks[0].label
    when = "before each condition" if minutes else "before the first condition only"
    return f"up to {minutes or FIRST_PRACTICE_S / 60.0:g} minutes at {task}, {when}"


def participant_lines(recorded: Recorded) -> list[tuple[str, str, str]]:
    """Everybody who has finished a served study: number, conditions in order, input devices."""
    return [
        (str(one.number), ", ".join(one.conditions), ", ".join(devices_of(one.drives)) or ABSENT)
        for one in recorded.participants
        if one.finished
    ]


def consent_words(recorded: Recorded) -> str:
    """The number of people who consented, when and to what; empty where that is not recorded."""
    people = recorded.participants
    if not people:
        return ""
    days = sorted(one.consented[:10] for one in people)
    texts = ", ".join(sorted({one.consent[:12] for one in people}))
    when = days[0] if days[0] == days[-1] else f"{days[0]} to {days[-1]}"
    finished = sum(one.finished for one in people)
    at_once = sum(one.comprehension[:1] == (True,) for one in people)
    short = sum(not one.device_passed for one in people if one.device)
    understood = f"{at_once} answered all questions about it right at the first try. "
    return (
        f"{len(people)} consented ({when}; text {texts}), and {finished} of them finished."
        f"{f' The device of {short} fell short.' if short else ''}"
        f" {understood if recorded.definition.comprehension else ''}People who were deleted do not count."
        " Besides browser, window, inputs and the delay of the connection, nothing else about the people was"
        " recorded."
    )
