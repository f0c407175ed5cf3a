"""A study as a frozen record: everything that is settled before the first person comes."""

import hashlib
import json
from dataclasses import asdict, dataclass
from typing import Final, Literal, final

from latentarm.core.errors import UserError
from latentarm.evaluation.measures import label_of
from latentarm_research.studies.claims import Claim, Hypothesis
from latentarm_research.user_studies.exclusion import Exclusion
from latentarm_research.user_studies.hypothesis import Printed
from latentarm_research.user_studies.questionnaire import Scale

Controls = Literal["modes", "two_sticks", "retargeting", "latent"]
"""Two axes of the end-effector at a time; two sticks and a toggle; one stick retargeted to the tool's twist;
latent actions."""

Assists = Literal["none", "interpolation", "blending"]
"""Nobody; HARMONIC's interpolation with a fixed weight; Algorithm 1 of the paper (equations 2 and 3)."""

Design = Literal["within", "between"]
"""Each person meets every condition, in an order of their own; or one condition alone."""

Aligns = Literal["none", "no_priors", "all_priors"]
"""z = u; the paper's network f learned from answers alone; and with its three priors."""


PREFIX: Final = "user study "  # before a study's name, in what a folder of its results says that it is


@final
@dataclass(frozen=True)
class Condition:
    """What people drive with. Raises a `UserError` where the parts do not go together."""

    name: str  # as tables call it
    about: str  # in words
    controls: Controls  # what turns their input into motion
    model: str = ""  # a name of `latentarm.models.catalogue.KINDS`; empty without latent actions
    context: tuple[str, ...] = ()  # features that its decoder sees
    assists: Assists = "none"  # who helps
    weight: float = 0.0  # of the help, where `assists` interpolates, in [0, 1]
    aligns: Aligns = "none"  # what stands between input and latent action

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
    """What people do."""

    name: str  # in records
    label: str  # as tables call it
    scene: str  # a name that `latentarm_research.user_studies.scenes.scene_of` knows
    trials: int  # in each condition
    # of the scene's task, in turn from trial to trial; each is driven in every trial where `all_choices` is
    # set, one after the other
    choices: tuple[int, ...]
    all_choices: bool = False  # whether a trial is all choices in one arrangement, its figures summed
    # things to the closest of which *Goal Error* is measured; empty where it is not measured
    plates: tuple[str, ...] = ()
    queries: int = 0  # motions that people are asked about before it, where a condition aligns
    demonstrations_min: float = 0.0  # minutes of demonstrations from which its model learns
    trained_with: str = ""  # name of the task whose model it shares; its own where empty
    # how long people have for a trial, or for each choice where `all_choices` is set, s: after a failure
    # everything is set up anew and they begin again, until then. 0 is one attempt, with the time limit of the
    # scene's task
    trial_s: float = 0.0


@final
@dataclass(frozen=True)
class Factor:
    """One factor of a factorial design, with two levels."""

    name: str  # as tables call it
    low: tuple[str, tuple[str, ...]]  # its first level and the conditions that have it
    high: tuple[str, tuple[str, ...]]  # its second


@final
@dataclass(frozen=True)
class Definition:
    """A study."""

    name: str  # on the command line
    title: str  # of its page
    section: str  # of the paper
    about: str  # what is asked, in a sentence
    people: int  # how many go through it
    papers_people: str  # who went through the paper's, in words
    conditions: tuple[Condition, ...]  # in the order of tables
    tasks: tuple[StudyTask, ...]  # in the order in which people do them
    # of the conditions, person by person, repeated as needed; a seeded Williams design where empty
    orders: tuple[tuple[str, ...], ...]
    practice_min: float  # minutes of practice at most
    practice: str  # when they practise, in words
    input: str  # what people hold, in words
    measures: tuple[str, ...]  # by name, in the order of tables
    questionnaire: tuple[Scale, ...]  # after each condition
    hypotheses: tuple[Hypothesis, ...]  # with their tests
    exclusions: tuple[Exclusion, ...]  # what does not count
    factors: tuple[Factor, ...]  # two of a 2 x 2 design, or none
    printed: tuple[Printed, ...]  # statistics of the paper
    departures: tuple[str, ...]  # where this definition differs from what the paper did, each a sentence
    design: Design = "within"  # whether a person meets all conditions or one

    def __post_init__(self) -> None:
        names = {condition.name for condition in self.conditions}
        if len(names) < len(self.conditions) or len(names) < 2:
            raise UserError(
                f"The study {self.name} needs two conditions or more, each with a name of its own."
            )
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
            if len(set(order)) < len(order) or not set(order) <= names:
                raise UserError(f"An order of the study {self.name} must name its conditions, each once.")
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
        """Plain mapping of every field."""
        return json.loads(json.dumps(asdict(self)))

    @property
    def digest(self) -> str:
        """SHA-256 of every field, in hexadecimal."""
        canonical = json.dumps(self.as_json(), sort_keys=True, separators=(",", ":"), ensure_ascii=False)
        return hashlib.sha256(canonical.encode()).hexdigest()
