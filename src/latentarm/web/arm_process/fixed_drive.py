"""A drive in which nothing is chosen on the page, such as a trial of a study."""

from abc import ABC, abstractmethod
from collections.abc import Callable

from latentarm.arms.contract import SceneArm
from latentarm.assistance.assistance import AssistanceRule
from latentarm.assistance.belief import Rule
from latentarm.assistance.controllers.contract import Controller
from latentarm.core.types import StepRecord
from latentarm.tasks.scene_task import Beginning, SceneTask


class FixedDrive(ABC):
    """Decides what a simulated arm is driven at, and how.

    It is sent to the arm's process, so it is picklable. The safety filters are those of every drive.
    """

    @property
    @abstractmethod
    def task(self) -> SceneTask:
        """The task."""

    @abstractmethod
    def begin(self) -> Beginning:
        """The start of the run; the same in every call."""

    @property
    @abstractmethod
    def latent(self) -> bool:
        """True for latent actions, False for modes of the end-effector."""

    @abstractmethod
    def controller(self) -> Controller:
        """Turns the person's input, of two axes, into motion."""

    @property
    @abstractmethod
    def rule(self) -> Rule:
        """How inputs change the belief over the goals."""

    @property
    @abstractmethod
    def assistance(self) -> AssistanceRule | None:
        """How the robot helps; None never helps."""

    @abstractmethod
    def watch(self, arm: SceneArm, device: Callable[[], str]) -> Callable[[StepRecord], None]:
        """Begin to measure the drive: the arm's process calls the result after every step of the loop.

        ``device`` tells the input device that is deflected in this step, "" for none.
        """
