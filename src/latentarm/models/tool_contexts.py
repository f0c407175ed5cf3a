"""The input of a decoder that measures motion at the tool: the context, and the arm's geometry in it."""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache, cached_property
from typing import Final, final

import numpy as np

from latentarm.core.errors import UserError
from latentarm.core.types import FloatArray
from latentarm.models.saved_chain import chain_of_tensors, chain_tensors
from latentarm.models.scaling import SPAN_QUANTILE, Normaliser, context_normaliser
from latentarm.robots.kinematics.chain import Chain
from latentarm.robots.kinematics.pose_rows import pose_rows

TWIST: Final = 6  # entries of a tool's twist: 3 of velocity, 3 of angular velocity
PLACE: Final = 9  # numbers of a tool's place: its position and the first two columns of its rotation
ROTATION_WEIGHT_M: Final = 0.05
"""Weight of a tool's turn by 1 rad relative to a motion by 1 m. Low, so that directions of z differ mainly in
where they move the tools; not zero, so that turning a tool in place counts too."""


def tool_shapes(tools: int) -> dict[str, tuple[int, ...]]:
    """Shapes of a saved model's arrays for an arm with k tools, by name, without its kinematics."""
    return {"place.centre": (PLACE * tools,), "place.scale": (PLACE * tools,), "metric.scale": (2,)}


@final
@dataclass(frozen=True)
class ToolSizes:
    """The places of the parts of an observation along its last axis."""

    context: int  # c
    joints: int  # n
    tools: int  # k

    @property
    def seen(self) -> int:
        """Entries of the network's input: the context and the tools' places."""
        return self.context + PLACE * self.tools

    @property
    def twists(self) -> int:
        """6 k, entries of all tools' twists."""
        return TWIST * self.tools

    @property
    def jacobian(self) -> slice:
        """The weighted Jacobian, 6 k rows of n."""
        return slice(self.seen, self.seen + self.twists * self.joints)

    @property
    def lift(self) -> slice:
        """From twists to joint velocities, n rows of 6 k."""
        return slice(self.jacobian.stop, self.jacobian.stop + self.twists * self.joints)


@final
@dataclass(frozen=True, eq=False)
class ToolContexts:
    """The map from contexts to observations ``[c, x, J_w, G^-1 J_w^T]``.

    The metric of the task is ``G(s) = J_w^T J_w + damping 1`` with ``J_w = W^(1/2) J / sqrt(k)`` over all k
    tools: ``a^T G a`` is the squared speed of the tools, m^2/s^2, where a turn of 1 rad/s counts as much as
    ``rotation_weight`` m/s, and a little for motion of the joints that no tool shows.
    """

    chain: Chain
    contexts: Normaliser  # normaliser of contexts (..., c), of which the first n entries are the state
    places: Normaliser  # normaliser of the tools' places (..., 9 k)
    rotation_weight: float  # m/rad
    damping: float  # m^2/rad^2, positive

    @staticmethod
    def fitted(chain: Chain, context: FloatArray, contexts: Normaliser, damping: float) -> "ToolContexts":
        """The map for contexts (N, c) with their normaliser, in the metric of a damping, m^2/rad^2."""
        return ToolContexts(
            chain=chain,
            contexts=contexts,
            places=context_normaliser(places_and_jacobian(chain, context[:, : chain.dof])[0]),
            rotation_weight=ROTATION_WEIGHT_M,
            damping=damping,
        )

    @staticmethod
    def of_tensors(tensors: Mapping[str, FloatArray], damping: float) -> "ToolContexts":
        """The map that `tensors` gave; UserError where it measures in another metric than this version."""
        weight, damped = tensors["metric.scale"]
        if (weight, damped) != (ROTATION_WEIGHT_M, damping):
            raise UserError(
                f"The model measures motion with a rotation weight of {weight:g} m/rad and a damping of "
                f"{damped:g} m^2/rad^2, this version with {ROTATION_WEIGHT_M:g} and {damping:g}: "
                "train it again."
            )
        return ToolContexts(
            chain=chain_of_tensors(tensors),
            contexts=Normaliser(tensors["context.centre"], tensors["context.scale"]),
            places=Normaliser(tensors["place.centre"], tensors["place.scale"]),
            rotation_weight=ROTATION_WEIGHT_M,
            damping=damping,
        )

    def tensors(self) -> dict[str, FloatArray]:
        """The map as float64 arrays by name."""
        return {
            **self.contexts.tensors(),
            "place.centre": self.places.centre,
            "place.scale": self.places.scale,
            "metric.scale": np.array([self.rotation_weight, self.damping]),
            **chain_tensors(self.chain),
        }

    @cached_property
    def sizes(self) -> ToolSizes:
        """The sizes of an observation."""
        return ToolSizes(len(self.contexts.centre), self.chain.dof, len(self.chain.tools))

    def apply(self, context: FloatArray) -> FloatArray:
        """Observations (..., c + 9 k + 12 k n) of contexts (..., c), laid out as in `ToolSizes`."""
        sizes = self.sizes
        places, jacobian = self.geometry(context[..., : sizes.joints])
        metric = jacobian.mT @ jacobian + self.damping * np.eye(sizes.joints)
        lift = np.asarray(np.linalg.solve(metric, jacobian.mT), dtype=np.float64)
        lead = context.shape[:-1]
        flat = jacobian.reshape(*lead, -1), lift.reshape(*lead, -1)
        return np.concatenate([self.contexts.apply(context), self.places.apply(places), *flat], axis=-1)

    def jacobian(self, state: FloatArray) -> FloatArray:
        """``J_w`` alone at states (..., n): (..., 6 k, n)."""
        return self.geometry(state)[1]

    @cached_property
    def geometry(self) -> "ToolGeometry":
        """`places_and_jacobian` of the arm."""
        return ToolGeometry(self.chain)

    def action_normaliser(self, context: FloatArray, action: FloatArray) -> Normaliser:
        """One scale for all joints, so that the fastest tools, outliers aside, have the speed 1.

        From contexts (N, c) and actions (N, n), rad/s, not all zero.
        """
        jacobian = self.apply(context)[:, self.sizes.jacobian].reshape(len(context), -1, self.sizes.joints)
        twist = np.matvec(jacobian, action)
        speed = np.sqrt(np.vecdot(twist, twist) + self.damping * np.vecdot(action, action))
        return Normaliser(centre=np.zeros(1), scale=np.quantile(speed, SPAN_QUANTILE).reshape(1))

    @cached_property
    def twist_weight(self) -> FloatArray:
        """(6 k,), the square root of W over k."""
        return twist_weight(self.sizes.tools)


@cache
def twist_weight(tools: int) -> FloatArray:
    """The square root of W over k for all twists of k tools, (6 k,)."""
    one = np.concatenate([np.ones(3), np.full(3, ROTATION_WEIGHT_M)])
    weight: FloatArray = np.tile(one, tools) / math.sqrt(tools)
    return weight


def places_and_jacobian(chain: Chain, state: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Places (..., 9 k) of all tools at states (..., n), and ``J_w`` there, (..., 6 k, n)."""
    transforms = chain.link_transforms(state)
    places: list[FloatArray] = []
    jacobians: list[FloatArray] = []
    for tool in range(len(chain.tools)):
        pose = chain.tool_pose(transforms, tool)
        places.append(pose_rows(pose))
        jacobians.append(chain.jacobian_at(transforms, pose, tool))
    only = len(places) == 1
    jacobian = jacobians[0] if only else np.concatenate(jacobians, axis=-2)
    jacobian *= twist_weight(len(chain.tools))[:, None]
    return places[0] if only else np.concatenate(places, axis=-1), jacobian


@final
class ToolGeometry:
    """`places_and_jacobian` of one arm, computed once for a single state that is asked about repeatedly."""

    __slots__ = ("_chain", "_last")

    def __init__(self, chain: Chain) -> None:
        self._chain = chain
        self._last: tuple[bytes, tuple[FloatArray, FloatArray]] | None = None

    def __call__(self, state: FloatArray) -> tuple[FloatArray, FloatArray]:
        """See `places_and_jacobian`; read-only for a single state (n,)."""
        if state.ndim > 1:
            return places_and_jacobian(self._chain, state)
        asked, last = state.tobytes(), self._last
        if last is None or last[0] != asked:
            found = places_and_jacobian(self._chain, state)
            for array in found:
                array.flags.writeable = False
            self._last = last = asked, found
        return last[1]
