"""`latentarm drive`: simulated operators drive a task, with latent actions or with mode switching."""

from collections.abc import Callable, Generator, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Final, Literal

import numpy as np

from latentarm.assistance.blending import ConfidenceAlpha, FixedAlpha
from latentarm.assistance.catalogue import BELIEFS
from latentarm.control.controller import Controller
from latentarm.control.export import export_journal
from latentarm.control.recorder import EpisodeHeader, Recorder
from latentarm.controllers.end_effector import EndEffectorController
from latentarm.controllers.latent import latent_controller
from latentarm.demonstrations.folders import check_vacant
from latentarm.demonstrations.provenance import provenance_now
from latentarm.errors import UserError
from latentarm.metrics.drives import drive_rows
from latentarm.metrics.results import as_document
from latentarm.metrics.summary import Subject
from latentarm.operators.boltzmann import BoltzmannConfig
from latentarm.operators.catalogue import PLANNING, OperatorName, usual_operator
from latentarm.parallel.grid import check_processes, counting_bar, run_grid
from latentarm.robots.limits_file import read_limits
from latentarm.robots.notices import notices
from latentarm.runs.checks import check_count, check_positive, check_seed
from latentarm.runs.folder import Run, read_run, weights_fingerprint
from latentarm.runs.results_folder import Study, write_json
from latentarm.runs.tasks import TaskName, task_of_run, task_without_run
from latentarm.simulation.drive import RATE_HZ, Setup, Trace, simulate
from latentarm.simulation.drive_figures import draw_drives
from latentarm.simulation.drive_table import Planned, drive_entries, write_drives_csv
from latentarm.tasks.task import Task
from latentarm.types import Row

ControllerName = Literal["latent", "latent_assist", "end_effector"]
BeliefName = Literal["boltzmann", "distance", "maximum_entropy"]
ArbitrationName = Literal["fixed", "confidence"]

DRIVE_STREAM = 2
"""Keeps the drives apart from everything else that is drawn from the same seed."""

DrivePlan = tuple[int, str, np.random.Generator]
"""Goal, manner and randomness of a drive."""

MADE: Final = ("drives.json", "drives.csv", "paths.png")
"""Every file of the folder, apart from what was asked for and a recording's journal."""

TIME_LIMITS_S = {"table_top": 60.0, "held_out": 300.0, "reach": 60.0}
"""How long a drive may last, by task: held-out episodes are several metres long."""


@dataclass(frozen=True)
class DriveConfig:
    """What `latentarm drive` was asked for; its ``--help`` says the same of each field.

    Attributes:
        run: a trained run, or None for mode switching alone.
        controller: what drives.
        out: folder for drives.json and the figure.
        task: what is to be done; what the run was trained for where None.
        robot: a robot's name or model file; that of the run where None.
        end_effector: site, body or link of a model file.
        limits: a limits file, or None.
        profile: name of the person whose alignment stands between input and latent action; z = u where None.
        drives: for each goal.
        operator: who gives inputs; `usual_operator` of the task where None.
        beta: rationality of the simulated operator.
        belief: how inputs change the robot's belief over the goals.
        arbitration: how alpha comes about where the robot helps; fixed where None.
        alpha: arbitration at full input, in [0, 1], the most of it for confidence; that of `FixedAlpha`
            or `ConfidenceAlpha` where None.
        time_limit_s: a drive that lasts longer has failed; what `TIME_LIMITS_S` says where None.
        seed: of everything random.
        jobs: processes side by side; -1 is one per core. A recording is driven by one.
        record: folder of a new dataset that the drives are exported to, or None.
        dataset: where the run's dataset lies now, if it was moved.
        bars: show on standard error how many drives are done.

    Raises:
        UserError: a figure is out of its range.
    """

    run: Path | None
    controller: ControllerName
    out: Path
    task: TaskName | None = None
    robot: str | None = None
    end_effector: str | None = None
    limits: Path | None = None
    profile: str | None = None
    drives: int = 3
    operator: OperatorName | None = None
    beta: float = BoltzmannConfig.beta
    belief: BeliefName = "boltzmann"
    arbitration: ArbitrationName | None = None
    alpha: float | None = None
    time_limit_s: float | None = None
    seed: int = 0
    jobs: int = 1
    record: Path | None = None
    dataset: Path | None = None
    bars: bool = False

    def __post_init__(self) -> None:
        check_seed(self.seed)
        check_processes(self.jobs, "joblib")
        check_count("drives for each goal", self.drives)
        check_positive("rationality beta", self.beta)
        if self.time_limit_s is not None:
            check_positive("time limit in s", self.time_limit_s)
        if self.controller == "end_effector" and self.profile is not None:
            raise UserError(
                "A profile aligns latent actions, and mode switching has none: leave one of them out."
            )
        if self.controller != "latent_assist":
            for name in ("arbitration", "alpha"):
                if getattr(self, name) is not None:
                    raise UserError(
                        f"Without help there is no {name} to set: use --controller latent_assist."
                    )


@dataclass(frozen=True)
class Driven:
    """What came of the drives.

    Attributes:
        rows: mean and SD over the drives.
        entries: one mapping per drive, see `latentarm.simulation.drive_table.COLUMNS`.
        controller: what drove.
        operator: who gave inputs.
        task: what was done.
        time_limit_s: after which a drive had failed, s.
    """

    rows: list[Row]
    entries: list[dict[str, object]]
    controller: ControllerName
    operator: OperatorName
    task: str
    time_limit_s: float


def drive_run(config: DriveConfig, tell: Callable[[Sequence[str]], None] = lambda sentences: None) -> Driven:
    """Drive every goal of a task several times and write ``drives.json``, ``drives.csv`` and a figure.

    Args:
        config: what was asked for.
        tell: is given what to keep in mind of the robot, before it moves.

    Raises:
        UserError: the run, the robot or the task does not exist, they do not fit each other, or the folder
            holds something else.
    """
    arbitration = _arbitration(config)
    run = None if config.run is None else read_run(config.run)
    demonstrations = None if run is None else run.dataset(config.dataset)
    limits = None if config.limits is None else read_limits(config.limits)
    if run is None or demonstrations is None:
        task = task_without_run(config.task, config.robot, config.end_effector, limits)
    else:
        task = task_of_run(run, demonstrations, config.task, config.robot, config.end_effector, limits)
    tell(notices(task.robot))
    operator = config.operator or usual_operator(task.name)
    setup = Setup(
        task=task,
        controller=_controller(config, task),
        arbitration=arbitration,
        operator=BoltzmannConfig(beta=config.beta),
        time_limit_s=TIME_LIMITS_S[task.name] if config.time_limit_s is None else config.time_limit_s,
        rule=BELIEFS[config.belief],
        planning=PLANNING[operator],
    )
    about = _about(config, setup, operator, run, arbitration)
    if config.record is not None:
        check_vacant(config.record)
    Study("drive", MADE).claim(config.out, about)
    if config.record is None:
        traces = drive_all([setup], config.drives, config.seed, config.jobs, bars=config.bars)
    else:
        traces = _record_all(setup, config, config.record)
    model = None if run is None or config.controller == "end_effector" else run.model
    subject = Subject("drive", task=task.name, model=model, condition=config.controller)
    rows = drive_rows(subject, [trace.figures for trace in traces])
    planned = [
        Planned(task.goals[goal].name, manner, number % config.drives)
        for number, (goal, manner, _) in enumerate(drive_plan(task, config.drives, config.seed))
    ]
    entries = drive_entries(
        planned, traces, seed=config.seed, controller=config.controller, operator=operator
    )
    write_json(config.out / "drives.json", as_document(rows, about) | {"drives": entries})
    write_drives_csv(config.out / "drives.csv", entries)
    draw_drives({config.controller: traces}, task, config.out / "paths.png")
    return Driven(rows, entries, config.controller, operator, task.name, setup.time_limit_s)


def _about(
    config: DriveConfig,
    setup: Setup,
    operator: OperatorName,
    run: Run | None,
    arbitration: FixedAlpha | ConfidenceAlpha | None,
) -> dict[str, object]:
    """What the figures depend on."""
    robot = setup.task.robot
    model = None if run is None or config.controller == "end_effector" else run.folder
    return {
        "study": "drive",
        "run": str(config.run),
        "model": None if model is None else weights_fingerprint(model),
        "controller": config.controller,
        "task": setup.task.name,
        "robot": robot.name,
        "end_effector": robot.chain.tools[0].name,
        "limit_sources": asdict(robot.limits.sources) | {"tool_speed": robot.tool_speed_source},
        "profile": config.profile,
        "drives_per_goal": config.drives,
        "seed": config.seed,
        "operator": "simulated",
        "operator_name": operator,
        "beta": config.beta,
        "belief": config.belief,
        "arbitration": None if arbitration is None else config.arbitration or "fixed",
        "alpha": None if arbitration is None else asdict(arbitration),
        "time_limit_s": setup.time_limit_s,
    }


def drive_all(
    setups: Sequence[Setup], drives: int, seed: int, jobs: int, *, bars: bool = False
) -> list[Trace]:
    """Drive to every goal ``drives`` times, the task's manners in turn, processes side by side.

    A drive depends on the seed, the goal and its number alone, so that every controller meets the
    same starts and the number of processes changes nothing.

    Args:
        setups: on one task; they take turns, so that no figure hangs on one trained model.
        drives: to each goal.
        seed: of the starts and of the simulated operator.
        jobs: processes; -1 is one per core.
        bars: show on standard error how many drives are done.

    Returns:
        The drives, goal by goal.
    """
    plan = drive_plan(setups[0].task, drives, seed)
    calls = [_Call(setups[number % len(setups)], *call) for number, call in enumerate(plan)]
    return run_grid(_simulate, calls, jobs=jobs, backend="joblib", label=_name_of, bars=bars, unit="drives")


@dataclass(frozen=True, eq=False)
class _Call:
    """One drive of `drive_all`."""

    setup: Setup
    goal: int
    manner: str
    rng: np.random.Generator


def _simulate(call: _Call) -> Trace:
    return simulate(call.setup, call.goal, call.manner, call.rng)


def _name_of(call: _Call) -> str:
    return f"the drive to {call.setup.task.goals[call.goal].name}"


def _record_all(setup: Setup, config: DriveConfig, dataset: Path) -> list[Trace]:
    """Drive one after the other, each step journaled as it happens; then export the journal.

    Raises:
        UserError: a journal is there already, or a file cannot be written.
    """
    task = setup.task
    journal = config.out / "journal.sqlite"
    if journal.exists():
        raise UserError(f"{journal} is there already: choose another folder with --out.")
    recorder = Recorder(journal)
    traces: list[Trace] = []
    try:
        for goal, manner, rng in _counted(drive_plan(task, config.drives, config.seed), config.bars):
            recorder.begin_episode(
                EpisodeHeader(
                    robot=task.robot.name,
                    joint_names=task.robot.joint_names,
                    joint_limits=task.robot.limits,
                    rate_hz=RATE_HZ,
                    task=f"{manner} {task.goals[goal].name}",
                    goals=task.goals,
                    modes=setup.controller.modes,
                    provenance=provenance_now(
                        run="" if config.run is None else config.run.name,
                        run_fingerprint="" if config.run is None else weights_fingerprint(config.run),
                        profile=config.profile or "",
                        device="simulated",
                        controller=config.controller,
                    ),
                    end_effector=task.robot.end_effector,
                    limits=task.robot.stated_limits,
                )
            )
            traces.append(simulate(setup, goal, manner, rng, recorder.record))
            recorder.end_episode()
    finally:
        recorder.close()
    export_journal(journal, dataset)
    return traces


def drive_plan(task: Task, drives: int, seed: int) -> list[DrivePlan]:
    """Goal, manner and randomness of every drive, goal by goal; the manners take turns.

    Args:
        task: whose goals are driven to.
        drives: to each goal.
        seed: of the starts and of the simulated operator.
    """
    return [
        (
            goal,
            task.manners[number % len(task.manners)],
            np.random.default_rng([DRIVE_STREAM, seed, goal, number]),
        )
        for goal in range(len(task.goals))
        for number in range(drives)
    ]


def _counted(plan: Sequence[DrivePlan], bars: bool) -> Generator[DrivePlan]:
    """The drives, one after the other, with a bar that counts those that are done."""
    with counting_bar(bars) as bar:
        task = bar.add_task("drives", total=len(plan))
        for call in plan:
            yield call
            bar.advance(task)


def _arbitration(config: DriveConfig) -> FixedAlpha | ConfidenceAlpha | None:
    """How much the robot helps, where it does."""
    if config.controller != "latent_assist":
        return None
    if config.arbitration == "confidence":
        return ConfidenceAlpha() if config.alpha is None else ConfidenceAlpha(config.alpha)
    return FixedAlpha() if config.alpha is None else FixedAlpha(config.alpha)


def _controller(config: DriveConfig, task: Task) -> Controller:
    if config.controller == "end_effector":
        return EndEffectorController(task.robot)
    if config.run is None:
        raise UserError("Latent actions need a trained run: name one, as in `latentarm drive RUN`.")
    return latent_controller(config.run, config.profile, task.robot)
