"""`latentarm drive`: simulated operators drive a task, with latent actions or with mode switching."""

import sys
from collections.abc import Callable, Generator, Sequence
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import Annotated, Final, Literal

from tyro.conf import Positional, arg

from latentarm.arms.catalogue import DEFAULT_ARM
from latentarm.assistance.blending import ConfidenceAlpha, FixedAlpha
from latentarm.assistance.catalogue import BELIEFS
from latentarm.commands.choices import ArmName, BeliefName, TaskName
from latentarm.commands.configuration import write_options
from latentarm.commands.options import EndEffector, Jobs, Json, LimitsFile, MovedDataset, Seed
from latentarm.commands.output import note, say, show
from latentarm.control.controller import Controller
from latentarm.control.export import export_journal
from latentarm.control.recorder import EpisodeHeader, Recorder
from latentarm.controllers.end_effector import EndEffectorController
from latentarm.controllers.latent import latent_controller
from latentarm.demonstrations.folders import check_vacant
from latentarm.demonstrations.provenance import provenance_now
from latentarm.errors import UserError
from latentarm.metrics.drives import goal_drive_rows
from latentarm.metrics.results import as_document
from latentarm.metrics.summary import Subject
from latentarm.operators.catalogue import PEOPLE, OperatorName, usual_operator
from latentarm.parallel.grid import check_processes, counting_bar
from latentarm.robots.limits_file import read_limits
from latentarm.robots.notices import notices
from latentarm.runs.checks import check_count, check_positive, check_seed
from latentarm.runs.folder import Run, read_run, weights_fingerprint
from latentarm.runs.results_folder import ResultsFolder, write_json
from latentarm.runs.tasks import task_of_run, task_without_run
from latentarm.simulation.drive import RATE_HZ, Setup, Trace, simulate
from latentarm.simulation.drive_figures import draw_drives
from latentarm.simulation.drive_table import Planned, drive_entries, endings_in_words, write_drives_csv
from latentarm.simulation.drives import DrivePlan, drive_all, drive_plan
from latentarm.tasks.catalogue import HELD_OUT
from latentarm.tasks.task import Task
from latentarm.types import Row

ControllerName = Literal["latent", "latent_assist", "end_effector"]
ArbitrationName = Literal["fixed", "confidence"]

MADE: Final = ("drives.json", "drives.csv", "paths.png")
"""Every file of the folder except its options and a recording's journal."""

TIME_LIMIT_S: Final = 60.0
"""How long a drive may last."""

HELD_OUT_LIMIT_S: Final = 300.0
"""The same along held-out episodes, which are several metres long."""


@dataclass(frozen=True)
class DriveOptions:
    """Options of `latentarm drive`.

    Raises:
        UserError: a figure is out of its range, or options contradict each other.
    """

    run: Annotated[
        Positional[Path | None], arg(metavar="RUN", help="A trained run; without one, mode switching drives.")
    ] = None
    controller: Annotated[
        Literal["latent", "latent_assist", "end_effector"] | None,
        arg(help="Latent actions, with shared autonomy, or mode switching."),
    ] = None
    task: Annotated[
        TaskName | None,
        arg(
            help="What is to be done: items on a table, poses in reach, one of two cups, or to follow"
            " held-out episodes; that of the run by default."
        ),
    ] = None
    robot: Annotated[
        str | None,
        arg(help="A robot's name or the path of an MJCF or URDF file; that of the run by default."),
    ] = None
    arm: Annotated[ArmName, arg(help="What moves.")] = DEFAULT_ARM
    end_effector: EndEffector = None
    limits: LimitsFile = None
    profile: Annotated[
        str | None, arg(metavar="NAME", help="Profile made by `latentarm align`; z = u without one.")
    ] = None
    drives: Annotated[int, arg(help="Drives for each goal.")] = 3
    operator: Annotated[
        OperatorName | None,
        arg(
            help="Simulated operator: greedy knows what each input does and looks one step ahead (equation"
            " 24); learning has only a linear guess of that, learned while driving; unsteady has a reaction"
            " time and tremor; planning looks up to 4 s ahead where one step leads no nearer. By default"
            " planning on held-out episodes, else greedy."
        ),
    ] = None
    beta: Annotated[float, arg(help="Rationality of the simulated operator (equation 24), 1/m².")] = 2000.0
    belief: Annotated[
        BeliefName,
        arg(help="How inputs change the belief over goals, for help and for models trained on (s, b)."),
    ] = "boltzmann"
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
        float | None, arg(help="A longer drive fails; by default 60 s, 300 s on held-out episodes.")
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
        check_seed(self.seed)
        check_processes(self.jobs, "joblib")
        check_count("drives for each goal", self.drives)
        check_positive("rationality beta", self.beta)
        if self.time_limit_s is not None:
            check_positive("time limit in s", self.time_limit_s)
        if self.driver == "end_effector" and self.profile is not None:
            raise UserError(
                "A profile aligns latent actions, and mode switching has none: leave one of them out."
            )
        if self.driver != "latent_assist":
            for name in ("arbitration", "alpha"):
                if getattr(self, name) is not None:
                    raise UserError(
                        f"Without help there is no {name} to set: use --controller latent_assist."
                    )

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
    """The results of the drives.

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


def drive_run(config: DriveOptions, tell: Callable[[Sequence[str]], None] = lambda sentences: None) -> Driven:
    """Drive every goal of a task several times and write ``drives.json``, ``drives.csv`` and a figure.

    Args:
        config: what was asked for.
        tell: called with notices about the robot before it moves.

    Raises:
        UserError: the run, the robot or the task does not exist, they do not fit each other, or the folder
            holds something else.
    """
    arbitration = _arbitration(config)
    run = None if config.run is None else read_run(config.run)
    limits = None if config.limits is None else read_limits(config.limits)
    if run is None:
        task = task_without_run(config.task, config.robot, config.end_effector, limits)
    else:
        task = task_of_run(run, config.task, config.robot, config.end_effector, limits, config.demonstrations)
    tell(notices(task.robot))
    operator = config.operator or usual_operator(task.name)
    person = PEOPLE[operator]
    setup = Setup(
        task=task,
        controller=_controller(config, task),
        arbitration=arbitration,
        person=replace(person, decides=replace(person.decides, beta=config.beta)),
        time_limit_s=config.time_limit_s or (HELD_OUT_LIMIT_S if task.name == HELD_OUT else TIME_LIMIT_S),
        rule=BELIEFS.find(config.belief, "--belief"),
        arm=config.arm,
    )
    about = _about(config, setup, operator, run, arbitration)
    if config.record is not None:
        check_vacant(config.record)
    ResultsFolder("drive", MADE).claim(config.out, about)
    if config.record is None:
        traces = drive_all([setup], config.drives, config.seed, config.jobs, bars=config.bars)
    else:
        traces = _record_all(setup, config, config.record)
    model = None if run is None or config.driver == "end_effector" else run.model
    subject = Subject("drive", task=task.name, model=model, condition=config.driver)
    rows = goal_drive_rows(subject, [trace.measured for trace in traces])
    planned = [
        Planned(task.goals[goal].name, manner, number % config.drives)
        for number, (goal, manner, _) in enumerate(drive_plan(task, config.drives, config.seed))
    ]
    entries = drive_entries(planned, traces, seed=config.seed, controller=config.driver, operator=operator)
    write_json(config.out / "drives.json", as_document(rows, about) | {"drives": entries})
    write_drives_csv(config.out / "drives.csv", entries)
    draw_drives({config.driver: traces}, task, config.out / "paths.png")
    return Driven(rows, entries, config.driver, operator, task.name, setup.time_limit_s)


def _about(
    config: DriveOptions,
    setup: Setup,
    operator: OperatorName,
    run: Run | None,
    arbitration: FixedAlpha | ConfidenceAlpha | None,
) -> dict[str, object]:
    """What the figures depend on."""
    robot = setup.task.robot
    model = None if run is None or config.driver == "end_effector" else run.folder
    return {
        "study": "drive",
        "run": str(config.run),
        "model": None if model is None else weights_fingerprint(model),
        "controller": config.driver,
        "task": setup.task.name,
        "robot": robot.name,
        "arm": config.arm,
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


def _record_all(setup: Setup, config: DriveOptions, dataset: Path) -> list[Trace]:
    """Drive one after the other and record every step; then export the journal.

    Raises:
        UserError: a journal is there already, or a file cannot be written.
    """
    task = setup.task
    journal = config.out / "journal.sqlite"
    if journal.exists():
        raise UserError(f"{journal} already exists: choose another folder with --out.")
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
                        controller=config.driver,
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


def _counted(plan: Sequence[DrivePlan], bars: bool) -> Generator[DrivePlan]:
    """The drives, one after the other, with a bar that counts those that are done."""
    with counting_bar(bars) as bar:
        task = bar.add_task("drives", total=len(plan))
        for call in plan:
            yield call
            bar.advance(task)


def _arbitration(config: DriveOptions) -> FixedAlpha | ConfidenceAlpha | None:
    """How much the robot helps, if it helps at all."""
    if config.driver != "latent_assist":
        return None
    if config.arbitration == "confidence":
        return ConfidenceAlpha() if config.alpha is None else ConfidenceAlpha(config.alpha)
    return FixedAlpha() if config.alpha is None else FixedAlpha(config.alpha)


def _controller(config: DriveOptions, task: Task) -> Controller:
    if config.driver == "end_effector":
        return EndEffectorController(task.robot)
    if config.run is None:
        raise UserError("Latent actions need a trained run: name one, as in `latentarm drive RUN`.")
    return latent_controller(config.run, config.profile, task.robot)


def drive(options: DriveOptions) -> int:
    """Drive an arm in simulation with a simulated operator, through Algorithm 1 and its safety filters.

    Exits with 1 when no drive reached its goal. For example: latentarm drive runs/pour-cae
    """
    driven = drive_run(options, note)
    write_options(
        options.out,
        "drive",
        controller=driven.controller,
        operator=driven.operator,
        task=driven.task,
        time_limit_s=driven.time_limit_s,
    )
    show(driven.rows, options.json)
    for sentence in endings_in_words(driven.entries):
        say(sentence, options.json)
    say(
        f"One row per drive is in {options.out}/drives.csv; drives.json and paths.png are next to it.",
        options.json,
    )
    return 0 if any(entry["success"] for entry in driven.entries) else 1
