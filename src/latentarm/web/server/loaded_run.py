"""What is driven, as the server shows it, made anew for every run; and which runs there are to drive."""

from dataclasses import replace
from pathlib import Path
from typing import final

import numpy as np

from latentarm.alignment.profile import profile_names
from latentarm.runs.folder import read_run
from latentarm.tasks.task import Task
from latentarm.web.arm_process.drive_setup import DriveSetup, Spec, load_setup
from latentarm.web.arm_process.page_inputs import LATCH_MAX_S
from latentarm.web.protocol.channel import Report
from latentarm.web.protocol.messages import Limits, NamedGoal, Welcome
from latentarm.web.protocol.scene import drawable


@final
class LoadedRun:
    """A loaded setup, its scene, and what follows from both.

    Args:
        setup: what is driven.
        name: what pages call its run; None without one.
    """

    def __init__(self, setup: DriveSetup, name: str | None) -> None:
        self.name = name
        self.spec = setup.spec
        self.scene = drawable(setup.task, setup.scene)
        self.chain = setup.task.robot.chain
        self.robot_name = setup.task.robot.name
        self.task_name = _task_name(setup)
        self.input_dim = setup.controller.input_dim
        self.latent_dim = setup.latent_dim
        self.goals_m_per_rad = [
            float(np.linalg.norm(self.chain.jacobian(goal.configuration)[:3], ord=2))
            for goal in setup.task.goals
        ]
        self._setup = setup

    @property
    def profiles(self) -> tuple[str, ...]:
        """People whose alignment with the run can be chosen."""
        return () if self.spec.run is None else profile_names(self.spec.run)

    def shows(self, report: Report) -> bool:
        """Whether a report is about this run."""
        return report.run == (None if self.spec.run is None else str(self.spec.run))

    def welcome(self, page: str) -> Welcome:
        """What a page is told first.

        Args:
            page: its id.
        """
        setup = self._setup
        gripper = setup.task.robot.gripper
        return Welcome(
            id=page,
            dof=setup.task.robot.dof,
            latent_dim=self.latent_dim,
            robot=setup.task.robot.name,
            run=self.name,
            profiles=self.profiles,
            modes=setup.modes,
            goals=tuple(
                NamedGoal(name=goal.name, position=tuple(goal.pose.position.tolist()))
                for goal in setup.task.goals
            ),
            end_effector_modes=setup.axes,
            limits=Limits(latch_max_s=LATCH_MAX_S),
            gripper_width_m=None if gripper is None else gripper.width_m,
        )


def _task_name(setup: DriveSetup) -> str:
    """What is driven at, a name of `latentarm.tasks.catalogue`."""
    if isinstance(setup.task, Task):
        return setup.task.name
    spec = setup.spec
    return spec.task or (None if spec.run is None else read_run(spec.run).task) or ""


def load_reported_run(spec: Spec, report: Report, name: str | None) -> LoadedRun:
    """Load the run that a report names.

    Args:
        spec: what was driven before.
        report: says what is driven now.
        name: what pages call the run.

    Raises:
        UserError: see `load_setup`.
    """
    run = None if report.run is None else Path(report.run)
    return LoadedRun(load_setup(replace(spec, run=run, profile=None)), name)


@final
class RunList:
    """Runs that were trained on the page, and the one that the server was started with.

    Pages name a run by its name here, never by a path.

    Args:
        out: folder that holds ``runs``.
        first: the run that the server was started with, or None.
    """

    def __init__(self, out: Path, first: Path | None) -> None:
        self._out = out
        self._first = first

    def runs(self) -> dict[str, Path]:
        """Folders by name, in the order of the names; whole runs alone."""
        found = {path.parent.name: path.parent for path in self._out.glob("runs/*/config.json")}
        if self._first is not None:
            name = self._first.resolve().name
            if name in found and not _same(found[name], self._first):
                name += " (as started)"
            found[name] = self._first
        return dict(sorted(found.items()))

    def name_of(self, run: Path | None) -> str | None:
        """What pages call a run; None for None."""
        if run is None:
            return None
        return next((name for name, path in self.runs().items() if _same(path, run)), run.resolve().name)


def _same(one: Path, other: Path) -> bool:
    return one.resolve() == other.resolve()
