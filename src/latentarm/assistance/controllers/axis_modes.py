"""Control of a few axes of the tool at a time, and a button that switches which."""

from abc import ABC
from dataclasses import dataclass
from typing import Final, final

import numpy as np

from latentarm.assistance.controllers.contract import Controller
from latentarm.core.errors import UserError
from latentarm.core.types import Context, FloatArray
from latentarm.robots.robot import Robot


@final
@dataclass(frozen=True)
class AxisModes:
    """The axes of the end-effector that the person's inputs drive in each mode.

    Raises UserError where there is no mode, modes have different numbers of axes, or a row is not one of the
    six.
    """

    names: tuple[str, ...]
    axes: tuple[tuple[int, ...], ...]
    """By mode, the row of the twist (x, y, z, roll, pitch, yaw) that each of the d input axes drives."""

    def __post_init__(self) -> None:
        if not self.axes or len(self.names) != len(self.axes) or len({len(one) for one in self.axes}) != 1:
            raise UserError("End-effector control needs modes, each with a name and the same number of axes.")
        if not self.axes[0] or not {row for one in self.axes for row in one} <= set(range(6)):
            raise UserError("A mode's axes are rows of the twist, 0 to 5.")

    def twists(self, mode: int, scale: FloatArray, rotation: FloatArray) -> FloatArray:
        """Twists (..., d, 6), m/s and rad/s, in the base frame, for a full input along each axis.

        ``scale`` (6,) is the speed along and about each axis. Turns are about the axes of the tool, whose
        rotation is (..., 3, 3).
        """
        rows = self.axes[mode]
        directions = np.zeros((len(rows), 6))
        for direction, row in zip(directions, rows, strict=True):
            direction[row] = scale[row]
        turns = directions[:, 3:] @ rotation.mT
        shifts = np.broadcast_to(directions[:, :3], turns.shape)
        return np.concatenate([shifts, turns], axis=-1)


PAIRS: Final = AxisModes(("x-y", "z-yaw", "roll-pitch"), ((0, 1), (2, 5), (3, 4)))
"""One stick of two axes and three modes, those of HARMONIC (Newman et al.): the paper's first study."""

TWO_STICKS: Final = AxisModes(("linear", "angular"), ((0, 1, 2), (3, 4, 5)))
"""A stick of two axes, another of one, and a button that toggles between linear and angular motion: the
paper's End-Effector (section 9.2)."""


class AxisController(Controller, ABC):
    """Turns an input into its mode's twist of the tool; subclasses say how the joints follow.

    Speeds are those of a full input along an axis, m/s, and about one, rad/s; UserError where one is not
    positive and finite.
    """

    def __init__(
        self, robot: Robot, linear_speed: float = 0.15, angular_speed: float = 0.5, modes: AxisModes = PAIRS
    ) -> None:
        for name, value in (("linear_speed", linear_speed), ("angular_speed", angular_speed)):
            if not 0 < value < np.inf:
                raise UserError(f"The tool's {name} must be positive and finite, not {value}.")
        self._chain = robot.chain
        self._modes = modes
        self._scale = np.array([linear_speed] * 3 + [angular_speed] * 3)

    @property
    @final
    def modes(self) -> tuple[str, ...]:
        return self._modes.names

    @property
    @final
    def input_dim(self) -> int:
        return len(self._modes.axes[0])

    @final
    def latent(self, u: FloatArray, context: Context, mode: int) -> FloatArray:
        """The input as it is: there is nothing to align."""
        return u
