"""`latentarm demo`: the main job on embedded defaults."""

import shutil
import sys
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import Annotated, Final

import numpy as np
from tyro.conf import arg

from latentarm.alignment.profile import profile_names
from latentarm.arms.catalogue import DEFAULT_ARM
from latentarm.assistance.blending import Arbitration, FixedAlpha
from latentarm.commands.choices import ArmName
from latentarm.commands.configuration import write_options
from latentarm.commands.options import Json, Seed
from latentarm.commands.output import say, show
from latentarm.control.controller import Controller
from latentarm.controllers.end_effector import EndEffectorController
from latentarm.controllers.latent import LatentController
from latentarm.demonstrations.dataset import write_dataset
from latentarm.errors import UserError
from latentarm.files import write_text
from latentarm.metrics.comparison_figure import comparison_figure
from latentarm.metrics.drives import goal_drive_rows
from latentarm.metrics.results import write_results
from latentarm.metrics.summary import Subject, headline
from latentarm.metrics.table import markdown_table
from latentarm.models.catalogue import DEFAULT_MODEL
from latentarm.models.saving import load_decoder
from latentarm.models.training import epoch_bar
from latentarm.operators.catalogue import PEOPLE, OperatorName
from latentarm.runs.checks import check_count, check_seed
from latentarm.runs.evaluating import evaluate_run
from latentarm.runs.results_folder import ResultsFolder, vacant_name
from latentarm.runs.training import TrainConfig, train_run
from latentarm.simulation.arm_figure import draw_task
from latentarm.simulation.drive import STATE_NOISE_RAD, Setup, Trace
from latentarm.simulation.drive_figures import draw_drives, draw_inputs
from latentarm.simulation.drives import drive_all
from latentarm.style import save_figure
from latentarm.tasks.table_top import TableTop
from latentarm.types import Row
from latentarm.untrusted.console import VisibleConsole
from latentarm.web.arm_process.drive_setup import Spec
from latentarm.web.server.addresses import TeleopConfig
from latentarm.web.server.app import serve

MODELS: Final = tuple(dict.fromkeys((DEFAULT_MODEL, "cvae")))
"""The default model and the paper's."""

TIME_LIMIT_S = 60.0

SHOWN: Final[OperatorName] = "greedy"
"""Whose drives the figures show, and who is helped as well: the paper's simulated person (equation 24)."""

MADE = ("results.json", "results.md", "paths.png", "inputs.png", "properties.png", "task.png")
"""Every file of the folder except its options, the dataset and the runs."""


@dataclass(frozen=True)
class DemoOptions:
    """Options of `latentarm demo`.

    Raises:
        UserError: a figure is out of its range.
    """

    out: Annotated[Path, arg(metavar="DIR", help="Folder for datasets, runs, table and figures.")] = Path(
        "demo"
    )
    drives: Annotated[int, arg(help="Simulated drives for each goal, person and condition.")] = 7
    arm: Annotated[ArmName, arg(help="What moves.")] = DEFAULT_ARM
    seed: Seed = 0
    jobs: Annotated[int, arg(help="Processes that drive side by side; -1 is one per core.")] = -1
    json: Json = False

    def __post_init__(self) -> None:
        check_seed(self.seed)
        check_count("drives for each goal", self.drives)

    @property
    def bars(self) -> bool:
        """Whether to show progress bars."""
        return not self.json and sys.stderr.isatty()


@dataclass(frozen=True)
class Sizes:
    """How much is learned from; only tests take other sizes.

    Attributes:
        episodes: demonstrations.
        seeds: models of each kind, trained together and driven in turn.
        epochs: passes over the training pairs, at most.
    """

    episodes: int = 60
    seeds: int = 3
    epochs: int = 16


USUAL = Sizes()


def run_demo(config: DemoOptions, sizes: Sizes = USUAL) -> list[Row]:
    """Run the whole demo and write its results to ``config.out``.

    Returns:
        Figures of the drives: mean and SD over all goals.

    Raises:
        UserError: the folder holds something else, or cannot be written.
    """
    _claim(config, sizes)
    console = VisibleConsole(stderr=True, quiet=config.json)
    task = TableTop()
    console.print(f"1/3  A simulated person demonstrates eating {sizes.episodes} times.")
    demonstrations = task.demonstrate(sizes.episodes, np.random.default_rng(config.seed))
    write_dataset(demonstrations, config.out / "demonstrations")
    draw_task(task, demonstrations, config.out / "task.png")
    properties: list[Row] = []
    for model in MODELS:
        console.print(f"2/3  {model}: learning 2-D latent actions, {sizes.seeds} seeds at once.")
        properties += _train(config, sizes, model)
    conditions = _conditions(task, config, sizes.seeds)
    traces: dict[str, list[Trace]] = {}
    tables: dict[OperatorName, list[Row]] = {person: [] for person in PEOPLE}
    for number, (person, subject, setups) in enumerate(conditions, start=1):
        drives = config.drives * len(task.goals)
        name = " ".join(part for part in (subject.model, subject.condition) if part)
        console.print(
            f"3/3  {number} of {len(conditions)}: the {person} simulated operator drives {drives} times,"
            f" {name}."
        )
        driven = drive_all(setups, config.drives, config.seed, config.jobs, bars=config.bars)
        tables[person] += goal_drive_rows(subject, [trace.measured for trace in driven])
        if person == SHOWN and subject.model in (MODELS[0], None):
            traces[str(subject.condition)] = driven
    rows = [_named(person, row) for person, table in tables.items() for row in table]
    write_results(config.out / "results.json", [*rows, *properties], _about(config, sizes))
    _write_page(config, sizes, task, tables, properties, traces)
    return rows


def _train(config: DemoOptions, sizes: Sizes, model: str) -> list[Row]:
    run = config.out / "runs" / model
    chosen = TrainConfig(
        demonstrations=config.out / "demonstrations",
        model=model,
        out=run,
        seeds=sizes.seeds,
        seed=config.seed,
        state_noise_rad=STATE_NOISE_RAD,
        epochs=sizes.epochs,
    )
    with epoch_bar(config.bars) as report:
        train_run(chosen, report)
    return evaluate_run(run, run, config.seed, folds=0).rows


def _conditions(
    task: TableTop, config: DemoOptions, seeds: int
) -> list[tuple[OperatorName, Subject, list[Setup]]]:
    """Each person with each model (all its seeds in turn), alone and assisted, and with mode switching."""
    steered: list[tuple[str | None, str, Sequence[Controller], Arbitration | None]] = []
    for model in MODELS:
        run = config.out / "runs" / model
        controllers = [LatentController(load_decoder(run, seed)) for seed in range(seeds)]
        steered.append((model, "latent", controllers, None))
        steered.append((model, "latent_assist", controllers, FixedAlpha()))
    steered.append((None, "end_effector", [EndEffectorController(task.robot)], None))
    return [
        (
            person,
            Subject("demo", task=task.name, model=model, condition=condition),
            [Setup(task, one, help_by, PEOPLE[person], TIME_LIMIT_S, arm=config.arm) for one in controllers],
        )
        for person in PEOPLE
        for model, condition, controllers, help_by in steered
        if person == SHOWN or help_by is None
    ]


def _named(person: OperatorName, row: Row) -> Row:
    """The row with the person in its condition, unless it is the one whose drives are shown."""
    return row if person == SHOWN else replace(row, condition=f"{row.condition}, {person}")


def _write_page(
    config: DemoOptions,
    sizes: Sizes,
    task: TableTop,
    tables: Mapping[OperatorName, Sequence[Row]],
    properties: Sequence[Row],
    traces: dict[str, list[Trace]],
) -> None:
    out = config.out
    draw_drives(traces, task, out / "paths.png")
    save_figure(comparison_figure(headline(properties)), out / "properties.png")
    draw_inputs(traces, out / "inputs.png")
    count = config.drives * len(task.goals)
    write_text(
        out / "results.md",
        "# What the demo measured\n\n"
        f"A simulated operator drove a simulated Panda {count} times per column ({config.drives} to each of"
        f" {len(task.goals)} goals; the {sizes.seeds} trained models of a kind take turns),"
        f" seed {config.seed}; mean ± SD over the drives, failed ones included"
        f" (they end after {TIME_LIMIT_S:g} s). No person took part.\n\n"
        f"{_people_tables(tables)}"
        f"The figures show the model {MODELS[0]}, driven by the {SHOWN} operator."
        " ![Paths of the tool](paths.png)\n\n"
        "![Inputs over time](inputs.png)\n\n"
        "## The latent spaces, on held-out episodes\n\n"
        f"Mean ± SD over {sizes.seeds} seeds.\n\n{markdown_table(properties)}\n"
        "![The properties of the latent spaces](properties.png)\n\n"
        "![The task](task.png)\n",
    )


def _people_tables(tables: Mapping[OperatorName, Sequence[Row]]) -> str:
    """A table of drives under the name of each simulated person."""
    return "".join(f"## The {person} operator\n\n{markdown_table(rows)}\n" for person, rows in tables.items())


def _about(config: DemoOptions, sizes: Sizes) -> dict[str, object]:
    """What the figures depend on."""
    return {
        "study": "demo",
        "seed": config.seed,
        "drives_per_goal": config.drives,
        "operator": "simulated",
        "episodes": sizes.episodes,
        "seeds": sizes.seeds,
        "epochs": sizes.epochs,
        "arm": config.arm,
    }


def _claim(config: DemoOptions, sizes: Sizes) -> None:
    """Prepare the folder: a demo with the same options is replaced, anything else is left alone.

    Raises:
        UserError: the folder holds something else, or profiles of people.
    """
    runs = [config.out / "runs" / model for model in MODELS]
    for run in runs:
        if profile_names(run):
            raise UserError(
                f"{run} holds the profiles of people ({', '.join(profile_names(run))}), and the demo would"
                f" train it anew: choose another folder with --out, such as {vacant_name(config.out)}."
            )
    ResultsFolder("demo", MADE).claim(config.out, _about(config, sizes))
    for made in (config.out / "demonstrations", *runs):
        shutil.rmtree(made, ignore_errors=True)


def demo(options: DemoOptions) -> int:
    """Learn latent actions and drive a 7-DoF Panda to three goals, against mode switching.

    In a terminal it ends with the page of `latentarm teleop`. For example: latentarm demo --out demo
    """
    out, json = options.out, options.json
    rows = run_demo(options)
    write_options(out, "demo")
    show(rows, json)
    say(f"Table, figures, datasets and runs are in {out}/ (begin with {out}/results.md).", json)
    run = out / "runs" / MODELS[0]
    if json or not (sys.stdin.isatty() and sys.stdout.isatty()):
        say(f"To drive the arm yourself: latentarm teleop {run}", json)
        return 0
    spec = Spec(run, out=out / "teleop", arm=options.arm)
    serve(TeleopConfig(spec, port=0), partial(say, json=json))
    return 0
