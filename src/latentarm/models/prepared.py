"""Context-action pairs made ready for training: split, observed and normalised."""

from collections.abc import Sequence
from dataclasses import dataclass, fields
from typing import Final, final

import numpy as np

from latentarm.core.context import ContextLayout
from latentarm.core.errors import UserError
from latentarm.core.types import BoolArray, FloatArray, Pairs
from latentarm.demonstrations.held import moved_to
from latentarm.models.batches import TrainingData
from latentarm.models.goal_entropy import GoalEntropy, ScaledTerm
from latentarm.models.scaling import Normaliser, action_normaliser, feature_normaliser
from latentarm.models.tool_contexts import ToolContexts
from latentarm.models.tool_frame import ToolFrame
from latentarm.robots.kinematics.chain import Chain

AHEAD_S: Final = 0.1  # models that look ahead look this far, s: as long as a short press of the stick


@final
@dataclass(frozen=True)
class Preparation:
    """A model's demands on its data."""

    damping_m2: float | None  # see `ModelKind.damping_m2`
    looks_ahead: bool  # whether its loss looks at the context that an action leads to within `AHEAD_S`
    data_seed: int


@final
@dataclass(frozen=True)
class Prepared:
    """One data set, ready for training."""

    data: TrainingData
    # From contexts, with poses in the tool's frame where a feature asks for that, to those of ``data``
    contexts: Normaliser | ToolContexts
    layout: ContextLayout
    actions: Normaliser  # from actions in rad/s to those of ``data``
    joints: int  # m, joints that an action moves
    width: int
    pairs: Pairs
    arm: Chain | None  # its kinematics, where something needs them
    validation: tuple[int, ...]
    term: ScaledTerm | None  # the further term of the loss, or None


def prepare(
    asked: Preparation,
    pairs: Pairs,
    layout: ContextLayout,
    validation: Sequence[int],
    arm: Chain | None,
    term: GoalEntropy | None,
) -> Prepared:
    """Split pairs by episode and normalise them by the training episodes alone.

    Raises UserError where nothing moves on one side of the split, or every action is zero.
    """
    outside = np.isin(pairs.episode, validation)
    if outside.all() or not outside.any():
        raise UserError(
            "The arm moves in none of the training episodes, or in none of the validation episodes."
        )
    context, action = pairs.context[~outside], pairs.action[~outside]
    if not action.any():
        raise UserError("Every recorded action is zero: take actions from the states (displacement).")
    frame = ToolFrame(arm, layout) if arm is not None and layout.sees_tool_frame else None

    def framed(recorded: FloatArray) -> FloatArray:
        return recorded if frame is None else frame.apply(recorded)

    plain = feature_normaliser(context, framed(context), layout)
    contexts, actions = _in_metric(arm, asked.damping_m2, plain, framed(context), action)

    def observed(recorded: FloatArray) -> FloatArray:
        return contexts.apply(framed(recorded))

    shown, joints = observed(context), action.shape[1]
    elsewhere = shown[:0]
    if term is not None:
        rng = np.random.default_rng([asked.data_seed, 2])
        elsewhere = observed(term.contexts(context, joints, rng))

    def later(side: BoolArray) -> FloatArray:
        """Observations (N, o) where the actions of some pairs lead, with what is held; (N, 0) if unused."""
        before = pairs.context[side]
        if not asked.looks_ahead:
            return before[:, :0]
        after = before[:, :joints] + AHEAD_S * pairs.action[side]
        return observed(moved_to(arm, layout, before, pairs.held[side], after))

    return Prepared(
        data=TrainingData(
            context=shown,
            action=actions.apply(action),
            validation_context=observed(pairs.context[outside]),
            validation_action=actions.apply(pairs.action[outside]),
            elsewhere=elsewhere,
            later=later(~outside),
            validation_later=later(outside),
        ),
        contexts=contexts,
        layout=layout,
        actions=actions,
        joints=joints,
        width=context.shape[1],
        pairs=pairs,
        arm=arm,
        validation=tuple(int(episode) for episode in validation),
        term=term
        and ScaledTerm(
            term,
            contexts=contexts.contexts if isinstance(contexts, ToolContexts) else contexts,
            actions=actions,
            joints=joints,
            speed=float(np.sqrt(np.square(action).sum(axis=1).mean())),
        ),
    )


def side_by_side(data_sets: Sequence[TrainingData]) -> TrainingData:
    """Data sets of S seeds as one, with a leading seed axis; longer ones lose their last pairs."""
    stacked: dict[str, FloatArray] = {}
    for field in fields(TrainingData):
        arrays: list[FloatArray] = [getattr(data, field.name) for data in data_sets]
        shortest = min(map(len, arrays))
        stacked[field.name] = np.stack([array[:shortest] for array in arrays])
    return TrainingData(**stacked)


def _in_metric(
    arm: Chain | None, damping_m2: float | None, plain: Normaliser, context: FloatArray, action: FloatArray
) -> tuple[Normaliser | ToolContexts, Normaliser]:
    """Normalisers of contexts and actions; in the metric of an arm's tools if the model has one."""
    if arm is None or damping_m2 is None:
        return plain, action_normaliser(action)
    contexts = ToolContexts.fitted(arm, context, plain, damping_m2)
    return contexts, contexts.action_normaliser(context, action)
