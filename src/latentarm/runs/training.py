"""`latentarm train`: a dataset in, a run folder out.

Three kinds of episodes, always whole ones: most train the model, the validation episodes stop its training
early, and the held-out ones do neither: they are for `latentarm evaluate`.
"""

import warnings
from dataclasses import dataclass, fields, replace
from pathlib import Path
from typing import Any, Literal

import numpy as np

from latentarm.alignment.frame_file import save_frames
from latentarm.assistance.annotation import prepared
from latentarm.assistance.entropy import GoalEntropy
from latentarm.core.context import JOINTS, Named, feature_names
from latentarm.core.errors import UserError
from latentarm.core.types import Demonstrations, Row
from latentarm.demonstrations.dataset import read_dataset
from latentarm.demonstrations.split import select_episodes, split_episodes
from latentarm.models.catalogue import MODELS
from latentarm.models.model import LatentActionModel
from latentarm.models.neural import NeuralModel
from latentarm.models.training import Report
from latentarm.robots.catalogue import ROBOTS, load_recorded_robot
from latentarm.robots.kinematics.chain import Chain
from latentarm.robots.model_copy import copy_model
from latentarm.robots.robot import Robot
from latentarm.runs.checks import check_seed
from latentarm.runs.folder import ROBOT, Run, fingerprint, git_commit, run_facts
from latentarm.runs.samples import ALIGN_STREAM, save_samples, take_samples
from latentarm.runs.tasks import routes_seen, usual_task

CHECKPOINT = "training.safetensors"

MOST_NUMBERS = 200_000
"""In the routes of a run's ``config.json``."""

HOLD_OUT_STREAM = 1
"""Keeps this choice apart from everything else that is drawn from the same seed."""


@dataclass(frozen=True)
class TrainConfig:
    """Options of `latentarm train`; its ``--help`` describes each field.

    Attributes:
        demonstrations: folder of a native dataset.
        model: a name in `MODELS`.
        out: the run folder; it must not hold a run yet.
        latent_dim: d.
        context: the features that the decoder sees, in order, the joints first.
        seeds: S, models trained side by side.
        seed: of everything random; the first of the S seeds.
        window: samples that an action may lead ahead or back.
        state_noise_rad: SD of the noise on the states that train the model, rad.
        held_out: share of the episodes that neither train nor stop the model.
        epochs: passes over the training pairs, at most; the model's own number where None.
        hidden: units of each hidden layer; the model's own where None.
        batch_size: pairs per step, at most; the model's own number where None.
        kl_weight: lambda of equations 7 and 8, for models that have it; their own where None.
        goal_entropy: lambda_2 of equation 16; 0 leaves the entropy over goals out of the loss.
        way_back_m: see `LatentActionModel`.
        device: where to train.
        end_effector: site, body or link of the robot's model file; the dataset's where None.
        task: what the run is driven at, a task of the catalogue; by the dataset's goals where None.
        resume: continue an interrupted training.
    """

    demonstrations: Path
    model: str
    out: Path
    latent_dim: int = 2
    context: str | tuple[str, ...] = (JOINTS,)
    seeds: int = 5
    seed: int = 0
    window: int = 5
    state_noise_rad: float = 0.01
    held_out: float = 0.2
    epochs: int | None = None
    hidden: tuple[int, ...] | None = None
    batch_size: int | None = None
    kl_weight: float | None = None
    goal_entropy: float = 0.0
    way_back_m: float = 0.0
    device: Literal["cpu", "cuda", "auto"] = "cpu"
    end_effector: str | None = None
    task: str | None = None
    resume: bool = False

    def __post_init__(self) -> None:
        check_seed(self.seed)


@dataclass(frozen=True)
class Training:
    """The result of a training.

    Attributes:
        rows: the normalised loss on the validation episodes: mean and SD over seeds.
        episodes: of the dataset.
        import_warnings: what importing the dataset warned of.
    """

    rows: list[Row]
    episodes: int
    import_warnings: list[str]


def train_run(config: TrainConfig, report: Report | None = None) -> Training:
    """Train a model on a dataset and write its run folder.

    Args:
        config: what was asked for.
        report: called after each epoch.

    Raises:
        UserError: the dataset cannot be read or lacks what is asked for, the folder holds a run
            already, or a setting makes no sense.
    """
    _check_folder(config)
    demonstrations = prepared(read_dataset(config.demonstrations), config.context)
    robot = None
    if config.end_effector is not None:
        demonstrations = replace(demonstrations, end_effector=config.end_effector)
    if demonstrations.robot in ROBOTS or Path(demonstrations.robot).is_file():
        # Fails now rather than in `evaluate`.
        robot = load_recorded_robot(demonstrations, str(config.demonstrations))
    chain = None if robot is None else robot.chain
    training, held_out = split_episodes(
        demonstrations, config.held_out, np.random.default_rng([HOLD_OUT_STREAM, config.seed])
    )
    model = _model(config)
    checkpoint = config.out / CHECKPOINT
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        model.fit(
            select_episodes(demonstrations, training),
            chain=chain,
            term=_term(config, demonstrations, chain),
            checkpoint=checkpoint,
            report=report,
        )
    said = [*demonstrations.warnings, *(str(warning.message) for warning in caught)]
    run = Run(
        folder=config.out,
        demonstrations=config.demonstrations,
        held_out=tuple(int(index) for index in held_out),
        model=config.model,
        context=feature_names(config.context),
        robot=demonstrations.robot,
        end_effector=demonstrations.end_effector if robot is None else robot.end_effector,
        fingerprint=fingerprint(demonstrations),
        limits=demonstrations.limits,
        task=config.task or usual_task(demonstrations.goals),
        goals=demonstrations.goals,
    )
    facts: dict[str, object] = {"goal_entropy": config.goal_entropy}
    if robot is not None:
        rng = np.random.default_rng([ALIGN_STREAM, config.seed])
        samples = take_samples(model, demonstrations, training, held_out, robot.chain, rng)
        facts["samples"] = save_samples(config.out, samples)
        if samples.motions is not None and model.latent_dim == 2:
            decoders = [model.decoder(seed) for seed in range(model.seeds)]
            facts["frame"] = save_frames(config.out, decoders, robot.chain, samples.motions.context)
        routes = _routes(robot, select_episodes(demonstrations, held_out), config.context)
        run = replace(run, robot_model=_copy_of(robot, config.out), **routes)
    facts |= run_facts(run)
    model.save(config.out, run={**facts, "warnings": said, "git_commit": git_commit()})
    checkpoint.unlink(missing_ok=True)
    for warning in caught:
        warnings.warn(warning.message, stacklevel=2)
    loss = model.validation_loss_
    spread = float(loss.std(ddof=1)) if len(loss) > 1 else None
    row = Row("train", "validation_loss", "1", float(loss.mean()), spread, len(loss), model=config.model)
    return Training([row], len(demonstrations.episodes), demonstrations.warnings)


def _model(config: TrainConfig) -> LatentActionModel:
    model_class = MODELS[config.model]
    networks: dict[str, Any] = {
        "epochs": config.epochs,
        "hidden": config.hidden,
        "batch_size": config.batch_size,
    }
    given: dict[str, Any] = networks | {"kl_weight": config.kl_weight}
    chosen = {name: value for name, value in given.items() if value is not None}
    for name in networks.keys() & chosen.keys():
        if not issubclass(model_class, NeuralModel):
            raise UserError(
                f"The model {config.model} has no network to train: leave --{name.replace('_', '-')} out, or"
                " choose another model."
            )
    if "kl_weight" in chosen and "kl_weight" not in {field.name for field in fields(model_class)}:
        raise UserError(
            f"The model {config.model} has no KL term: leave --kl-weight out, or choose vae or cvae."
        )
    model = model_class(
        latent_dim=config.latent_dim,
        context=feature_names(config.context),
        window=config.window,
        state_noise_rad=config.state_noise_rad,
        seeds=config.seeds,
        seed=config.seed,
        data_seed=config.seed,
        device=config.device,
        way_back_m=config.way_back_m,
    )
    return replace(model, **chosen)


def _term(config: TrainConfig, demonstrations: Demonstrations, chain: Chain | None) -> GoalEntropy | None:
    """The entropy over the demonstrations' goals, where it is asked for.

    Raises:
        UserError: the weight makes no sense, or there are fewer than two goals.
    """
    if config.goal_entropy == 0:
        return None
    if len(demonstrations.goals) < 2:
        raise UserError(
            f"{config.demonstrations} names {len(demonstrations.goals)} goals, and an entropy over goals "
            "needs two or more: leave --goal-entropy out."
        )
    goals = np.stack([goal.configuration for goal in demonstrations.goals])
    return GoalEntropy(goals, weight=config.goal_entropy, chain=chain)


def _routes(robot: Robot, held_out: Demonstrations, context: Named) -> dict[str, Any]:
    """Routes of the held-out episodes, as a run keeps them.

    None are kept without held-out episodes or if they are too large to store.
    """
    try:
        routes, open_at = routes_seen(robot, held_out, context)
    except UserError:
        return {}
    return {"routes": routes, "open_at": open_at} if sum(map(np.size, routes)) <= MOST_NUMBERS else {}


def _copy_of(robot: Robot, run: Path) -> str | None:
    """Copy the robot's model into a run; its name there, None for a robot of the catalogue."""
    if robot.model_path is None:
        return None
    try:
        return copy_model(robot, run / ROBOT)
    except UserError as error:
        message = f"{run} keeps no copy of its robot and needs {robot.model_path}: {error}"
        warnings.warn(message, stacklevel=3)
        return None


def _check_folder(config: TrainConfig) -> None:
    if (config.out / "config.json").exists():
        raise UserError(f"{config.out} holds a run already: choose another folder with --out.")
    unfinished = (config.out / CHECKPOINT).exists()
    if unfinished and not config.resume:
        raise UserError(
            f"{config.out} holds an unfinished training: continue it with --resume, or choose another --out."
        )
    if config.resume and not unfinished:
        raise UserError(f"{config.out} holds no unfinished training to resume.")
