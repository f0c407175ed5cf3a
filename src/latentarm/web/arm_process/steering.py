"""How the arm is steered, and what else goes on from one drive to the next."""

from dataclasses import dataclass
from typing import final

from latentarm.web.arm_process.help import USUAL_HELP
from latentarm.web.arm_process.task_run import TaskRun
from latentarm.web.protocol.orders import HelpLevel, ModeName


@final
@dataclass
class Steering:
    """State that is kept from one drive to the next.

    Attributes:
        mode: how the arm is steered.
        axes: which pair of the end-effector's axes.
        help: how much the robot helps with latent actions.
        tick: counts the ticks of all drives.
        ending_episode: whether the episode ends as soon as the arm is at rest.
        run: of the task, as far as it has come; None where it is to begin.
    """

    mode: ModeName
    axes: int = 0
    help: HelpLevel = USUAL_HELP
    tick: int = 0
    ending_episode: bool = False
    run: TaskRun | None = None

    @property
    def help_now(self) -> HelpLevel:
        """How much the robot helps in this mode."""
        return self.help if self.mode == "assisted" else "off"

    def choose(
        self, mode: ModeName, axes: int, level: HelpLevel, modes: tuple[ModeName, ...], pairs: int
    ) -> bool:
        """Steer in another way.

        Args:
            mode: one of the modes.
            axes: which pair of the end-effector's axes; the nearest that there is counts.
            level: how much the robot helps.
            modes: to choose from.
            pairs: how many pairs of axes there are.

        Returns:
            Whether a stick that is held means something else by now.
        """
        before = self.mode, self.axes, self.help_now
        self.mode = mode
        self.axes = min(max(axes, 0), pairs - 1)
        self.help = level
        if mode == "latent" and "assisted" in modes:
            self.help = "off"
        elif mode == "assisted" and level == "off":
            self.help = USUAL_HELP
        return before != (self.mode, self.axes, self.help_now)
