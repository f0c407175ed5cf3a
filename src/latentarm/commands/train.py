"""`latentarm train`: a latent action model from a dataset."""

import sys
from pathlib import Path
from typing import Annotated, Literal

from tyro.conf import arg

from latentarm.commands.choices import ModelName, TaskName
from latentarm.commands.configuration import write_options
from latentarm.commands.options import Datasets, EndEffector, Json, Seed
from latentarm.commands.output import note, say, show
from latentarm.core.context import FeatureName
from latentarm.models.catalogue import DEFAULT_MODEL


def train(
    demonstrations: Datasets,
    model: Annotated[ModelName, arg(help="The latent action model.")] = DEFAULT_MODEL,
    latent_dim: Annotated[int, arg(help="d, the number of axes of the person's interface.")] = 2,
    context: Annotated[
        tuple[FeatureName | Literal["state", "state_belief"], ...],
        arg(
            metavar="FEATURE ...",
            help="What the decoder sees, in order, the joints first: joints, belief, gripper, objects,"
            " objects_in_tool. state and state_belief stand for joints and joints belief.",
        ),
    ] = ("joints",),
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
    hidden: Annotated[
        tuple[int, ...] | None,
        arg(
            metavar="UNITS ...", help="Units of each hidden layer, such as 30 30; the model's own by default."
        ),
    ] = None,
    batch_size: Annotated[
        int | None, arg(help="Pairs per step, at most; the model's own number by default.")
    ] = None,
    kl_weight: Annotated[
        float | None, arg(help="lambda of equations 7 and 8, for vae and cvae; below 1.")
    ] = None,
    goal_entropy: Annotated[
        float,
        arg(
            help="lambda_2 of equation 16: how much it counts that every goal stays open, with the context"
            " joints belief; 0 leaves it out, 5 lets people change their mind."
        ),
    ] = 0.0,
    way_back_m: Annotated[
        float,
        arg(
            help="L, a way back to what was demonstrated: from this far off, a full push also leads back at"
            " the demonstrations' speed, m, such as 0.06. 0 for none."
        ),
    ] = 0.0,
    device: Annotated[Literal["cpu", "cuda", "auto"], arg(help="Where to train.")] = "cpu",
    end_effector: EndEffector = None,
    task: Annotated[
        TaskName | None, arg(help="What the run is driven at later; by the goals of the dataset by default.")
    ] = None,
    out: Annotated[
        Path | None, arg(metavar="DIR", help="Folder of the run; runs/<dataset>-<model> by default.")
    ] = None,
    resume: Annotated[bool, arg(help="Continue an interrupted training.")] = False,
    json: Json = False,
) -> int:
    """Learn a latent action model from a dataset.

    For example: latentarm train --demonstrations pour --model cae --latent-dim 2 --seeds 5
    """
    from latentarm.models.training import epoch_bar
    from latentarm.runs.advice import model_advice
    from latentarm.runs.joined import joined_dataset
    from latentarm.runs.training import TrainConfig, train_run

    names = "-".join(one.resolve().name for one in demonstrations)
    out = out or Path("runs") / f"{names}-{model}"
    config = TrainConfig(
        demonstrations=joined_dataset(demonstrations, out),
        model=model,
        latent_dim=latent_dim,
        context=context,
        seeds=seeds,
        seed=seed,
        window=window,
        state_noise_rad=state_noise_rad,
        held_out=held_out,
        epochs=epochs,
        hidden=hidden,
        batch_size=batch_size,
        kl_weight=kl_weight,
        goal_entropy=goal_entropy,
        way_back_m=way_back_m,
        device=device,
        end_effector=end_effector,
        task=task,
        out=out,
        resume=resume,
    )
    with epoch_bar(not json and sys.stderr.isatty()) as report:
        training = train_run(config, report)

    write_options(config.out, "train")
    note(training.import_warnings)
    show(training.rows, json)
    if advice := model_advice(model, training.episodes):
        say(advice, json)
    say(f"The run is {config.out}/; next: latentarm evaluate {config.out}", json)
    return 0
