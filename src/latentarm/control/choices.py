"""What the person's input would do now, and what other inputs would do."""

import itertools
import math
from typing import final

import numpy as np

from latentarm.control.controller import Controller
from latentarm.types import Context, FloatArray

_MOST_CORNERS_OF = 6
"""Up to this many input axes, all 2^d corners of the stick are considered."""


@final
class Choices:
    """Lines 6 and 7 of Algorithm 1 for any inputs, asking the controller in as few calls as possible.

    A belief asks about the person's own input together with others, so its action is then already known.

    Args:
        controller: what turns inputs into actions.
        context: of this moment.
        mode: index of the controller's mode.
        beside: (K, d), inputs to decode along with the first ones asked about; may be empty.
    """

    __slots__ = ("_actions", "_asked", "_beside", "_context", "_controller", "_latents", "_mode")

    def __init__(self, controller: Controller, context: Context, mode: int, beside: FloatArray) -> None:
        self._controller = controller
        self._context = context
        self._mode = mode
        self._beside = beside
        self._asked: FloatArray | None = None
        self._latents = self._actions = beside

    def __call__(self, inputs: FloatArray) -> FloatArray:
        """Inputs (K, d) to actions (K, n), rad/s.

        Raises:
            ValueError: the controller gave arrays of other shapes.
        """
        asked = np.concatenate([inputs, self._beside]) if len(self._beside) else inputs
        z, actions = self._decoded(asked)
        if z.shape != asked.shape or actions.shape != (len(asked), len(self._context.state)):
            raise ValueError(f"{len(asked)} inputs gave actions of shape {actions.shape}")
        self._asked, self._latents, self._actions = asked, z, actions
        return actions[: len(inputs)]

    def chosen(self, u: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Latent action and action of the person's own input.

        Args:
            u: (d,).

        Returns:
            z and a_h, rad/s, of whatever shapes the controller gave.
        """
        if self._asked is not None and self._asked[0].tolist() == u.tolist():
            return self._latents[0], self._actions[0]
        return self._decoded(u)

    def largest_beside(self) -> float:
        """Largest ‖a‖ of the additional inputs, rad/s; NaN if an action is not finite."""
        if self._asked is None:
            self(self._beside[:0])
        actions = self._actions[len(self._actions) - len(self._beside) :]
        squared = np.vecdot(actions, actions).tolist()
        return math.sqrt(max(squared)) if math.isfinite(sum(squared)) else math.nan

    def _decoded(self, inputs: FloatArray) -> tuple[FloatArray, FloatArray]:
        z = np.asarray(self._controller.latent(inputs, self._context, self._mode), dtype=np.float64)
        return z, np.asarray(self._controller.action(z, self._context, self._mode), dtype=np.float64)


def full_deflections(input_dim: int) -> FloatArray:
    """Inputs at the edge of what a person can give: both ends of every axis, and every corner.

    Args:
        input_dim: d, axes of the input.

    Returns:
        (K, d), entries in {-1, 0, 1}; corners for up to six axes.
    """
    axes = np.concatenate([np.eye(input_dim), -np.eye(input_dim)])
    if not 1 < input_dim <= _MOST_CORNERS_OF:
        return axes
    return np.concatenate([axes, np.array(list(itertools.product((-1.0, 1.0), repeat=input_dim)))])
