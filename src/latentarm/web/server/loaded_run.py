"""The setup that is driven, for pages, built anew for every run; and the runs to choose from."""

from dataclasses import dataclass, replace
from pathlib import Path
from typing import final

from latentarm.alignment.profile import profile_names
from latentarm.core.types import FloatArray
from latentarm.web.arm_process.drive_setup import DriveSetup, Spec, load_setup
from latentarm.web.arm_process.page_inputs import LATCH_MAX_S
from latentarm.web.protocol import server_messages as messages
from latentarm.web.protocol.orders import BuiltInPose, PoseToGoTo
from latentarm.web.protocol.report import Report
from latentarm.web.protocol.scene import drawable

Beginning = tuple[str | None, bool, int, int]
"""The run, whether at its own task, its seed and what is to be done: how everything stands at first."""


def beginning_of(report: Report) -> Beginning:
    """The beginning that a report belongs to."""
    return report.run, report.own_task, report.seed, report.task.choice


@final
class LoadedRun:
    """A loaded setup, its scene, and what follows from both. ``name`` is the run's name on pages."""

    def __init__(self, setup: DriveSetup, name: str | None) -> None:
        self.name = name
        self.spec = setup.spec
        self.scene = drawable(setup.task, setup.obstacles, setup.shown, setup.spec.zones)
        self.robot_name = setup.task.robot.name
        self.input_dim = setup.controller.input_dim
        self.latent_dim = setup.latent_dim
        self.setup = setup
        robot = setup.task.robot
        self._poses: dict[BuiltInPose, FloatArray] = {"home": robot.home} if robot.home_stated else {}
        if robot.tuck is not None:
            self._poses["tuck"] = robot.tuck

    def built_in(self, pose: BuiltInPose, name: str) -> PoseToGoTo | None:
        """A pose of the robot's own; None where its model states none. ``name`` is what people call it."""
        q = self._poses.get(pose)
        return None if q is None else PoseToGoTo(name=name, q=tuple(q.tolist()))

    @property
    def profiles(self) -> tuple[str, ...]:
        """People whose alignment with the run can be chosen."""
        return () if self.spec.run is None else profile_names(self.spec.run)

    def shows(self, report: Report) -> bool:
        """Whether a report is about this run from this beginning."""
        run = None if self.spec.run is None else str(self.spec.run)
        return beginning_of(report) == (run, self.spec.own_task, self.spec.seed, self.spec.choice)

    def welcome(self, page: str, server: str) -> messages.Welcome:
        setup = self.setup
        gripper = setup.task.robot.gripper
        return messages.Welcome(
            id=page,
            server=server,
            dof=setup.task.robot.dof,
            latent_dim=self.latent_dim,
            robot=Path(setup.task.robot.name).name,  # of a model file without its folder
            run=self.name,
            profiles=self.profiles,
            modes=setup.modes,
            goals=tuple(
                messages.NamedPlace(name=goal.name, position=tuple(goal.pose.position.tolist()))
                for goal in setup.task.goals
            ),
            things=tuple(
                messages.NamedPlace(name=thing.name, position=tuple(thing.pose.position.tolist()))
                for thing in (() if setup.shown is None else setup.shown.things)
            ),
            zones=tuple(messages.NamedZone(name=zone.name, speed=zone.speed) for zone in setup.spec.zones),
            keep_out=tuple(one.name for one in setup.spec.keep_out),
            end_effector_modes=setup.axes,
            latch_max_s=LATCH_MAX_S,
            real=messages.RealArm(facts=setup.spec.found, shadow=setup.spec.shadow) if setup.real else None,
            poses=tuple(self._poses),
            gripper_width_m=None if gripper is None else gripper.width_m,
            task=messages.TaskToDo(
                name=setup.todo.task,
                seed=setup.spec.seed,
                choices=setup.todo.choices,
                choice=setup.todo.choice,
                steps=tuple(messages.StepToDo(kind=step.kind, thing=step.thing) for step in setup.todo.steps),
            ),
        )


def load_reported_run(spec: Spec, report: Report, name: str | None) -> LoadedRun:
    """Load the run that a report names, called ``name`` on pages. Raises UserError as `load_setup` does."""
    run = None if report.run is None else Path(report.run)
    begun = replace(spec, run=run, profile=None, own_task=report.own_task)
    begun = replace(begun, seed=report.seed, choice=report.task.choice)
    return LoadedRun(load_setup(begun), name)


@final
@dataclass(eq=False)
class RunList:
    """Runs that were trained on the page, and ``first``, with which the server was started.

    Pages name a run by its name here, never by a path.
    """

    _out: Path
    _first: Path | None

    def runs(self) -> dict[str, Path]:
        """Folders of complete runs by name, sorted by name."""
        found = {path.parent.name: path.parent for path in self._out.glob("runs/*/config.json")}
        if self._first is not None:
            name = self._first.resolve().name
            if name in found and not _same(found[name], self._first):
                name += " (2)"
            found[name] = self._first
        return dict(sorted(found.items()))

    def is_first(self, run: Path) -> bool:
        """True for the run that the server was started with."""
        return self._first is not None and _same(self._first, run)

    def name_of(self, run: Path | None) -> str | None:
        """The name of a run on pages; None for None."""
        if run is None:
            return None
        return next((name for name, path in self.runs().items() if _same(path, run)), run.resolve().name)


def _same(one: Path, other: Path) -> bool:
    return one.resolve() == other.resolve()
