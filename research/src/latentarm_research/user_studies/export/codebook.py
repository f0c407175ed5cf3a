"""The columns of a study's dataset."""

from dataclasses import dataclass
from typing import Final, final

from latentarm.evaluation.measures import MEASURES


@final
@dataclass(frozen=True)
class Variable:
    """A column of the dataset."""

    name: str
    meaning: str
    unit: str = ""  # "" for a name or a number of something


VARIABLES: Final = (
    Variable("person", "number of the person, from 0"),
    Variable("condition", "name of the condition"),
    Variable("task", "name of the task"),
    Variable("order", "place of the condition in the person's order, from 0"),
    Variable("trial", "number of the trial in this condition, from 0"),
    Variable("excluded", "why the trial does not count; empty where it counts"),
    Variable("scale", "name of the questionnaire's scale"),
    Variable("item", "name of the questionnaire's item"),
    Variable("reversed", "1 where agreement means less of what the scale measures, else 0"),
    Variable("points", "points of the answer's scale, from 1 on"),
    Variable("answer", "the answer, from 1 to points"),
    Variable("question", "a question with options, or one that people answer in their own words"),
    Variable("option", "number of an option, from 1"),
    Variable("label", "words of the option"),
    Variable("attention", "1 for the option that everybody chooses who reads the question, else 0"),
    Variable("chosen", "1 where the person chose the option, else 0"),
    Variable("text", "the answer in the person's own words. One that begins with =, +, -, @, an apostrophe"
             " or a control character has an apostrophe before it, so that spreadsheets take it as text:"
             " remove that one"),
    Variable("claim", "number of the claim, from 0"),
    Variable("hypothesis", "name of the hypothesis that the claim belongs to"),
    Variable("measure", "measure or scale that the claim is about"),
    Variable("direction", "what the claim says of the subject: less, greater or equal"),
    Variable("margin", "for equal, the largest difference that does not matter, in the measure's unit"),
    Variable("design", "within: each person meets all conditions; between: each meets one"),
    Variable("kind", "what is named: a condition that the claim is about (subject), one that it is compared"
             " with (against), or a task; without a task, all tasks with the measure"),
    Variable("name", "name of the condition or task"),
    Variable("choice", "number of the choice that the drive was about, from 0"),
    Variable("attempt", "number of earlier drives at this choice in this trial"),
    Variable("ending", "why the drive ended"),
    Variable("episode", "number of the drive's episode in the dataset drives/TASK; empty without steps"),
    Variable("conditions", "names of the conditions that the person drove with, in order, separated by ;"),
    Variable("consent", "SHA-256 of the text that the person consented to; the study's folder has the text as"
             " information-HASH.md, named by the first 12 digits"),
    Variable("consented", "day of the consent, UTC"),
    Variable("browser", "name and version of the browser in the latest check of the device"),
    Variable("width_px", "width of its window", "CSS pixels"),
    Variable("height_px", "height of its window", "CSS pixels"),
    Variable("round_trip_ms", "median time of a message to the server and back in that check", "ms"),
    Variable("jitter_ms", "time by which the 95th percentile of these is above their median", "ms"),
    Variable("device_passed", "1 where the device was good enough for the study, else 0"),
    Variable("comprehension", "number of times that the person answered the questions about the information,"
             " until all answers were right"),
    Variable("practised", "number of conditions that the person practised"),
    Variable("devices", "input devices that were pushed, the longest first, separated by ;: pointer (the"
             " stick on the page) or dpad (its buttons) with mouse, touch or pen; keyboard; gamepad with its"
             " id; switch"),
    Variable("finished", "1 for a person who finished, else 0: without a number, and without trials"),
    Variable("factor", "factor of a 2 x 2 design"),
    Variable("level", "level of the factor, 1 or 2"),
)  # fmt: skip


def variable_of(name: str) -> Variable:
    """The column of a measure."""
    known = MEASURES[name]
    return Variable(name, f"{known.label}: {known.definition}", known.unit)
