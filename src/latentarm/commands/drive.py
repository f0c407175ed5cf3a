"""`latentarm drive`: simulated drives with a simulated operator."""

from pathlib import Path
from typing import Annotated, Literal

from tyro.conf import Positional, arg

from latentarm.commands.options import EndEffector, Json, MovedDataset, Seed
from latentarm.commands.output import say, show


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
    show(rows, json)
    say(f"drives.json and the figure are in {out}/.", json)
    return 0 if any(row.measure == "success_rate" and row.mean for row in rows) else 1
