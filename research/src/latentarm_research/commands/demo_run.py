"""The parts of `latentarm demo`: demonstrate, learn, drive, and write what came of it."""

import shutil
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Final, final

import numpy as np
from threadpoolctl import threadpool_limits

from latentarm.alignment.profile import profile_names
from latentarm.assistance.assistance import AssistanceRule
from latentarm.assistance.blending import FixedAlpha
from latentarm.assistance.controllers.contract import Controller
from latentarm.assistance.controllers.end_effector import EndEffectorController
from latentarm.assistance.controllers.latent import LatentController
from latentarm.assistance.goal_blending import blending
from latentarm.core.context import JOINTS, OBJECTS_IN_TOOL
from latentarm.core.errors import UserError
from latentarm.core.files import write_text
from latentarm.core.parallel import run_grid
from latentarm.core.types import Row
from latentarm.core.untrusted.console import VisibleConsole
from latentarm.demonstrations.dataset import write_dataset
from latentarm.evaluation.looks import look_of
from latentarm.evaluation.results import as_document
from latentarm.evaluation.summary import Subject
from latentarm.evaluation.table import markdown_table
from latentarm.models.catalogue import DEFAULT_MODEL
from latentarm.models.saving import load_decoder
from latentarm.runs.evaluating import evaluate_run
from latentarm.runs.options import EvaluateOptions, TrainOptions
from latentarm.runs.results_folder import vacant_name, write_json
from latentarm.runs.training import train_run
from latentarm.tasks.eating.marshmallows import Marshmallows
from latentarm.tasks.place import Place
from latentarm_research.commands.demo_page import FILM, film, held_in_words, readme_table
from latentarm_research.drives.arm_figure import draw_task
from latentarm_research.drives.demonstrate import demonstrate
from latentarm_research.drives.drive import Setup
from latentarm_research.drives.drive_figures import draw_drives, draw_inputs, marks_of_first_steps
from latentarm_research.drives.drives import Planned, drive_all, plan_drives
from latentarm_research.drives.trace import Trace
from latentarm_research.metrics.drives import drive_rows
from latentarm_research.metrics.ending import STUCK_S
from latentarm_research.people.catalogue import PEOPLE
from latentarm_research.people.names import OperatorName
from latentarm_research.studies.fitting import STATE_NOISE_RAD
from latentarm_research.studies.page import render_page
from latentarm_research.studies.results_folder import ResultsFolder

if TYPE_CHECKING:
    from latentarm_research.commands.demo import DemoOptions

MODELS: Final = tuple(dict.fromkeys((DEFAULT_MODEL, "cvae")))  # the default model and the paper's
CONTEXT: Final[Mapping[str, tuple[str, ...]]] = {DEFAULT_MODEL: (JOINTS, OBJECTS_IN_TOOL), "cvae": (JOINTS,)}
HIDDEN: Final = (64, 64)
BATCH_SIZE: Final = 256  # units of each hidden layer and pairs per step, as in the study of the tasks
TASK: Final = Marshmallows()

ARM: Final = "mujoco"  # what moves: only in physics is food held

SHOWN: Final[OperatorName] = "greedy"
"""Whose drives the figures show, and who is helped as well: the paper's simulated person (equation 24)."""

DRIVERS: Final[tuple[OperatorName, ...]] = tuple(person for person in PEOPLE if person != "planning")
"""Who drives: everybody but the person who plans, each of whose drives takes 20 s and more to compute."""

MADE = ("results.json", "results.md", "paths.png", "inputs.png", "task.png", FILM)
"""Every file of the folder except its options, the dataset and the runs."""


@dataclass(frozen=True)
class Sizes:
    """How much is learned from; only tests take other sizes."""

    name: str = "demo"
    episodes: int = 230  # demonstrations, of some 5 s each
    seeds: int = 3  # models of each kind, trained together and driven in turn
    # passes over the training pairs, at most, by model
    epochs: Mapping[str, int] = field(default_factory=lambda: EPOCHS)


EPOCHS: Final = {DEFAULT_MODEL: 2, "cvae": 30}
"""Of the default model chosen on drives of another seed; the cVAE's validation loss has settled."""

USUAL = Sizes()


@dataclass(frozen=True)
class Shown:
    """Results of the demo."""

    rows: list[Row]  # figures of the drives: mean and SD over all of a condition
    said: tuple[str, ...]  # what happened to the food, and why anything is missing, in sentences


def run_demo(config: "DemoOptions", sizes: Sizes = USUAL) -> Shown:
    """Run the whole demo and write its results to ``config.out``."""
    _claim(config, sizes)
    console = VisibleConsole(stderr=True, quiet=config.json)
    task = TASK
    console.print(
        f"1/3  A simulated person guides a fork into marshmallows {sizes.episodes} times, in physics."
    )
    demonstrations, _ = demonstrate(task, sizes.episodes, config.seed, config.jobs, bars=config.bars)
    write_dataset(demonstrations, config.out / "demonstrations")
    draw_task(_place(task, config.seed), demonstrations, config.out / "task.png")
    console.print(
        f"2/3  {' and '.join(MODELS)} learn 2-D latent actions, {sizes.seeds} seeds of each at once."
    )
    properties = _learn_all(config, sizes)
    conditions = _conditions(task, config, sizes.seeds)
    number = sum(len(one.planned) for one in conditions)
    console.print(f"3/3  Simulated operators drive {number} times, in {len(conditions)} conditions.")
    driven = drive_all([one.planned for one in conditions], config.jobs, bars=config.bars)
    tables: dict[OperatorName, list[Row]] = {person: [] for person in DRIVERS}
    for condition, traces in zip(conditions, driven, strict=True):
        tables[condition.person] += drive_rows(condition.subject, [trace.figures for trace in traces])
    rows = [_named(person, row) for person, table in tables.items() for row in table]
    about = _about(config, sizes)
    write_json(config.out / "results.json", as_document([*rows, *properties], about))
    shown = [(one, traces) for one, traces in zip(conditions, driven, strict=True) if one.person == SHOWN]
    held = held_in_words({condition.name: traces for condition, traces in shown})
    filmed = film(config.out, MODELS[0], shown[0][0].planned, shown[0][1])
    _draw({str(one.subject.condition): traces for one, traces in shown if one.drawn}, config.out)
    text = render_page(
        "commands/demo.md",
        sizes,
        task=task,
        shown=SHOWN,
        drives=config.drives,
        others=config.others,
        seed=config.seed,
        stuck_s=STUCK_S,
        held=held,
        filmed=filmed,
        readme_table=readme_table(tables[SHOWN]),
        tables={person: markdown_table(table) for person, table in tables.items()},
        model=MODELS[0],
        properties=markdown_table(properties),
    )
    write_text(config.out / "results.md", text)
    return Shown(rows, (held, filmed.said))


def _place(task: Marshmallows, seed: int) -> Place:
    """The task with the marshmallows where they lie in one run."""
    begun = task.begin(0, np.random.default_rng(seed))
    return Place(task.robot, begun.goals, task.obstacles)


def _draw(shown: Mapping[str, Sequence[Trace]], out: Path) -> None:
    """Draw drives by condition."""
    marks = marks_of_first_steps(next(iter(shown.values())))
    draw_drives(shown, marks, out / "paths.png")
    draw_inputs(shown, out / "inputs.png")


def _learn_all(config: "DemoOptions", sizes: Sizes) -> list[Row]:
    """Train and measure the models, side by side."""
    learn = partial(_learn, config, sizes)
    found = run_grid(learn, MODELS, jobs=config.jobs, label=str, bars=config.bars, unit="models")
    return [row for rows in found for row in rows]


def _learn(config: "DemoOptions", sizes: Sizes, model: str) -> list[Row]:
    run = config.out / "runs" / model
    chosen = TrainOptions(
        demonstrations=(config.out / "demonstrations",),
        model=model,
        out=run,
        seeds=sizes.seeds,
        seed=config.seed,
        state_noise_rad=STATE_NOISE_RAD,
        epochs=sizes.epochs[model],
        context=CONTEXT[model],
        hidden=HIDDEN,
        batch_size=BATCH_SIZE,
        task=TASK.name,
    )
    with threadpool_limits(limits=1):
        train_run(chosen)
        return evaluate_run(EvaluateOptions(run, folds=0, seed=config.seed)).rows


@final
@dataclass(frozen=True, eq=False)
class _Condition:
    """Who drives with what."""

    person: OperatorName  # who drives
    subject: Subject  # of the figures
    planned: Sequence[Planned]  # their drives; all seeds of a model take turns

    @property
    def name(self) -> str:
        """What steers, in words."""
        return ", ".join(look_of(part).label for part in (self.subject.model, self.subject.condition) if part)

    @property
    def drawn(self) -> bool:
        """Whether figures show it."""
        return self.subject.model in (MODELS[0], None)


def _conditions(task: Marshmallows, config: "DemoOptions", seeds: int) -> list[_Condition]:
    """The shown person with everything, the others without help, with the default model or mode switching."""
    steered: list[tuple[str | None, str, Sequence[Controller], AssistanceRule | None]] = []
    for model in MODELS:
        run = config.out / "runs" / model
        controllers = [LatentController(load_decoder(run, seed)) for seed in range(seeds)]
        steered.append((model, "latent", controllers, None))
        steered.append((model, "latent_assist", controllers, blending(FixedAlpha())))
    steered.append((None, "end_effector", [EndEffectorController(task.robot)], None))
    return [
        _Condition(
            person,
            Subject("demo", task=task.name, model=model, condition=condition),
            plan_drives(
                [[Setup(task, one, PEOPLE[person], help_by, ARM) for one in controllers]],
                config.drives if person == SHOWN else config.others,
                config.seed,
            ),
        )
        for person in DRIVERS
        for model, condition, controllers, help_by in steered
        if person == SHOWN or (help_by is None and model in (MODELS[0], None))
    ]


def _named(person: OperatorName, row: Row) -> Row:
    """The row with the person in its condition, unless it is the one whose drives are shown."""
    return row if person == SHOWN else replace(row, condition=f"{row.condition}, {person}")


def _about(config: "DemoOptions", sizes: Sizes) -> dict[str, object]:
    """Settings that the figures depend on."""
    return {
        "study": "demo",
        "seed": config.seed,
        "drives_per_choice": config.drives,
        "operator": "simulated",
        "episodes": sizes.episodes,
        "seeds": sizes.seeds,
        "epochs": dict(sizes.epochs),
        "task": TASK.name,
        "arm": ARM,
    }


def _claim(config: "DemoOptions", sizes: Sizes) -> None:
    """Prepare the folder: a demo with the same options is replaced, anything else is left alone."""
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
