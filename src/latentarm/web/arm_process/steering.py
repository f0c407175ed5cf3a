"""How the arm is steered, and other state that outlasts a drive."""

from dataclasses import dataclass
from typing import final

from latentarm.surroundings.surroundings import Surroundings
from latentarm.web.arm_process.help import USUAL_HELP
from latentarm.web.arm_process.task_run import TaskRun
from latentarm.web.protocol.orders import HelpLevel, ModeName


@final
@dataclass
class Steering:
    """State that is kept from one drive to the next."""

    mode: ModeName
    axes: int = 0  # which pair of the end-effector's axes
    help: HelpLevel = USUAL_HELP  # level of help with latent actions
    tick: int = 0  # counts the ticks of all drives
    ending_episode: bool = False  # whether the episode ends as soon as the arm is at rest
    run: TaskRun | None = None  # of the task; None before it begins
    things: Surroundings | None = None  # where things are; None where the simulation tells
    enabled: bool = False  # whether the arm was enabled since the setup changed

    @property
    def help_now(self) -> HelpLevel:
        return self.help if self.mode == "assisted" else "off"

    def choose(
        self, mode: ModeName, axes: int, level: HelpLevel, modes: tuple[ModeName, ...], pairs: int
    ) -> bool:
        """Steer in another way, by the nearest pair of axes; returns whether it changes what a push means."""
        before = self.mode, self.axes, self.help_now
        self.mode = mode
        self.axes = min(max(axes, 0), pairs - 1)
        self.help = level
        if mode == "latent" and "assisted" in modes:
            self.help = "off"
        elif mode == "assisted" and level == "off":
            self.help = USUAL_HELP
        return before != (self.mode, self.axes, self.help_now)
