"""Options and results of `latentarm drive`."""

import sys
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Final, Literal

from tyro.conf import Positional, arg

from latentarm.arms.catalogue import check_simulated
from latentarm.commands.options import Arm, LimitsFile, Seated
from latentarm.core.errors import UserError
from latentarm.core.types import Row
from latentarm.runs.checks import check_count, check_positive, check_seed
from latentarm.runs.options import BeliefName, EndEffector, Jobs, Json, MovedDataset, Seed, TaskName
from latentarm_research.assistance.published_help import AssistanceName
from latentarm_research.people.names import OperatorName

ControllerName = Literal["latent", "latent_assist", "end_effector", "two_sticks", "retargeting"]

MODE_SWITCHED: Final[tuple[ControllerName, ...]] = ("end_effector", "two_sticks", "retargeting")
"""Those that move the end-effector a few axes at a time, and need no run."""


@dataclass(frozen=True)
class DriveOptions:
    """Options of `latentarm drive`."""

    run: Annotated[
        Positional[Path | None], arg(metavar="RUN", help="A trained run; without one, mode switching drives.")
    ] = None
    controller: Annotated[
        ControllerName | None,
        arg(
            help="Latent actions, with shared autonomy, or mode switching: end_effector with one stick,"
            " two_sticks with three axes and a toggle between linear and angular, retargeting with one stick"
            " whose motion the arm follows as well as its joints allow."
        ),
    ] = None
    task: Annotated[
        TaskName | None,
        arg(
            help="What is to be done: items on a table, poses in reach, one of two cups, a task with things"
            " in physics, or to follow held-out episodes; that of the run by default."
        ),
    ] = None
    robot: Annotated[
        str | None,
        arg(help="A robot's name or the path of an MJCF or URDF file; that of the run by default."),
    ] = None
    arm: Arm = None
    end_effector: EndEffector = None
    limits: LimitsFile = None
    profile: Annotated[str | None, arg(metavar="NAME", help="Profile made by `latentarm align`.")] = None
    seat: Seated = None
    drives: Annotated[int, arg(help="Drives for each goal.")] = 3
    operator: Annotated[
        OperatorName | None,
        arg(
            help="Simulated operator: greedy knows what each input does and looks one step ahead (equation"
            " 24); learning has only a linear guess of that, learned while driving; reading reads it off the"
            " page's ring; unsteady has a reaction time and tremor; planning looks up to 4 s ahead where one"
            " step leads no nearer. By default planning on held-out episodes, else greedy."
        ),
    ] = None
    beta: Annotated[float, arg(help="Rationality of the simulated operator (equation 24), 1/m².")] = 2000.0
    belief: Annotated[
        BeliefName | None,
        arg(
            help="How inputs change the belief over goals, for help and for models trained on (s, b). By"
            " default boltzmann; with --assistance the belief that it was published with."
        ),
    ] = None
    assistance: Annotated[
        AssistanceName | None,
        arg(
            help="Published help in place of equation 2, with any controller: hindsight optimisation, which"
            " adds its help and acts at rest (Javdani et al. 2018), HARMONIC's low, high and full assist,"
            " which interpolate, or policy blending, which helps once it is sure."
        ),
    ] = None
    arbitration: Annotated[
        Literal["fixed", "confidence"] | None,
        arg(help="For latent_assist: a constant alpha (the default), or one that grows with confidence."),
    ] = None
    alpha: Annotated[
        float | None,
        arg(
            help="For latent_assist: alpha of equation 2 at full input, a share from 0 (the person alone) to"
            " 1 (the robot alone); with confidence the most of it. By default 0.15, with confidence 0.5."
        ),
    ] = None
    time_limit_s: Annotated[
        float | None,
        arg(
            help="A longer drive fails; by default 60 s, 300 s on held-out episodes. Tasks with things have"
            " their own."
        ),
    ] = None
    seed: Seed = 0
    jobs: Jobs = -1
    demonstrations: MovedDataset = None
    record: Annotated[
        Path | None, arg(metavar="DIR", help="Record the drives and export them there as a native dataset.")
    ] = None
    out: Annotated[Path, arg(metavar="DIR", help="Folder for drives.json, drives.csv and the figure.")] = (
        Path("drives")
    )
    json: Json = False

    def __post_init__(self) -> None:
        from latentarm.core.parallel import check_jobs

        check_seed(self.seed)
        check_jobs(self.jobs)
        check_count("drives for each goal", self.drives)
        check_positive("rationality beta", self.beta)
        if self.arm is not None:
            check_simulated(self.arm)
        if self.time_limit_s is not None:
            check_positive("time limit in s", self.time_limit_s)
        if self.driver in MODE_SWITCHED and self.profile is not None:
            raise UserError(
                "A profile aligns latent actions, and mode switching has none: leave one of them out."
            )
        for name in ("arbitration", "alpha"):
            if getattr(self, name) is None:
                continue
            if self.assistance is not None:
                raise UserError(f"The assistance {self.assistance} has no {name}: leave one of them out.")
            if self.driver != "latent_assist":
                raise UserError(f"Without help there is no {name} to set: use --controller latent_assist.")

    @property
    def driver(self) -> ControllerName:
        """What drives: with a run, latent actions unless something else was asked for."""
        return self.controller or ("latent" if self.run else "end_effector")

    @property
    def bars(self) -> bool:
        """Whether to show on standard error how many drives are done."""
        return not self.json and sys.stderr.isatty()


@dataclass(frozen=True)
class Driven:
    """The results of the drives."""

    rows: list[Row]  # mean and SD over the drives
    # one mapping per drive, see `latentarm_research.drives.drive_table.COLUMNS`
    entries: list[dict[str, object]]
    controller: ControllerName  # what drove
    operator: OperatorName  # who gave inputs
    task: str  # what was done
    time_limit_s: float  # after which a drive had failed, s
