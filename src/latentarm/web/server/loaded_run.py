"""What is driven, as the server shows it; made anew for every run."""

from dataclasses import replace
from pathlib import Path
from typing import final

import numpy as np

from latentarm.alignment.profile import profile_names
from latentarm.web.arm_process.drive_setup import Setting, Spec, load_setting
from latentarm.web.arm_process.page_inputs import LATCH_MAX_S
from latentarm.web.protocol.channel import Report
from latentarm.web.protocol.messages import Limits, NamedGoal, Welcome
from latentarm.web.protocol.scene import scene_of


@final
class Stage:
    """A loaded setting, its scene, and what follows from both.

    Args:
        setting: what is driven.
        name: what pages call its run; None without one.
    """

    def __init__(self, setting: Setting, name: str | None) -> None:
        self.name = name
        self.spec = setting.spec
        self.scene = scene_of(setting.task)
        self.chain = setting.task.robot.chain
        self.input_dim = setting.controller.input_dim
        self.latent_dim = setting.latent_dim
        self.goals_m_per_rad = [
            float(np.linalg.norm(self.chain.jacobian(goal.configuration)[:3], ord=2))
            for goal in setting.task.goals
        ]
        self._setting = setting

    @property
    def profiles(self) -> tuple[str, ...]:
        """People whose alignment with the run can be chosen."""
        return () if self.spec.run is None else profile_names(self.spec.run)

    def shows(self, report: Report) -> bool:
        """Whether a report is of what is driven here."""
        return report.run == (None if self.spec.run is None else str(self.spec.run))

    def welcome(self, page: str) -> Welcome:
        """What a page is told first.

        Args:
            page: its id.
        """
        setting = self._setting
        return Welcome(
            id=page,
            dof=setting.task.robot.dof,
            latent_dim=self.latent_dim,
            robot=setting.task.robot.name,
            run=self.name,
            profiles=self.profiles,
            modes=setting.modes,
            goals=tuple(
                NamedGoal(name=goal.name, position=tuple(goal.pose.position.tolist()))
                for goal in setting.task.goals
            ),
            end_effector_modes=setting.axes,
            limits=Limits(latch_max_s=LATCH_MAX_S),
        )


def load_stage(spec: Spec, report: Report, name: str | None) -> Stage:
    """The stage of another run.

    Args:
        spec: what was driven before.
        report: says what is driven now.
        name: what pages call the run.

    Raises:
        UserError: see `load_setting`.
    """
    run = None if report.run is None else Path(report.run)
    return Stage(load_setting(replace(spec, run=run, profile=None)), name)
