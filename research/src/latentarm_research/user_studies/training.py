"""What conditions with latent actions need beforehand: demonstrations, models, and people's alignments."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Final, final

import numpy as np
from threadpoolctl import threadpool_limits

from latentarm.alignment.contract import Alignment, identity
from latentarm.assistance.annotation import annotated
from latentarm.assistance.boltzmann import BoltzmannBelief
from latentarm.core.context import BELIEF
from latentarm.core.errors import UserError
from latentarm.core.types import Demonstrations, Episode
from latentarm.models.decoder import Decoder
from latentarm.models.kind import TrainedModel
from latentarm.models.model import LatentActionModel
from latentarm.tasks.scene_task import SceneTask
from latentarm_research.drives.demonstrate import Demonstration, dataset_of, demonstrate_once
from latentarm_research.people.traits import Traits
from latentarm_research.studies.fitting import fit_model, validation_episodes
from latentarm_research.studies.streams import generator, integer, sequence
from latentarm_research.user_studies.alignments import PRIORS, Aligned, learn_alignments
from latentarm_research.user_studies.definition import Aligns, Condition, Definition, StudyTask
from latentarm_research.user_studies.scenes import scene_of
from latentarm_research.user_studies.sizes import LEAST_DEMONSTRATIONS, Sizes, Stream

MOST_TRIES: Final = 10
"""Demonstrations for each that succeeds, at most."""

ModelKey = tuple[str, tuple[str, ...]]
"""Kind of a model and the features of its context."""


@final
@dataclass(frozen=True, eq=False)
class TrainingCell:
    """The models of one task."""

    definition: Definition  # of the study
    task: StudyTask  # that is demonstrated
    # who will drive, in order: where a condition aligns, they are asked what they mean
    people: tuple[Traits, ...]
    sizes: Sizes  # of the run
    seed: int  # of the run


@final
@dataclass(frozen=True, eq=False)
class Trained:
    """The result of a `TrainingCell`."""

    task: str  # name of the task
    models: Mapping[ModelKey, TrainedModel]  # by kind and context
    aligned: Aligned | None  # what was learned of the people; None where no condition aligns
    episodes: int  # demonstrations that were learned from
    seconds: float  # how long these took together, s

    def decoder(self, condition: Condition) -> Decoder | None:
        """The decoder that a condition drives with; None without latent actions."""
        return Decoder(self.models[condition.model, condition.context], 0) if condition.model else None

    def alignment(self, condition: Condition, number: int) -> Alignment:
        """The alignment that a condition uses for the person with this number."""
        if condition.aligns == "none" or self.aligned is None:
            return identity
        return self.aligned.alignments[condition.aligns][number]


def train(cell: TrainingCell) -> Trained:
    """Demonstrate, fit the models that the study's conditions need, and learn the people's alignments."""
    latent = [condition for condition in cell.definition.conditions if condition.model]
    keys = list(dict.fromkeys((condition.model, condition.context) for condition in latent))
    aligns: list[Aligns] = [way for way in PRIORS if any(condition.aligns == way for condition in latent)]
    with threadpool_limits(limits=1):
        task = scene_of(cell.task.scene)
        belief = any(BELIEF in context for _, context in keys)
        demonstrations, seconds = _demonstrated(cell, task, belief)
        models = {key: _fitted(cell, task, demonstrations, *key) for key in keys}
        aligned: Aligned | None = None
        if aligns:
            aligned = learn_alignments(
                models[keys[0]],
                demonstrations,
                task.robot.chain,
                cell.people,
                aligns,
                queries=cell.task.queries,
                steps=cell.sizes.alignment_steps,
                rng=generator(cell.seed, cell.task.name, Stream.QUESTIONS),
            )
        return Trained(
            task=cell.task.name,
            models={key: model.trained_ for key, model in models.items()},
            aligned=aligned,
            episodes=len(demonstrations.episodes),
            seconds=seconds,
        )


def _demonstrated(cell: TrainingCell, task: SceneTask, belief: bool) -> tuple[Demonstrations, float]:
    """Demonstrations of as many minutes as the definition asks for at most, and how long they took, s.

    A belief is that over the goals of each demonstration, which stand elsewhere in every one and move on with
    its steps.
    """
    wanted_s = 60.0 * cell.task.demonstrations_min * cell.sizes.demonstrations_share
    cut = np.isfinite(cell.sizes.demonstration_s)
    choices = sorted(set(cell.task.choices))
    least = max(LEAST_DEMONSTRATIONS, len(choices))
    kept: list[Demonstration] = []
    took_s, number = 0.0, 0
    while took_s < wanted_s or len(kept) < least:
        if number >= MOST_TRIES * (len(kept) + 1):
            raise UserError(
                f"{len(kept)} of {number} demonstrations of {cell.task.name} succeeded: too few to train a"
                " model."
            )
        choice = choices[number % len(choices)]
        rng = generator(cell.seed, cell.task.name, Stream.DEMONSTRATIONS, number)
        number += 1
        shown = demonstrate_once(task, choice, rng, time_limit_s=cell.sizes.demonstration_s)
        if not (shown.progress.succeeded or cut):
            continue
        if took_s + shown.seconds > wanted_s and len(kept) >= least:
            break
        kept.append(replace(shown, states=()))
        took_s += shown.seconds
    dataset = dataset_of(task, [one.episode for one in kept], kept[0].objects)
    if belief:
        episodes = tuple(_with_belief(one, 1.0 / dataset.rate_hz) for one in kept)
        dataset = replace(dataset, episodes=episodes)
    return dataset, took_s


def _with_belief(shown: Demonstration, period_s: float) -> Episode:
    goals = [goal.configuration for goal in shown.begun.goals]
    return annotated(shown.episode, BoltzmannBelief(goals, period_s=period_s), shown.moves)


def _fitted(
    cell: TrainingCell, task: SceneTask, demonstrations: Demonstrations, kind: str, context: tuple[str, ...]
) -> LatentActionModel:
    sizes = cell.sizes
    return fit_model(
        kind,
        demonstrations,
        validation=validation_episodes(demonstrations),
        fit={"chain": task.robot.chain},
        latent_dim=2,
        context=context,
        seeds=1,
        seed=integer(sequence(cell.seed, cell.task.name, Stream.NETWORKS)),
        epochs=sizes.epochs,
        batch_size=sizes.batch_size,
        hidden=sizes.hidden,
        state_noise_rad=sizes.state_noise_rad,
    )
