"""A study as a frozen record: everything that is settled before the first person comes."""

import hashlib
import json
from collections.abc import Mapping
from dataclasses import asdict, dataclass, field
from typing import Any, ClassVar, Final, Literal, final

from latentarm.core.errors import UserError
from latentarm.evaluation.measures import label_of
from latentarm_research.studies.claims import Claim, Hypothesis
from latentarm_research.user_studies.device_limits import DeviceLimits
from latentarm_research.user_studies.exclusion import Exclusion
from latentarm_research.user_studies.hypothesis import Printed
from latentarm_research.user_studies.questionnaire import HIGH, LOW, MultipleChoice, Question, Scale

Controls = Literal["modes", "two_sticks", "retargeting", "latent"]
Assists = Literal["none", "interpolation", "blending"]
Design = Literal["within", "between"]
Aligns = Literal["none", "no_priors", "all_priors"]
PUBLIC_TITLE: Final = "Driving a robot arm"
_LATER: Final[Mapping[str, object]] = {
    "public_title": PUBLIC_TITLE,
    "in_words": (),
    "low": LOW,
    "high": HIGH,
    "slider": False,
    "multiple_choice": (),
    "comprehension": (),
    "comparison": (),
    "device": asdict(DeviceLimits()),
}
"""Defaults of fields that older definitions do not have, whose digests must stay."""
COMPARED: Final = ("this way of driving", "another one")
PREFIX: Final = "user study "  # before a study's name, in what a folder of its results says that it is


@final
@dataclass(frozen=True)
class Condition:
    """A way to drive. Raises a `UserError` where the parts do not go together."""

    name: str
    """Name in tables."""
    about: str
    """Description in words."""
    controls: Controls
    """`modes`: two axes of the end-effector at a time; `two_sticks`: two sticks and a toggle; `retargeting`:
    one stick retargeted to the tool's twist; `latent`: latent actions."""
    model: str = ""
    """Kind of model for latent actions, such as `cvae`; empty for other controls."""
    context: tuple[str, ...] = ()
    """Features that its decoder sees, `joints` first; empty without a model."""
    assists: Assists = "none"
    """`none`; `interpolation`: HARMONIC's, with a fixed weight; `blending`: Algorithm 1 of the paper
    (equations 2 and 3)."""
    weight: float = 0.0
    """Weight of the help, where `assists` is `interpolation`, from 0 to 1."""
    aligns: Aligns = "none"
    """`none`: z = u; `no_priors`: the paper's network f learned from answers alone; `all_priors`: with its
    three priors."""

    def __post_init__(self) -> None:
        latent = self.controls == "latent"
        if latent != bool(self.model) or latent != bool(self.context):
            raise UserError(f"The condition {self.name} needs model and context if it is latent, only then.")
        if not latent and self.aligns != "none":
            raise UserError(f"The condition {self.name} has nothing to align: it is not latent.")
        if not 0.0 <= self.weight <= 1.0:
            raise UserError(f"The weight of the condition {self.name} must be in [0, 1], not {self.weight}.")
        if self.assists != "interpolation" and self.weight:
            raise UserError(f"The condition {self.name} has a weight and does not interpolate.")


@final
@dataclass(frozen=True)
class StudyTask:
    """Trials at one scene."""

    name: str
    """Name in records: at most 40 of a to z, 0 to 9 and _, a letter first."""
    label: str
    """Name in tables."""
    scene: str
    """Name of a task with things, such as `marshmallows`, or `over_marshmallow`."""
    trials: int
    """Trials in each condition, 1 to 1000."""
    choices: tuple[int, ...]
    """Numbers of the scene's choices, from 0, in turn from trial to trial; with `all_choices` each is driven
    in every trial, one after the other."""
    all_choices: bool = False
    """True for trials of all choices in one arrangement, their figures summed."""
    plates: tuple[str, ...] = ()
    """Names of things; *Goal Error* is measured to the closest. Empty where it is not measured."""
    queries: int = 0
    """Motions that people are asked about before the task, where a condition aligns, 0 to 1000."""
    demonstrations_min: float = 0.0
    """Minutes of demonstrations from which its model learns."""
    trained_with: str = ""
    """Name of the task whose model it shares; empty for a model of its own."""
    trial_s: float = 0.0
    """Time for a trial, or for each choice with `all_choices`, up to 3600 s: after a failure everything is
    set up anew and people begin again, until then. 0 is one attempt, with the time limit of the scene's
    task."""


@final
@dataclass(frozen=True)
class Factor:
    """One factor of a factorial design, with two levels."""

    name: str
    """Name in tables."""
    low: tuple[str, tuple[str, ...]]
    """First level, and the conditions that have it."""
    high: tuple[str, tuple[str, ...]]
    """Second level, and the conditions that have it."""


@final
@dataclass(frozen=True)
class Definition:
    """A study. The docs publish this class as a JSON schema."""

    __pydantic_config__: ClassVar[dict[str, object]] = {"use_attribute_docstrings": True, "extra": "forbid"}

    name: str
    """Name on the command line: at most 40 of a to z, 0 to 9 and _, a letter first."""
    title: str
    """Title of its report."""
    section: str
    """Section of the paper; empty for other studies."""
    about: str
    """The question, in a sentence."""
    people: int
    """Number of people, 2 to 1000."""
    papers_people: str
    """The paper's people, in words; empty for other studies."""
    conditions: tuple[Condition, ...]
    """Two or more, in the order of tables."""
    tasks: tuple[StudyTask, ...]
    """One or more, in the order in which people do them."""
    orders: tuple[tuple[str, ...], ...]
    """Orders of all conditions, person by person, repeated as needed; empty for a seeded Williams design,
    and between people."""
    practice_min: float
    """Minutes of practice before each condition, at most, 0 to 1000; 0 for none."""
    input: str
    """Input devices, in words."""
    measures: tuple[str, ...]
    """Names, in the order of tables."""
    questionnaire: tuple[Scale, ...]
    """Scales after each condition."""
    hypotheses: tuple[Hypothesis, ...]
    """Hypotheses with their tests."""
    exclusions: tuple[Exclusion, ...]
    """Rules by which trials do not count."""
    factors: tuple[Factor, ...]
    """Two of a 2 x 2 design, or none."""
    printed: tuple[Printed, ...]
    """Statistics of the paper; empty for other studies."""
    departures: tuple[str, ...]
    """Differences from what the paper did, each a sentence."""
    design: Design = "within"
    """`within`: each person meets every condition, in an order of their own; `between`: one alone."""
    public_title: str = PUBLIC_TITLE
    """Title that participants read until they have finished: it must tell neither conditions nor
    hypotheses."""
    in_words: tuple[Question, ...] = ()
    """Questions after each condition that people answer in their own words, after all others."""
    multiple_choice: tuple[MultipleChoice, ...] = ()
    """Questions with options after each condition, after the scales."""
    comprehension: tuple[MultipleChoice, ...] = ()
    """Questions about the information that people consent to, before the first practice; `attention` is the
    right option of each. Who is wrong reads the information and answers again; how often is recorded."""
    comparison: tuple[Question, ...] = ()
    """Questions after the last condition that people answer by one of the ways of driving that they have met,
    such as which they would use again."""
    device: DeviceLimits = field(default_factory=DeviceLimits)
    """Limits of the check before the first practice. The page says which one a device does not meet, and can
    check it again."""

    def __post_init__(self) -> None:
        in_order = [condition.name for condition in self.conditions]
        names = set(in_order)
        if twice := [name for name in in_order if in_order.count(name) > 1]:
            raise UserError(
                f"The study {self.name} has two conditions of the name {twice[0]}: rename one of them."
            )
        if len(names) < 2:
            raise UserError(f"The study {self.name} needs two conditions or more, not {len(names)}.")
        tasks = {task.name for task in self.tasks}
        known = {*self.measures, *(scale.name for scale in self.questionnaire)}
        for claim in self.claims:
            unknown = {*claim.subject, *claim.against} - names or set(claim.tasks) - tasks
            if unknown or claim.measure not in known:
                missing = ", ".join(sorted(unknown)) or claim.measure
                raise UserError(
                    f"A claim of the study {self.name} is about {missing}, which it does not have."
                )
        for rule in self.exclusions:
            if rule.measure not in self.measures:
                raise UserError(
                    f"An exclusion of the study {self.name} is by {rule.measure}, which it does not measure."
                )
        if self.design == "between" and self.orders:
            raise UserError(
                f"The study {self.name} has orders, but each person meets one condition: leave them empty."
            )
        for order in self.orders:
            if sorted(order) != sorted(names):
                raise UserError(
                    f"An order of the study {self.name} is {', '.join(order) or 'empty'}: it must have each"
                    f" of {', '.join(in_order)} once."
                )
        if self.design == "between" and self.comparison:
            raise UserError(
                f"The study {self.name} has a comparison, and each person meets one condition: leave it out."
            )
        if self.people < 2:
            raise UserError(f"The study {self.name} needs two people or more, not {self.people}.")

    @property
    def study(self) -> str:
        """Its name in rows and folders of results."""
        return f"{PREFIX}{self.name}"

    @property
    def claims(self) -> tuple[Claim, ...]:
        """Of all hypotheses, in order."""
        return tuple(claim for hypothesis in self.hypotheses for claim in hypothesis.claims)

    @property
    def compared(self) -> tuple[MultipleChoice, ...]:
        """The comparison as a question about each condition: chosen or not."""
        return tuple(MultipleChoice(one.name, one.text, COMPARED) for one in self.comparison)

    @property
    def with_options(self) -> tuple[MultipleChoice, ...]:
        """All questions that are answered by options, the comparison included."""
        return (*self.multiple_choice, *self.compared)

    @property
    def scales(self) -> tuple[str, ...]:
        """Names of the questionnaire's scales."""
        return tuple(scale.name for scale in self.questionnaire)

    def condition(self, name: str) -> Condition:
        """The condition of that name."""
        return next(condition for condition in self.conditions if condition.name == name)

    def label(self, measure: str) -> str:
        """The label of a scale of the questionnaire, or of a measure, in tables."""
        return next((scale.label for scale in self.questionnaire if scale.name == measure), label_of(measure))

    def task_label(self, name: str) -> str:
        """The label of a task in tables; any other name as it is."""
        return next((task.label for task in self.tasks if task.name == name), name)

    def as_json(self) -> dict[str, object]:
        """Plain mapping of every field; those of `_LATER` where they differ from it."""
        return json.loads(json.dumps(asdict(self, dict_factory=_fields)))

    @property
    def digest(self) -> str:
        """SHA-256 of every field, in hexadecimal."""
        canonical = json.dumps(self.as_json(), sort_keys=True, separators=(",", ":"), ensure_ascii=False)
        return hashlib.sha256(canonical.encode()).hexdigest()


def _fields(named: list[tuple[str, Any]]) -> dict[str, Any]:
    return {name: value for name, value in named if name not in _LATER or value != _LATER[name]}
