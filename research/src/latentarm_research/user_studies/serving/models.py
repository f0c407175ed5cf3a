"""The models that a study's conditions are driven with: trained once, and kept in its folder."""

from pathlib import Path
from typing import Final, final

from latentarm.models.saving import CONFIG_NAME, write_model
from latentarm_research.user_studies.definition import Condition, Definition, StudyTask
from latentarm_research.user_studies.sizes import Sizes
from latentarm_research.user_studies.training import TrainingCell, train

MODELS: Final = "models"


@final
class Models:
    """The models of a study, in ``out``."""

    def __init__(self, definition: Definition, out: Path) -> None:
        self._definition = definition
        self._out = out

    def folder(self, condition: Condition, task: StudyTask) -> Path | None:
        """Where the model is that a condition is driven with at a task; None where it has none."""
        if not condition.model:
            return None
        named = "-".join((task.trained_with or task.name, condition.model, *condition.context))
        return self._out / MODELS / named

    def missing(self) -> list[StudyTask]:
        """Tasks of which a model is not trained yet."""
        return [task for task in self._definition.tasks if not task.trained_with and self._lacks(task)]

    def train(self, task: StudyTask, sizes: Sizes, seed: int) -> None:
        """Demonstrate a task, and train all its models."""
        trained = train(TrainingCell(self._definition, task, (), sizes, seed))
        about = {"definition": self._definition.digest, "demonstrations": trained.episodes, "seed": seed}
        for condition in self._definition.conditions:
            folder = self.folder(condition, task)
            if folder is not None:
                folder.mkdir(parents=True, exist_ok=True)
                write_model(folder, trained.models[condition.model, condition.context], about)

    def _lacks(self, task: StudyTask) -> bool:
        folders = (self.folder(condition, task) for condition in self._definition.conditions)
        return any(one is not None and not (one / CONFIG_NAME).exists() for one in folders)
