"""Things of a demonstration that the arm holds, by fork or gripper: they move with its tool."""

from typing import Final

import numpy as np

from latentarm.core.context import OBJECT, OBJECTS, OBJECTS_IN_TOOL, ContextLayout
from latentarm.core.types import BoolArray, FloatArray, Pose
from latentarm.robots.kinematics.chain import Chain
from latentarm.robots.kinematics.pose_rows import moved_along

MOVES_M: Final = 0.001  # smaller motion between two samples tells nothing
ASTRAY: Final = 0.3  # a held thing ends within this share of its way from where the tool takes it


def held_things(chain: Chain | None, layout: ContextLayout, context: FloatArray) -> BoolArray:
    """Whether each thing is held at each sample of an episode, (T, K), from its contexts (T, c).

    Where neither a thing nor the tool moves, the state before holds on; at first nothing is held. Without a
    chain nothing ever is. The chain's first tool holds things.
    """
    held = np.zeros((len(context), len(layout.objects)), dtype=np.bool_)
    if chain is None or len(context) < 2 or not layout.objects:
        return held
    rows = _rows(layout, context)
    tool = chain.forward(context[:, : layout.joints])
    before, after = (Pose(tool.position[part], tool.rotation[part]) for part in (_EARLIER, _LATER))
    carried = moved_along(rows[:-1], before, after)[..., :3]
    here, there = rows[:-1, :, :3], rows[1:, :, :3]
    way = np.maximum(np.linalg.norm(carried - here, axis=-1), np.linalg.norm(there - here, axis=-1))
    known = way > MOVES_M
    # The newest sample at which something was known, per thing.
    newest = np.maximum.accumulate(np.where(known, np.arange(len(known))[:, None], -1), axis=0)
    along = np.linalg.norm(there - carried, axis=-1) < ASTRAY * way
    held[:-1] = np.take_along_axis(along, np.maximum(newest, 0), axis=0) & (newest >= 0)
    held[-1] = held[-2]
    return held


def moved_to(
    chain: Chain | None, layout: ContextLayout, context: FloatArray, held: BoolArray, state: FloatArray
) -> FloatArray:
    """Contexts (N, c) after the arm moves to ``state`` (N, n), rad, with the things that it holds (N, K)."""
    moved = context.copy()
    moved[:, : layout.joints] = state
    carries = held.any(axis=1)
    if chain is None or not carries.any():
        return moved
    before, after = (chain.forward(one[carries, : layout.joints]) for one in (context, state))
    rows = _rows(layout, context[carries])
    there = np.where(held[carries, :, None], moved_along(rows, before, after), rows)
    for feature in _THINGS & set(layout.features):
        moved[carries, layout.columns(feature)] = there.reshape(len(there), -1)
    return moved


_THINGS: Final = {OBJECTS, OBJECTS_IN_TOOL}
_EARLIER: Final = slice(None, -1)
_LATER: Final = slice(1, None)


def _rows(layout: ContextLayout, context: FloatArray) -> FloatArray:
    feature = next(one for one in layout.features if one in _THINGS)
    return context[:, layout.columns(feature)].reshape(len(context), -1, OBJECT)
