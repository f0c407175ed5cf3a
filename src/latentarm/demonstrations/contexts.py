"""Contexts of demonstrated samples, as a decoder would have seen them."""

from typing import Final

import numpy as np

from latentarm.core.context import (
    BELIEF,
    GRIPPER,
    OBJECTS,
    OBJECTS_IN_TOOL,
    ContextLayout,
    Named,
    context_vector,
    feature_names,
)
from latentarm.core.errors import UserError
from latentarm.core.types import NO_GRIPPER, NO_OBJECTS, Context, Demonstrations, Episode, FloatArray
from latentarm.demonstrations.gripper import ACTION_GRIPPER, GRIPPER_TOGGLED, GRIPPER_WIDTH, opening_source
from latentarm.demonstrations.things import ENVIRONMENT
from latentarm.robots.kinematics.pose_rows import STORED, seen_rows

GRIPPER_SOURCES: Final = (ACTION_GRIPPER, GRIPPER_WIDTH, GRIPPER_TOGGLED)
"""Features of a dataset that tell how far the gripper is open, see `opening_source`."""


def episode_contexts(episode: Episode, context: Named, index: int | None = None) -> FloatArray:
    """The context vector at every sample of an episode, (T, c); ``index`` is for messages."""
    names = feature_names(context)
    where = "An episode" if index is None else f"Episode {index}"
    belief, gripper, objects = np.zeros(0), NO_GRIPPER, NO_OBJECTS
    if BELIEF in names:
        belief = _taken(episode, "belief", where, BELIEF, "annotate the demonstrations")
    if GRIPPER in names:
        source = opening_source(episode.extras) or GRIPPER_WIDTH
        gripper = _taken(episode, source, where, GRIPPER, "record the gripper's opening")
    if OBJECTS in names or OBJECTS_IN_TOOL in names:
        stored = _taken(episode, ENVIRONMENT, where, OBJECTS, "record the poses of things")
        if stored.shape[1] % STORED:
            raise UserError(_nameless(where, stored.shape[1]))
        objects = seen_rows(stored.reshape(len(stored), -1, STORED))
    return context_vector(Context(episode.state, belief, gripper, objects), names)


def context_layout(demonstrations: Demonstrations, context: Named) -> ContextLayout:
    """The layout of the contexts of demonstrations."""
    names, first = feature_names(context), demonstrations.episodes[0]
    width = episode_contexts(first, names, 0).shape[1]
    sees_objects = OBJECTS in names or OBJECTS_IN_TOOL in names
    if sees_objects and not demonstrations.objects:
        raise UserError(_nameless("The dataset", first.extras[ENVIRONMENT].shape[1]))
    layout = ContextLayout(
        features=names,
        joints=demonstrations.dof,
        goals=first.extras["belief"].shape[1] if BELIEF in names else 0,
        objects=demonstrations.objects if sees_objects else (),
        gripper=opening_source(first.extras) if GRIPPER in names else "",
    )
    if layout.width != width:
        raise UserError(f"The contexts of these demonstrations have {width} entries, not {layout.width}.")
    return layout


def _taken(episode: Episode, source: str, where: str, feature: str, remedy: str) -> FloatArray:
    if source in episode.extras:
        return episode.extras[source]
    there = ", ".join(sorted(episode.extras)) or "nothing besides the joints"
    raise UserError(
        f"{where} has no {source}, which the context {feature} needs; it has {there}:"
        f" {remedy}, or leave {feature} out of the context."
    )


def _nameless(where: str, width: int) -> str:
    return (
        f"{where} has {width} numbers in {ENVIRONMENT} and does not say which things' poses these are, so the"
        f" context {OBJECTS} cannot be taken from them: name its entries thing.x, thing.y, thing.z, thing.qw,"
        " thing.qx, thing.qy, thing.qz in meta/info.json, seven for each thing."
    )
