"""A person's way through a study: what comes next follows from what is kept of them."""

from dataclasses import dataclass
from functools import cache
from typing import Final, Literal, final

from latentarm.tasks.scene_task import SceneTask
from latentarm_research.studies.streams import generator, integer, sequence
from latentarm_research.user_studies.answers.items import names_of, sheet
from latentarm_research.user_studies.definition import Condition, Definition
from latentarm_research.user_studies.designs import design_of
from latentarm_research.user_studies.drive_record import DriveRecord
from latentarm_research.user_studies.scenes import scene_of
from latentarm_research.user_studies.serving.page_drive import ToDrive
from latentarm_research.user_studies.serving.store import Standing
from latentarm_research.user_studies.session import choices_of, left_for
from latentarm_research.user_studies.sizes import Sizes, Stream

FIRST_PRACTICE_S: Final = (
    300.0  # of the first practice where the definition has none, in which people set up, s
)


@final
@dataclass(frozen=True)
class ToAnswer:
    """The questionnaire is due; ``items`` are names of items in this person's order."""

    condition: Condition
    order: int
    items: tuple[str, ...]


Next = ToDrive | ToAnswer | Literal["consent", "device", "comprehension", "compare", "finished"]


@final
@dataclass(frozen=True)
class Way:
    """The way through a study, for everybody."""

    definition: Definition
    sizes: Sizes
    seed: int  # of orders, scenes and items

    def order(self, number: int) -> tuple[str, ...]:
        """The conditions of a place, in order: those of the simulated person with this number."""
        rng = generator(self.seed, self.definition.name, Stream.ORDER)
        return design_of(self.definition).orders(self.definition, number + 1, rng)[number]

    def after(self, standing: Standing) -> Next:
        """The next thing for a person who has a place, or has not consented yet."""
        if not standing.consented or standing.number is None:
            return "consent"
        # Who has driven already began when devices were not checked yet.
        if not (standing.device_passed or standing.practised or standing.drives):
            return "device"
        if self.definition.comprehension and True not in standing.comprehension:
            return "comprehension"
        for place, name in enumerate(self.order(standing.number)):
            condition = self.definition.condition(name)
            if place >= standing.practised and (
                practice := self._practice(condition, place, standing.number)
            ):
                return practice
            theirs = [one for one in standing.drives if one.order == place]
            if (trial := self._trial(condition, place, standing.number, theirs)) is not None:
                return trial
            if self._asks and place not in standing.answered:
                asked = sheet(self.definition, standing.number + 1, self.seed)
                theirs = [one for one in asked if one.person == standing.number]
                compared = {one.name for one in self.definition.comparison}
                items = tuple(
                    one.item for one in theirs if one.condition == name and one.item not in compared
                )
                return ToAnswer(condition, place, items)
        if self.definition.comparison and len(self.order(standing.number)) not in standing.answered:
            return "compare"
        return "finished"

    @property
    def _asks(self) -> bool:
        """True if there are questions after each condition."""
        return len(names_of(self.definition)) > len(self.definition.comparison)

    def _trial(
        self, condition: Condition, place: int, person: int, done: list[DriveRecord]
    ) -> ToDrive | None:
        """The next drive of a condition's trials; None where all are finished."""
        for task in self.definition.tasks:
            for trial in range(min(task.trials, self.sizes.most_trials)):
                for choice in choices_of(task, person, trial):
                    at = (task.name, trial, choice)
                    attempts = [one for one in done if (one.task, one.trial, one.choice) == at]
                    left_s = left_for(task, self.sizes, _scene(task.scene), attempts)
                    if left_s is not None:
                        use = (Stream.TRIALS, person, trial, len(attempts))
                        seed = integer(sequence(self.seed, f"{self.definition.name} {task.name}", *use))
                        part = (condition, place, task, trial, choice, len(attempts))
                        return ToDrive("trial", *part, left_s, seed)
        return None

    def _practice(self, condition: Condition, place: int, person: int) -> ToDrive | None:
        """Practice before a condition's trials; there is always some before the first, to set up."""
        limit_s = 60.0 * self.definition.practice_min or (0.0 if place else FIRST_PRACTICE_S)
        if not limit_s:
            return None
        task = self.definition.tasks[0]
        seed = integer(sequence(self.seed, f"{self.definition.name} practice", Stream.TRIALS, person, place))
        return ToDrive("practice", condition, place, task, 0, task.choices[0], 0, limit_s, seed)


@cache
def _scene(name: str) -> SceneTask:
    return scene_of(name)
