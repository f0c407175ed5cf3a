"""`latentarm drive`: simulated drives with a simulated operator."""

import sys
from pathlib import Path
from typing import Annotated, Literal

from tyro.conf import Positional, arg

from latentarm.commands.configuration import write_options
from latentarm.commands.options import EndEffector, Jobs, Json, LimitsFile, MovedDataset, Seed
from latentarm.commands.output import note, say, show


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
    limits: LimitsFile = None,
    profile: Annotated[
        str | None, arg(metavar="NAME", help="A person that `latentarm align` has asked; z = u without.")
    ] = None,
    drives: Annotated[int, arg(help="Drives for each goal.")] = 3,
    operator: Annotated[
        Literal["greedy", "planning"] | None,
        arg(
            help="Simulated operator: greedy looks one step ahead (equation 24), planning looks up to 4 s"
            " ahead where one step leads no nearer. By default planning on held-out episodes, else greedy."
        ),
    ] = None,
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
    jobs: Jobs = -1,
    demonstrations: MovedDataset = None,
    record: Annotated[
        Path | None, arg(metavar="DIR", help="Record the drives; exported there as a native dataset.")
    ] = None,
    out: Annotated[
        Path, arg(metavar="DIR", help="Folder for drives.json, drives.csv and the figure.")
    ] = Path("drives"),
    json: Json = False,
) -> int:
    """Drive an arm in simulation with a simulated operator, through Algorithm 1 and its safety filters.

    Exits with 1 when no drive reached its goal. For example: latentarm drive runs/pour-cae
    """
    from latentarm.simulation.drive_table import endings_in_words
    from latentarm.simulation.drives import DriveConfig, drive_run

    driven = drive_run(
        DriveConfig(
            run=run,
            controller=controller or ("latent" if run else "end_effector"),
            task=task,
            robot=robot,
            end_effector=end_effector,
            limits=limits,
            profile=profile,
            drives=drives,
            operator=operator,
            beta=beta,
            belief=belief,
            arbitration=arbitration,
            alpha=alpha,
            time_limit_s=time_limit_s,
            seed=seed,
            jobs=jobs,
            record=record,
            dataset=demonstrations,
            out=out,
            bars=not json and sys.stderr.isatty(),
        ),
        note,
    )
    write_options(
        out,
        "drive",
        controller=driven.controller,
        operator=driven.operator,
        task=driven.task,
        time_limit_s=driven.time_limit_s,
    )
    show(driven.rows, json)
    for sentence in endings_in_words(driven.entries):
        say(sentence, json)
    say(f"One row per drive is in {out}/drives.csv; drives.json and paths.png are beside it.", json)
    return 0 if any(entry["success"] for entry in driven.entries) else 1
