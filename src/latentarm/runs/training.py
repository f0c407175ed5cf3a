"""`latentarm train`: a dataset in, a run folder out.

Three kinds of episodes, always whole ones: most train the model, the validation episodes stop its training
early, and the held-out ones do neither: they are for `latentarm evaluate`.
"""

import warnings
from collections.abc import Sequence
from dataclasses import dataclass, fields, replace
from pathlib import Path
from typing import Any, Final

import numpy as np

from latentarm.alignment.frame_file import save_frames
from latentarm.assistance.annotation import prepared
from latentarm.core.context import JOINTS, OBJECTS_IN_TOOL, Named, feature_names
from latentarm.core.errors import UserError
from latentarm.core.types import Demonstrations, Row
from latentarm.core.untrusted.opening import is_missing
from latentarm.demonstrations.dataset import read_dataset, write_dataset
from latentarm.demonstrations.importers.source import join
from latentarm.demonstrations.split import select_episodes, split_episodes
from latentarm.demonstrations.things import ENVIRONMENT
from latentarm.demonstrations.timing import check_one_rate
from latentarm.models.catalogue import KINDS
from latentarm.models.estimators import MODELS
from latentarm.models.goal_entropy import GoalEntropy
from latentarm.models.model import LatentActionModel
from latentarm.models.neural import NeuralModel
from latentarm.models.scaling import STILL
from latentarm.models.training import Report
from latentarm.robots.catalogue import ROBOTS, load_recorded_robot
from latentarm.robots.kinematics.chain import Chain
from latentarm.robots.kinematics.pose_rows import STORED
from latentarm.robots.model_copy import copy_model
from latentarm.robots.robot import Robot
from latentarm.runs.folder import ROBOT, Run, fingerprint, git_commit, run_facts
from latentarm.runs.options import TrainOptions
from latentarm.runs.samples import ALIGN_STREAM, save_samples, take_samples
from latentarm.runs.tasks import routes_seen, usual_task

CHECKPOINT: Final = "training.safetensors"
JOINED: Final = "demonstrations"
"""Folder of a run with the datasets that it was trained on, where there were several."""

MOST_NUMBERS = 200_000  # most numbers in the routes of a run's ``config.json``
HOLD_OUT_STREAM = 1  # stream of the seed that chooses the held-out episodes


@dataclass(frozen=True)
class TrainedRun:
    """The result of a training."""

    rows: list[Row]  # the normalised loss on the validation episodes: mean and SD over seeds
    episodes: int
    import_warnings: list[str]
    context: tuple[str, ...]  # what the decoder sees
    objects: tuple[str, ...]  # the things among it, which a drive must know where to find


def train_run(options: TrainOptions, report: Report | None = None) -> TrainedRun:
    """Train a model on a dataset and write its run folder.

    Raises UserError where the dataset cannot be read or lacks something, the folder holds a run already, or a
    setting makes no sense.
    """
    folder = options.folder
    _check_folder(folder, options.resume)
    dataset = _joined_dataset(options.demonstrations, folder)
    demonstrations = read_dataset(dataset)
    robot = None
    if options.end_effector is not None:
        demonstrations = replace(demonstrations, end_effector=options.end_effector)
    if demonstrations.robot in ROBOTS or Path(demonstrations.robot).is_file():
        # Fails now rather than in `evaluate`.
        robot = load_recorded_robot(demonstrations, str(dataset))
    chain = None if robot is None else robot.chain
    context = feature_names(options.context or _usual_context(options.model, demonstrations, chain))
    demonstrations = prepared(demonstrations, context)
    training, held_out = split_episodes(
        demonstrations, options.held_out, np.random.default_rng([HOLD_OUT_STREAM, options.seed])
    )
    model = _model(options, context, arm_known=robot is not None)
    checkpoint = folder / CHECKPOINT
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        model.fit(
            select_episodes(demonstrations, training),
            chain=chain,
            term=_term(options.goal_entropy, demonstrations, chain, dataset),
            checkpoint=checkpoint,
            report=report,
        )
    said = [*demonstrations.warnings, *(str(warning.message) for warning in caught)]
    run = Run(
        folder=folder,
        demonstrations=dataset,
        held_out=tuple(int(index) for index in held_out),
        model=options.model,
        context=context,
        robot=demonstrations.robot,
        end_effector=demonstrations.end_effector if robot is None else robot.end_effector,
        fingerprint=fingerprint(demonstrations),
        limits=demonstrations.limits,
        task=options.task or usual_task(demonstrations),
        goals=demonstrations.goals,
    )
    facts: dict[str, object] = {"goal_entropy": options.goal_entropy}
    if robot is not None:
        rng = np.random.default_rng([ALIGN_STREAM, options.seed])
        samples = take_samples(model, demonstrations, training, held_out, robot.chain, rng)
        facts["samples"] = save_samples(folder, samples)
        if samples.motions is not None and model.latent_dim == 2:
            decoders = [model.decoder(seed) for seed in range(model.seeds)]
            facts["frame"] = save_frames(folder, decoders, robot.chain, samples.motions.context)
        routes = _routes(robot, select_episodes(demonstrations, held_out), context)
        run = replace(run, robot_model=_copy_of(robot, folder), **routes)
    facts |= run_facts(run)
    model.save(folder, run={**facts, "warnings": said, "git_commit": git_commit()})
    checkpoint.unlink(missing_ok=True)
    for warning in caught:
        warnings.warn(warning.message, stacklevel=2)
    loss = model.validation_loss_
    spread = float(loss.std(ddof=1)) if len(loss) > 1 else None
    row = Row("train", "validation_loss", "1", float(loss.mean()), spread, len(loss), model=options.model)
    objects = model.trained_.layout.objects
    return TrainedRun([row], len(demonstrations.episodes), demonstrations.warnings, context, objects)


def _joined_dataset(datasets: Sequence[Path], run: Path) -> Path:
    """The one dataset, or all that are named, joined in the run's folder; UserError where they do not fit."""
    if not datasets:
        raise UserError("No dataset is named: say which with --demonstrations.")
    if len(datasets) == 1:
        return datasets[0]
    joined = join({str(one): read_dataset(one) for one in datasets})
    check_one_rate(joined, [str(index) for index in range(len(joined.episodes))], str(run / JOINED))
    # A training that was broken off has written it already.
    if is_missing(run / JOINED) or fingerprint(read_dataset(run / JOINED)) != fingerprint(joined):
        write_dataset(joined, run / JOINED)
    return run / JOINED


def _usual_context(model: str, demonstrations: Demonstrations, chain: Chain | None) -> tuple[str, ...]:
    """What a decoder sees unless features are named: the joints, and the things that were moved.

    A thing that stood still all the time tells nothing, and would be asked for in every drive.
    """
    things = [episode.extras.get(ENVIRONMENT) for episode in demonstrations.episodes]
    told = [one for one in things if one is not None]
    if not (KINDS[model].sees_context and chain and demonstrations.objects and len(told) == len(things)):
        return (JOINTS,)
    place = np.concatenate(told).reshape(-1, len(demonstrations.objects), STORED)[..., :3]
    return (JOINTS, OBJECTS_IN_TOOL) if (place.std(axis=0) > STILL[OBJECTS_IN_TOOL]).any() else (JOINTS,)


def _model(options: TrainOptions, context: tuple[str, ...], *, arm_known: bool) -> LatentActionModel:
    """The model of these options, with those of its parameters that are options and not None.

    A way back needs the arm's kinematics, so it is a default only where the arm is known.
    """
    model_class = MODELS[options.model]
    parameters = {field.name for field in fields(model_class) if field.init}
    given = {name: value for name, value in vars(options).items() if value is not None}
    for name in ("epochs", "hidden", "batch_size"):
        if name in given and not issubclass(model_class, NeuralModel):
            raise UserError(
                f"The model {options.model} has no network to train: leave --{name.replace('_', '-')} out, or"
                " choose another model."
            )
    if "kl_weight" in given and "kl_weight" not in parameters:
        raise UserError(
            f"The model {options.model} has no KL term: leave --kl-weight out, or choose vae or cvae."
        )
    if options.way_back_m is None and arm_known:
        given["way_back_m"] = KINDS[options.model].way_back_m
    given |= {"context": context, "data_seed": options.seed}
    return model_class(**{name: value for name, value in given.items() if name in parameters})


def _term(
    weight: float, demonstrations: Demonstrations, chain: Chain | None, dataset: Path
) -> GoalEntropy | None:
    """The entropy over the demonstrations' goals, if its weight is not 0."""
    if weight == 0:
        return None
    if len(demonstrations.goals) < 2:
        raise UserError(
            f"{dataset} names {len(demonstrations.goals)} goals, and an entropy over goals "
            "needs two or more: leave --goal-entropy out."
        )
    goals = np.stack([goal.configuration for goal in demonstrations.goals])
    return GoalEntropy(goals, weight=weight, chain=chain)


def _routes(robot: Robot, held_out: Demonstrations, context: Named) -> dict[str, Any]:
    """Routes of the held-out episodes for a run; none without such episodes or if they are too large."""
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


def _check_folder(folder: Path, resume: bool) -> None:
    if (folder / "config.json").exists():
        raise UserError(f"{folder} holds a run already: choose another folder with --out.")
    unfinished = (folder / CHECKPOINT).exists()
    if unfinished and not resume:
        raise UserError(
            f"{folder} holds an unfinished training: continue it with --resume, or choose another --out."
        )
    if resume and not unfinished:
        raise UserError(f"{folder} holds no unfinished training to resume.")
