"""A way back to the demonstrations, for any decoder H: ``phi(z, c) = cap[H(z, c) + ‖z‖ w(c)]``.

The pull w moves the arm towards the demonstrated motions. It is proportional to the length of the push and
does not depend on its direction. A network D predicts the displacement back to the demonstrations,
``D(c') = E[q - q' | c']`` for demonstrated states q that were displaced to q'. This is a denoiser, the score
of the smoothed demonstrations, so that it averages to zero along their path (Vincent, "A Connection Between
Score Matching and Denoising Autoencoders", 2011). With the metric G of the tools, the speed v of the
demonstrations and ``h = min(v, ‖H‖_G / ‖z‖)``::

    w = D min(v / L clip(2 - ‖D‖_G / GATE_M, 0, 1), STRENGTH h / ‖D‖_G)
    cap[a] = a min(1, v ‖z‖ / ‖a‖_G)

So, by construction, for every decoder and context and all weights:

- ``phi(0, c) = 0``: rest is rest;
- ``phi(a z, c) = a phi(z, c)`` for a > 0 where H has this property: half the push moves half as fast;
- ``‖phi(z, c)‖_G <= v ‖z‖``;
- ``<phi(z, c), H(z, c)>_G >= (1 - STRENGTH) / (1 + STRENGTH) ‖phi‖_G ‖H‖_G``: the pull is weaker than the
  person, who can always move on against it;
- ``w = 0`` beyond ``2 GATE_M``, where the network knows nothing.

The opposite push does not take a motion back any more: both directions lead back.
"""

from typing import TYPE_CHECKING, Final, final

import numpy as np

from latentarm.core.context import BELIEF, GRIPPER, JOINTS, OBJECT, OBJECTS, OBJECTS_IN_TOOL, ContextLayout
from latentarm.core.types import FloatArray
from latentarm.models.enclosure import Enclosure
from latentarm.models.numpy_networks import (
    NORM_FLOOR,
    halve_hidden,
    layers_of,
    network_output,
    network_shapes,
)
from latentarm.models.tool_contexts import PLACE, ToolGeometry

if TYPE_CHECKING:
    from latentarm.models.kind import Dimensions, Shape, TrainedModel

NETWORK: Final = "way_back"  # name of its network among a model's tensors
GATE_M: Final = 0.06  # the pull fades out as the length of D grows from this to twice this, m
STRENGTH: Final = 0.7  # largest pull, relative to the person
DAMPING_M2: Final = 1e-3
"""Weight of a joint's motion by 1 rad in the metric, relative to the square of a tool's motion by 1 m."""


@final
class PullContexts:
    """The input of D: joints, tools, poses of things, and the decoder's other features.

    Poses of things come twice: (..., K, 9) in the base frame, then positions (..., K, 3) and columns of
    rotations (..., K, 6) in that of the first tool.
    """

    def __init__(self, geometry: ToolGeometry, layout: ContextLayout) -> None:
        self._geometry = geometry
        self._joints = layout.columns(JOINTS)
        self._things, self._others = pull_columns(layout)

    def apply(self, context: FloatArray) -> tuple[FloatArray, FloatArray]:
        """The input of D (..., o) in contexts (..., c), and the weighted Jacobian there (..., 6 k, n)."""
        state = context[..., self._joints]
        places, jacobian = self._geometry(state)
        parts = [state, places]
        if self._things is not None:
            rows = context[..., self._things]
            lead = rows.shape[:-1]
            rows = rows.reshape(*lead, -1, OBJECT)
            turned = places[..., 3:PLACE].reshape(*lead, 3, 2)
            first, second = turned[..., 0], turned[..., 1]
            axes = np.stack([first, second, np.cross(first, second)], axis=-1)
            near = (rows[..., :3] - places[..., None, :3]) @ axes
            columns = axes.mT[..., None, :, :] @ rows[..., 3:].reshape(*rows.shape[:-1], 3, 2)
            parts += [one.reshape(*lead, -1) for one in (rows, near, columns)]
        parts += [context[..., columns] for columns in self._others]
        return np.concatenate(parts, axis=-1), jacobian


def pull_columns(layout: ContextLayout) -> tuple[slice | None, list[slice]]:
    """The columns of the poses of things in a context, None without any; and D's other columns."""
    things = next((layout.columns(one) for one in (OBJECTS, OBJECTS_IN_TOOL) if one in layout.features), None)
    return things, [layout.columns(one) for one in (BELIEF, GRIPPER) if one in layout.features]


def pull_width(layout: ContextLayout, tools: int) -> int:
    """o, the entries of D's input."""
    things, others = pull_columns(layout)
    count = 0 if things is None else len(layout.objects)
    beside = sum(columns.stop - columns.start for columns in others)
    return layout.joints + PLACE * tools + 2 * OBJECT * count + beside


def pull_shapes(dimensions: "Dimensions", layout: ContextLayout) -> "dict[str, Shape]":
    """Shape of every array of a model's way back by name; none where it has none."""
    if not dimensions.way_back:
        return {}
    sizes = (pull_width(layout, dimensions.tools), *dimensions.way_back, dimensions.action)
    return {**network_shapes({NETWORK: sizes}, dimensions.seeds), f"{NETWORK}.scale": (2,)}


@final
class WayBack:
    """The way back of one seed of a trained model that has one."""

    def __init__(self, trained: "TrainedModel", seed: int) -> None:
        self._layers = halve_hidden(layers_of(trained, seed, NETWORK))
        self._geometry, self._joints = trained.geometry, trained.dimensions.action
        self._contexts = PullContexts(trained.geometry, trained.layout)
        self._speed, self._length = map(float, trained.tensors[f"{NETWORK}.scale"])

    def __call__(self, action: FloatArray, z: FloatArray, context: FloatArray) -> FloatArray:
        """The decoder's own action (..., m), rad/s, for z (..., d) in contexts (..., c), with the way back.

        All poses are in the base frame.
        """
        way, length, gain, jacobian = self.pull(context)
        fastest = self._speed * np.sqrt(np.vecdot(z, z))[..., None]
        person = np.minimum(fastest, metric_length(jacobian, action))
        led = action + np.minimum(fastest * gain, STRENGTH * person / length) * way
        return led * np.minimum(1.0, fastest / metric_length(jacobian, led))

    def enclosed(self, enclosure: Enclosure, latent_dim: int, context: FloatArray) -> Enclosure:
        """The enclosure of phi, from that of the decoder alone in the same contexts.

        The pull is one vector times a number from 0 to its largest, and the cap multiplies by a number from 0
        to 1: both are further directions in which each cell spreads.
        """
        way, length, gain, _ = self.pull(context)
        fastest = self._speed * np.sqrt(latent_dim)
        half = 0.5 * fastest * np.minimum(gain, STRENGTH / length) * way
        half = np.broadcast_to(half[..., None, :], enclosure.centre.shape)
        middle = 0.5 * (enclosure.centre + half)
        further = np.stack([half, middle], axis=-2)
        return Enclosure(middle, np.concatenate([enclosure.spread, further], axis=-2), enclosure.remainder)

    def leads(self, context: FloatArray, offset: FloatArray) -> tuple[FloatArray, FloatArray]:
        """The pull on the first tool when it is displaced by ``offset`` (..., 3), m, for a figure.

        Returns places (..., 3) that are nearly that far away, and those that a full push alone would be
        pulled to in the time that the demonstrations take for L, m. Things stay in place.
        """
        state, rest = context[..., : self._joints], context[..., self._joints :]
        jacobian = self._geometry(state)[1]
        metric = jacobian.mT @ jacobian + DAMPING_M2 * np.eye(self._joints)
        state = state + np.linalg.solve(metric, np.matvec(jacobian[..., :3, :].mT, offset)[..., None])[..., 0]
        way, _, gain, _ = self.pull(np.concatenate([state, rest], axis=-1))
        here, there = (self._geometry(one)[0][..., :3] for one in (state, state + self._length * gain * way))
        return here, there

    def pull(self, context: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
        """D (..., m), rad; its length (..., 1), m; its factor (..., 1), 1/m; ``J_w`` (..., 6 k, n)."""
        seen, jacobian = self._contexts.apply(context)
        way = network_output(seen, self._layers)
        length = metric_length(jacobian, way)
        gain = np.minimum(np.maximum(2.0 - length / GATE_M, 0.0), 1.0) / self._length
        return way, length, gain, jacobian


def metric_length(jacobian: FloatArray, vector: FloatArray) -> FloatArray:
    """``‖a‖_G`` of joint velocities (..., m), given ``J_w`` (..., 6 k, m): (..., 1), positive."""
    twist = np.matvec(jacobian, vector)
    size = np.vecdot(twist, twist) + DAMPING_M2 * np.vecdot(vector, vector)
    return np.sqrt(size + NORM_FLOOR)[..., None]
