"""The features that a decoder may see, and the vector that they make, for training and driving alike."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Final, Literal, final

import numpy as np

from latentarm.core.errors import UserError
from latentarm.core.types import Context, FloatArray

FeatureName = Literal["joints", "belief", "gripper", "objects", "objects_in_tool"]

JOINTS: Final = "joints"
BELIEF: Final = "belief"
GRIPPER: Final = "gripper"
OBJECTS: Final = "objects"
OBJECTS_IN_TOOL: Final = "objects_in_tool"

FEATURES: Final[tuple[FeatureName, ...]] = ("joints", "belief", "gripper", "objects", "objects_in_tool")
"""Joint positions; belief over goals; the gripper's opening, see `ContextLayout.gripper`; poses of things in
the base frame, and in that of the arm's first tool."""

OBJECT: Final = 9
"""Numbers that tell a decoder where a thing is: its position and the first two columns of its rotation. No
two of them stand for one pose, and they never jump, as angles and quaternions do (Zhou et al., "On the
Continuity of Rotation Representations in Neural Networks", 2019)."""

EARLIER_NAMES: Final = {"state": (JOINTS,), "state_belief": (JOINTS, BELIEF)}
"""Names of whole contexts before features had names."""

Named = str | Sequence[str]
"""Features of a context by name, in order; or one name, also an earlier one for several."""


def feature_names(context: Named) -> tuple[str, ...]:
    """Features by name, in order; takes names among `FEATURES` or one of `EARLIER_NAMES`."""
    given = (context,) if isinstance(context, str) else tuple(context)
    names = EARLIER_NAMES.get(given[0], given) if len(given) == 1 else given
    for name in names:
        if name not in FEATURES:
            raise UserError(f"A context has no feature {name!r}; there are: {', '.join(FEATURES)}.")
        if names.count(name) > 1:
            raise UserError(f"The context names {name} twice: name each feature once.")
    if names[:1] != (JOINTS,):
        # Whatever looks ahead moves the first n entries: measures, planners, losses, alignments.
        raise UserError(f"A context begins with the {JOINTS}: name them first.")
    return tuple(names)


def context_vector(context: Context, features: Sequence[str]) -> FloatArray:
    """The vector (..., c) that a decoder sees: the features one after the other.

    The state may have leading axes, which the other features share or broadcast to. The poses for
    `OBJECTS_IN_TOOL` are those in the base frame: a decoder with this feature turns them into the tool's
    frame at the state that it is asked about. So the first n entries alone move a vector to another state.
    """
    state = context.state
    if len(features) == 1:
        return state
    lead = state.shape[:-1]
    rest = [_REST[name](context) for name in features[1:]]
    if lead:
        rest = [np.broadcast_to(values, (*lead, values.shape[-1])) for values in rest]
    return np.concatenate([state, *rest], axis=-1)


def _objects(context: Context) -> FloatArray:
    objects = context.objects
    return objects.reshape(*objects.shape[:-2], objects.shape[-2] * objects.shape[-1])


_REST: Final[Mapping[str, Callable[[Context], FloatArray]]] = {
    BELIEF: lambda context: context.belief,
    GRIPPER: lambda context: context.gripper,
    OBJECTS: _objects,
    OBJECTS_IN_TOOL: _objects,
}


@final
@dataclass(frozen=True)
class ContextLayout:
    """The layout of the features in the vector of a context."""

    features: tuple[str, ...]
    joints: int  # n
    goals: int = 0  # G, entries of the belief; 0 if the decoder does not see it
    objects: tuple[str, ...] = ()  # names of the things whose poses the decoder sees, in order
    # the feature of the dataset that holds the opening: the commanded one, ``action.gripper``, or the
    # measured one, ``observation.gripper_width``; "" if the decoder sees none
    gripper: str = ""

    @property
    def width(self) -> int:
        """The size c of the vector."""
        return sum(map(self._width, self.features))

    @property
    def sees_tool_frame(self) -> bool:
        """Whether the decoder needs the arm's kinematics."""
        return OBJECTS_IN_TOOL in self.features

    def columns(self, feature: str) -> slice:
        """The slice of a feature in the vector."""
        start = sum(map(self._width, self.features[: self.features.index(feature)]))
        return slice(start, start + self._width(feature))

    def _width(self, feature: str) -> int:
        if feature == JOINTS:
            return self.joints
        if feature == BELIEF:
            return self.goals
        return 1 if feature == GRIPPER else OBJECT * len(self.objects)
