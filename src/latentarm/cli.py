"""The command line: parses, calls, prints.

Exit codes: 0 done, 1 not reached or failed, 2 the user's to mend, 130 interrupted.
"""

import io
import json as json_format
import os
import sys
import warnings
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Literal

import tyro
from tyro.conf import Positional, arg
from tyro.extras import SubcommandApp

from latentarm.errors import UserError

if TYPE_CHECKING:
    from rich.console import RenderableType

    from latentarm.types import Row

ModelName = Literal["pca", "ae", "vae", "cae", "cvae", "cae_zero", "scl", "isometric", "homogeneous"]

Json = Annotated[bool, arg(help="Print one JSON document on standard output and nothing else there.")]
Seed = Annotated[int, arg(help="Seed of everything random.")]
RobotName = Annotated[
    str, arg(help="A robot's name (see `latentarm robots`) or the path of an MJCF or URDF file.")
]
EndEffector = Annotated[
    str | None, arg(help="Site, body or link of the model file that is the end-effector.", metavar="NAME")
]
Dataset = Annotated[Path, arg(metavar="DST", help="Folder of a native dataset.")]
MovedDataset = Annotated[
    Path | None, arg(metavar="DST", help="Where the run's dataset lies now, if it was moved.")
]
Jobs = Annotated[int, arg(help="Processes that measure side by side; -1 is one per core.")]
Backend = Annotated[
    Literal["joblib", "ray", "dask"],
    arg(
        help="Processes of this machine, or a cluster: that of RAY_ADDRESS or DASK_SCHEDULER_ADDRESS,"
        " or else a new one here."
    ),
]
PresetName = Annotated[
    Literal["paper", "smoke"],
    arg(help="The sizes of the paper, or small ones that only show that it runs."),
]

app = SubcommandApp()


def main(arguments: Sequence[str] | None = None) -> int:
    """Run one command.

    Args:
        arguments: the words after ``latentarm``; those of the process by default.

    Returns:
        The exit code.
    """
    if isinstance(sys.stdout, io.TextIOWrapper):
        sys.stdout.reconfigure(errors="replace")  # a terminal without "±" or "…" shows "?" instead
    try:
        with warnings.catch_warnings():
            warnings.showwarning = _warn
            code = app.cli(
                prog="latentarm",
                description="Steer a high-DoF assistive arm with a low-DoF input, by latent actions.",
                args=arguments,
                config=(tyro.conf.FlagCreatePairsOff,),
            )
            sys.stdout.flush()  # a full disk shows here and not after the exit code
            return code
    except UserError as error:
        return _refuse(str(error))
    except BrokenPipeError:
        # Whoever read our output has heard enough; there is nobody left to flush it to.
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return 0
    except OSError as error:
        return _refuse(f"{error.filename or 'The output'} cannot be used: {error.strerror or error}.")
    except KeyboardInterrupt:
        print("latentarm: interrupted.", file=sys.stderr)
        return 130


@app.command
def demo(
    out: Annotated[Path, arg(metavar="DIR", help="Folder for datasets, runs, table and figures.")] = Path(
        "demo"
    ),
    drives: Annotated[int, arg(help="Simulated drives for each goal and condition.")] = 20,
    seed: Seed = 0,
    jobs: Annotated[int, arg(help="Processes that drive side by side; -1 is one per core.")] = -1,
    json: Json = False,
) -> int:
    """Learn latent actions and drive a 7-DoF Panda to three goals, against mode switching.

    In a terminal it ends with the page of `latentarm teleop`. For example: latentarm demo --out demo
    """
    from latentarm.experiments.demo import DemoConfig, run_demo

    bars = not json and sys.stderr.isatty()
    rows = run_demo(DemoConfig(out, drives, seed, jobs, quiet=json, bars=bars))
    _show(rows, json)
    _say(f"Table, figures, datasets and runs are in {out}/ (begin with {out}/results.md).", json)
    run = out / "runs" / "cvae"
    if json or not (sys.stdin.isatty() and sys.stdout.isatty()):
        _say(f"To drive the arm yourself: latentarm teleop {run}", json)
        return 0
    return teleop(run, port=0, out=out / "teleop")


@app.command(name="import")
def import_demonstrations(
    source: Annotated[
        Positional[Path], arg(metavar="SRC", help=".npz, .csv, .hdf5, or a LeRobot v3.0 folder.")
    ],
    destination: Annotated[Positional[Path], arg(metavar="DST", help="New folder for the dataset.")],
    robot: RobotName = "panda",
    end_effector: EndEffector = None,
    rate_hz: Annotated[float | None, arg(help="Sampling rate, for a file that does not say it.")] = None,
    instruction: Annotated[
        str | None, arg(help="What was done, in words, for a file that does not say it.")
    ] = None,
    actions: Annotated[
        Literal["known", "joint_velocity"],
        arg(
            help="Keep recorded actions only where they are known to be joint velocities, or take your word."
        ),
    ] = "known",
    json: Json = False,
) -> int:
    """Turn recorded demonstrations into a native dataset (LeRobotDataset v3.0).

    For example: latentarm import panda_pour_coffee.npz pour
    """
    from latentarm.demonstrations.importing import import_to
    from latentarm.experiments.inspection import summary
    from latentarm.robots.catalogue import load_robot

    demonstrations = import_to(
        source,
        destination,
        load_robot(robot, end_effector),
        rate_hz=rate_hz,
        task=instruction,
        actions=actions,
    )
    if json:
        _show(summary(demonstrations).rows(), json)
    _say(
        f"{len(demonstrations.episodes)} episodes of {demonstrations.dof} joints are in {destination}/.", json
    )
    return 0


@app.command
def inspect(
    dataset: Annotated[Positional[Path], arg(metavar="DST", help="Folder of a native dataset.")],
    out: Annotated[
        Path | None, arg(metavar="DIR", help="Folder for the figure; beside the dataset by default.")
    ] = None,
    json: Json = False,
) -> int:
    """Show a dataset: episodes, rates, ranges, and a figure of the joints.

    For example: latentarm inspect pour
    """
    from latentarm.demonstrations.dataset import read_dataset
    from latentarm.experiments.inspection import draw, summary, summary_tables

    demonstrations = read_dataset(dataset)
    figure = draw(demonstrations, out or dataset.with_name(f"{dataset.name}-figures"))
    _show(summary(demonstrations).rows(), json, *summary_tables(demonstrations))
    _say(f"The joints over time are drawn in {figure}.", json)
    return 0


@app.command
def train(
    demonstrations: Dataset,
    model: Annotated[ModelName, arg(help="The latent action model.")] = "cvae",
    latent_dim: Annotated[int, arg(help="d, the number of axes of the person's interface.")] = 2,
    context: Annotated[
        Literal["state", "state_belief"], arg(help="What the decoder sees: c = s, or c = (s, b).")
    ] = "state",
    seeds: Annotated[int, arg(help="Models trained side by side, from different seeds.")] = 5,
    seed: Seed = 0,
    window: Annotated[int, arg(help="An action leads to a state at most this many samples away.")] = 5,
    state_noise_rad: Annotated[
        float, arg(help="SD of noise on the state that the decoder sees, rad.")
    ] = 0.01,
    held_out: Annotated[float, arg(help="Share of the episodes kept for evaluation.")] = 0.2,
    epochs: Annotated[
        int | None, arg(help="At most this many passes over the pairs; the model's own number by default.")
    ] = None,
    kl_weight: Annotated[
        float | None, arg(help="lambda of equations 7 and 8, for vae and cvae; below 1.")
    ] = None,
    goal_entropy: Annotated[
        float,
        arg(
            help="lambda_2 of equation 16: how much it counts that every goal stays open, with the context"
            " state_belief; 0 leaves it out, 5 lets people change their mind."
        ),
    ] = 0.0,
    device: Annotated[Literal["cpu", "cuda", "auto"], arg(help="Where to train.")] = "cpu",
    end_effector: EndEffector = None,
    out: Annotated[
        Path | None, arg(metavar="DIR", help="Folder of the run; runs/<dataset>-<model> by default.")
    ] = None,
    resume: Annotated[bool, arg(help="Go on with a training that was cut off.")] = False,
    json: Json = False,
) -> int:
    """Learn a latent action model from a dataset.

    For example: latentarm train --demonstrations pour --model cae --latent-dim 2 --seeds 5
    """
    from latentarm.models.training import epoch_bar
    from latentarm.runs.training import TrainConfig, train_run

    config = TrainConfig(
        demonstrations=demonstrations,
        model=model,
        latent_dim=latent_dim,
        context=context,
        seeds=seeds,
        seed=seed,
        window=window,
        state_noise_rad=state_noise_rad,
        held_out=held_out,
        epochs=epochs,
        kl_weight=kl_weight,
        goal_entropy=goal_entropy,
        device=device,
        end_effector=end_effector,
        out=out or Path("runs") / f"{demonstrations.resolve().name}-{model}",
        resume=resume,
    )
    with epoch_bar(not json and sys.stderr.isatty()) as report:
        rows = train_run(config, report)

    _show(rows, json)
    _say(f"The run is {config.out}/; next: latentarm evaluate {config.out}", json)
    return 0


@app.command
def evaluate(
    run: Annotated[Positional[Path], arg(metavar="RUN", help="Folder that `latentarm train` wrote.")],
    out: Annotated[
        Path | None, arg(metavar="DIR", help="Folder for metrics and figures; RUN by default.")
    ] = None,
    demonstrations: MovedDataset = None,
    seed: Seed = 0,
    json: Json = False,
) -> int:
    """Measure a trained model on its held-out episodes: the four properties, drift and reversal.

    For example: latentarm evaluate runs/pour-cae
    """
    from latentarm.experiments.evaluating import evaluate_run

    folder = out or run
    rows = evaluate_run(run, folder, seed, demonstrations)
    _show(rows, json)
    _say(f"metrics.json and figures are in {folder}/.", json)
    return 0


@app.command
def compare(
    demonstrations: Annotated[
        tuple[Path, ...], arg(metavar="DST ...", help="Folders of native datasets, all of one robot.")
    ],
    models: Annotated[
        tuple[str, ...] | None, arg(metavar="MODEL ...", help="Names of models; by default all there are.")
    ] = None,
    noise: Annotated[
        tuple[float, ...] | None,
        arg(metavar="RAD ...", help="SDs of noise on the states, rad; 0.01 and 0.1 by default."),
    ] = None,
    seeds: Annotated[int | None, arg(help="Models of each kind in each fold; 5 by default.")] = None,
    folds: Annotated[int | None, arg(help="Parts of each dataset, each held out once; 5 by default.")] = None,
    reach_pairs: Annotated[
        int | None, arg(help="Starts and goals per fold for the greedy operator; 40 by default.")
    ] = None,
    ours: Annotated[
        str | None, arg(metavar="MODEL", help="The model that is held against the targets, and driven.")
    ] = None,
    preset: Annotated[
        Literal["paper", "smoke"], arg(help="Whole sizes, or small ones that only show that it runs.")
    ] = "paper",
    out: Annotated[Path, arg(metavar="DIR", help="Folder for page, figures and results.json.")] = Path(
        "compared"
    ),
    seed: Seed = 0,
    jobs: Jobs = -1,
    backend: Backend = "joblib",
    json: Json = False,
) -> int:
    """Compare all models on recorded demonstrations: every episode held out once, one table for each dataset.

    For example: latentarm compare --demonstrations pour pick --noise 0.01 0.1
    """
    from dataclasses import replace

    from rich.console import Console

    from latentarm.experiments.compare.preset import OURS, PRESETS
    from latentarm.experiments.compare.run import CompareConfig, run_compare
    from latentarm.experiments.compare.tables import terminal_tables

    usual = PRESETS[preset]
    sizes = replace(
        usual,
        models=usual.models if models is None else models,
        noises_rad=usual.noises_rad if noise is None else noise,
        seeds=usual.seeds if seeds is None else seeds,
        folds=usual.folds if folds is None else folds,
        reach_pairs=usual.reach_pairs if reach_pairs is None else reach_pairs,
    )
    bars = not json and sys.stderr.isatty()
    config = CompareConfig(
        demonstrations, out, sizes, ours or OURS, seed, jobs, backend, quiet=json, bars=bars
    )
    rows = run_compare(config)
    names = [path.resolve().name for path in demonstrations]
    _show(rows, json, *terminal_tables(rows, names, sizes.noises_rad, Console().width))
    _say(f"Page, figures and results.json are in {out}/ (begin with {out}/results.md).", json)
    return 0


@app.command
def align(
    run: Annotated[Positional[Path], arg(metavar="RUN", help="Folder that `latentarm train` wrote.")],
    name: Annotated[str, arg(metavar="NAME", help="Of the person; `drive --profile` takes it.")],
    answers: Annotated[int, arg(help="Questions to be answered, at most.")] = 10,
    seed_index: Annotated[int, arg(help="Which of the run's seeds decodes, from 0.")] = 0,
    simulated: Annotated[
        bool, arg(help="Let a simulated person answer, for whom the stick's axes are those of the base.")
    ] = False,
    demonstrations: MovedDataset = None,
    seed: Seed = 0,
    json: Json = False,
) -> int:
    """Ask what a person means by their input, and keep it as their profile (section 6 of the paper).

    Shows motions and asks for each how they would push the stick for it: numbers from -1 to 1, or arrow keys.
    For example: latentarm align runs/pour-cae --name ada
    """
    from latentarm.experiments.aligning import AlignConfig, align_run

    config = AlignConfig(
        run=run,
        name=name,
        answers=answers,
        seed_index=seed_index,
        simulated=simulated,
        seed=seed,
        dataset=demonstrations,
        progress=not json and sys.stderr.isatty(),
    )
    try:
        rows = align_run(config, lambda sentence: _say(sentence, json))
    except KeyboardInterrupt:
        print("\nNothing is saved.", file=sys.stderr)
        raise
    _show(rows, json)
    whose = "simulated person's profile" if simulated else "profile"
    _say(f"The {whose} is {run}/profiles/{name}/; next: latentarm drive {run} --profile {name}", json)
    return 0


@app.command
def drive(
    run: Annotated[
        Positional[Path | None], arg(metavar="RUN", help="A trained run; without one, mode switching drives.")
    ] = None,
    controller: Annotated[
        Literal["latent", "latent_assist", "end_effector"] | None,
        arg(help="Latent actions, with shared autonomy, or mode switching."),
    ] = None,
    task: Annotated[
        Literal["table_top", "held_out", "reach"] | None,
        arg(help="Items on a table, the way of held-out episodes, or poses in reach; by the run by default."),
    ] = None,
    robot: Annotated[
        str | None,
        arg(help="A robot's name or the path of an MJCF or URDF file; that of the run by default."),
    ] = None,
    end_effector: EndEffector = None,
    profile: Annotated[
        str | None, arg(metavar="NAME", help="A person that `latentarm align` has asked; z = u without.")
    ] = None,
    drives: Annotated[int, arg(help="Drives for each goal.")] = 3,
    beta: Annotated[float, arg(help="Rationality of the simulated operator (equation 24), 1/m².")] = 2000.0,
    belief: Annotated[
        Literal["boltzmann", "distance", "maximum_entropy"],
        arg(help="How inputs change the belief over goals, for help and for models trained on (s, b)."),
    ] = "boltzmann",
    arbitration: Annotated[
        Literal["fixed", "confidence"] | None,
        arg(help="For latent_assist: the same alpha throughout (the default), or more the surer the belief."),
    ] = None,
    alpha: Annotated[
        float | None,
        arg(
            help="For latent_assist: alpha of equation 2 at full input, a share from 0 (the person alone) to"
            " 1 (the robot alone); with confidence the most of it. By default 0.15, with confidence 0.5."
        ),
    ] = None,
    time_limit_s: Annotated[
        float | None, arg(help="A drive that lasts longer has failed: 60 s, 300 s on held-out episodes.")
    ] = None,
    seed: Seed = 0,
    demonstrations: MovedDataset = None,
    record: Annotated[
        Path | None, arg(metavar="DIR", help="Record the drives; exported there as a native dataset.")
    ] = None,
    out: Annotated[Path, arg(metavar="DIR", help="Folder for drives.json and the figure.")] = Path("drives"),
    json: Json = False,
) -> int:
    """Drive an arm in simulation with a simulated operator, through Algorithm 1 and its safety filters.

    Exits with 1 when no drive reached its goal. For example: latentarm drive runs/pour-cae
    """
    from latentarm.experiments.driving import DriveConfig, drive_run

    rows = drive_run(
        DriveConfig(
            run=run,
            controller=controller or ("latent" if run else "end_effector"),
            task=task,
            robot=robot,
            end_effector=end_effector,
            profile=profile,
            drives=drives,
            beta=beta,
            belief=belief,
            arbitration=arbitration,
            alpha=alpha,
            time_limit_s=time_limit_s,
            seed=seed,
            record=record,
            dataset=demonstrations,
            out=out,
        )
    )
    _show(rows, json)
    _say(f"drives.json and the figure are in {out}/.", json)
    return 0 if any(row.measure == "success_rate" and row.mean for row in rows) else 1


@app.command
def teleop(
    run: Annotated[
        Positional[Path | None],
        arg(metavar="RUN", help="A trained run; without one, the end-effector is driven."),
    ] = None,
    host: Annotated[
        str, arg(help="The address that people open; off this machine they need a link that works once.")
    ] = "127.0.0.1",
    port: Annotated[int, arg(help="0 takes any that is free.")] = 8460,
    profile: Annotated[
        str | None, arg(metavar="NAME", help="A person that `latentarm align` has asked; z = u without.")
    ] = None,
    certfile: Annotated[Path | None, arg(metavar="PEM", help="Certificate for TLS.")] = None,
    keyfile: Annotated[Path | None, arg(metavar="PEM", help="Its private key.")] = None,
    seed: Seed = 0,
    out: Annotated[Path, arg(metavar="DIR", help="Folder for what is recorded.")] = Path("teleop"),
    json: Json = False,
) -> int:
    """Drive a simulated arm from a web page: stick, buttons, keyboard, gamepad or switches.

    Prints the page's address; Ctrl-C ends it. For example: latentarm teleop runs/pour-cae
    """
    from latentarm.web.addresses import TeleopConfig
    from latentarm.web.server import serve
    from latentarm.web.setting import Spec

    def say(sentence: str) -> None:
        _say(sentence, json)
        sys.stdout.flush()  # whoever reads us through a pipe waits for the address

    def ready(address: str) -> None:
        if json:
            print(json_format.dumps({"address": address}), flush=True)

    config = TeleopConfig(Spec(run, profile, seed, out), host, port, certfile, keyfile)
    serve(config, say, ready)
    return 0


studies = app.command(
    SubcommandApp(), name="reproduce", help="Reproduce a study of the paper; `reproduce --help` lists them."
)


@studies.command
def properties(
    preset: PresetName = "paper",
    task: Annotated[
        Literal["all", "sine", "rotate", "circle", "reach"], arg(help="One of the tasks, or all four.")
    ] = "all",
    out: Annotated[Path, arg(metavar="DIR", help="Folder for page, figures and results.json.")] = Path(
        "reproduced/properties"
    ),
    seed: Seed = 0,
    jobs: Jobs = -1,
    backend: Backend = "joblib",
    json: Json = False,
) -> int:
    """Measure the four properties of all models on the paper's planar tasks (section 8.1), simulated.

    For example: latentarm reproduce properties --preset smoke --task sine
    """
    from latentarm.experiments.properties.preset import PRESETS
    from latentarm.experiments.properties.run import PropertiesConfig, run_properties
    from latentarm.tasks.planar.catalogue import MOTIONS

    tasks = tuple(MOTIONS) if task == "all" else (task,)
    bars = not json and sys.stderr.isatty()
    config = PropertiesConfig(out, PRESETS[preset], tasks, seed, jobs, backend, quiet=json, bars=bars)
    rows = run_properties(config)
    _show(rows, json, *_tables_by_task(rows))
    _say(f"Page, figures and results.json are in {out}/ (begin with {out}/results.md).", json)
    return 0


@studies.command(name="shared-autonomy")
def shared_autonomy(
    preset: PresetName = "paper",
    task: Annotated[
        Literal["all", "planar_two_cups", "panda_two_cups"],
        arg(help="Two cups before one of the arms, or before both."),
    ] = "all",
    out: Annotated[Path, arg(metavar="DIR", help="Folder for page, figures and results.json.")] = Path(
        "reproduced/shared-autonomy"
    ),
    seed: Seed = 0,
    jobs: Jobs = -1,
    backend: Backend = "joblib",
    json: Json = False,
) -> int:
    """Let simulated people reach and change goals with help and without (section 8.2).

    For example: latentarm reproduce shared-autonomy --preset smoke
    """
    from latentarm.experiments.shared_autonomy.cell import TASKS
    from latentarm.experiments.shared_autonomy.preset import PRESETS
    from latentarm.experiments.shared_autonomy.run import SharedAutonomyConfig, run_shared_autonomy
    from latentarm.experiments.shared_autonomy.summary import summary_tables

    tasks = tuple(TASKS) if task == "all" else (task,)
    bars = not json and sys.stderr.isatty()
    config = SharedAutonomyConfig(out, PRESETS[preset], tasks, seed, jobs, backend, quiet=json, bars=bars)
    rows = run_shared_autonomy(config)
    _show(rows, json, *summary_tables(rows))
    _say(f"Page, figures and results.json are in {out}/ (begin with {out}/results.md).", json)
    return 0


@studies.command
def alignment(
    preset: PresetName = "paper",
    task: Annotated[
        Literal["all", "plane", "pour", "reach_and_pour", "table_top"],
        arg(help="One of the paper's tasks, drives at the demo's table, or all of it."),
    ] = "all",
    out: Annotated[Path, arg(metavar="DIR", help="Folder for page, figures and results.json.")] = Path(
        "reproduced/alignment"
    ),
    seed: Seed = 0,
    jobs: Jobs = -1,
    backend: Backend = "joblib",
    json: Json = False,
) -> int:
    """Learn from few answers what simulated people mean by their stick (section 8.3), on a simulated Panda.

    For example: latentarm reproduce alignment --preset smoke --task plane
    """
    from latentarm.experiments.alignment.preset import PRESETS
    from latentarm.experiments.alignment.run import TASKS, AlignmentConfig, run_alignment
    from latentarm.experiments.alignment.summary import summary_tables

    tasks = TASKS if task == "all" else (task,)
    bars = not json and sys.stderr.isatty()
    config = AlignmentConfig(out, PRESETS[preset], tasks, seed, jobs, backend, quiet=json, bars=bars)
    rows = run_alignment(config)
    _show(rows, json, *summary_tables(rows, config.preset))
    _say(f"Page, figures and results.json are in {out}/ (begin with {out}/results.md).", json)
    return 0


@app.command
def bench(
    repeats: Annotated[int, arg(help="Timed online steps.")] = 20_000,
    seed: Seed = 0,
    json: Json = False,
) -> int:
    """Time the online step with 3 goals and 50, beside torch, and ten seeds in one fit beside ten in turn.

    For example: latentarm bench --json
    """
    from latentarm.experiments.bench import run_bench

    rows = run_bench(repeats=repeats, seed=seed, progress=not json and sys.stderr.isatty())
    _show(rows, json)
    return 0


@app.command
def robots(
    robot: Annotated[
        Positional[str | None],
        arg(metavar="ROBOT", help="One robot, by name or path; all known ones without."),
    ] = None,
    end_effector: EndEffector = None,
    json: Json = False,
) -> int:
    """List the robots, or show one: joints, limits and end-effector.

    For example: latentarm robots panda
    """
    from latentarm.experiments.robot_sheet import describe, sheets

    if json:
        print(json_format.dumps(describe(robot, end_effector), indent=2))
    else:
        _print(*sheets(robot, end_effector))
    return 0


def _show(rows: "Sequence[Row]", json: bool, *tables: "RenderableType") -> None:
    """Print rows as one JSON document, or as the tables given, or else as a table of all rows."""
    if json:
        print(json_format.dumps([row.as_json() for row in rows], indent=2))
    elif tables:
        _print(*tables)
    else:
        from rich.console import Console

        from latentarm.metrics.table import rich_tables

        _print(rich_tables(rows, width=Console().width))


def _tables_by_task(rows: "Sequence[Row]") -> "list[RenderableType]":
    """One table per task, of the rows without a condition."""
    from rich.console import Console

    from latentarm.metrics.table import rich_tables

    width = Console().width
    main_rows = [row for row in rows if row.condition is None]
    return [
        rich_tables([row for row in main_rows if row.task == task], title=f"{task}, simulated", width=width)
        for task in dict.fromkeys(row.task for row in main_rows)
    ]


def _say(sentence: str, json: bool) -> None:
    """Tell a person; with ``--json`` on standard error, so that standard output stays one document."""
    print(sentence, file=sys.stderr if json else sys.stdout)


def _refuse(sentence: str) -> int:
    """Say what the user can mend; the exit code for that."""
    print(f"latentarm: {sentence}", file=sys.stderr)
    return 2


def _warn(message: Warning | str, *where: object) -> None:
    """A warning as the sentence that it is, without the line of code that gave it."""
    print(f"latentarm: warning: {message}", file=sys.stderr)


def _print(*renderables: "RenderableType") -> None:
    from rich.console import Console

    console = Console()
    for renderable in renderables:
        console.print(renderable)


if __name__ == "__main__":
    sys.exit(main())
