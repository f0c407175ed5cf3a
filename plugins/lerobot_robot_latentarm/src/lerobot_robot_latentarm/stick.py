"""A joystick of Linux as LeRobot's teleoperator, with the actions that `Latentarm` takes."""

import os
import struct
from typing import Any, ClassVar, Final, final

from lerobot.teleoperators import Teleoperator
from lerobot.utils.errors import DeviceAlreadyConnectedError, DeviceNotConnectedError

from lerobot_robot_latentarm.config_stick import LatentarmStickConfig
from lerobot_robot_latentarm.nothing_to_calibrate import NothingToCalibrate

_EVENT: Final = struct.Struct("<IhBB")
"""Time, ms, value, type and number: ``js_event`` of ``linux/joystick.h``."""

_BUTTON: Final = 1
_AXIS: Final = 2
_INITIAL: Final = 0x80

_FULL: Final = 32767


@final
class LatentarmStick(NothingToCalibrate, Teleoperator):
    """A joystick or gamepad by the kernel's joystick interface, such as ``/dev/input/js0``.

    Its axes are ``z.0``, ``z.1``, ...; a press of a button turns ``gripper`` over, which begins open. A stick
    that is unplugged is an error, so the tool that reads it ends and the arm stops.

    Args:
        config: see `LatentarmStickConfig`.
    """

    config_class = LatentarmStickConfig
    name: ClassVar[str] = "latentarm_stick"

    def __init__(self, config: LatentarmStickConfig) -> None:
        super().__init__(config)
        self._config = config
        self._axis = [int(axis.removeprefix("-")) for axis in config.axes]
        self._sign = [-1.0 if axis.startswith("-") else 1.0 for axis in config.axes]
        self._values: dict[int, float] = {}
        self._open = True
        self._file: int | None = None

    @property
    def action_features(self) -> dict[str, type]:
        """See the base class."""
        return dict.fromkeys((*(f"z.{index}" for index in range(len(self._axis))), "gripper"), float)

    @property
    def feedback_features(self) -> dict[str, type]:
        """None."""
        return {}

    @property
    def is_connected(self) -> bool:
        """See the base class."""
        return self._file is not None

    def connect(self, calibrate: bool = True) -> None:
        """See the base class.

        Raises:
            OSError: there is no such device.
        """
        if self._file is not None:
            raise DeviceAlreadyConnectedError(f"{self} is already connected.")
        self._values, self._open = {}, True
        self._file = os.open(self._config.device, os.O_RDONLY | os.O_NONBLOCK)

    def get_action(self) -> dict[str, Any]:
        """Where the stick is now.

        Raises:
            OSError: the device is gone.
        """
        if self._file is None:
            raise DeviceNotConnectedError(f"{self} is not connected. Run `.connect()` first.")
        while True:
            try:
                text = os.read(self._file, _EVENT.size)
            except BlockingIOError:
                break
            if len(text) < _EVENT.size:
                raise OSError(f"{self._config.device} is gone: plug the stick in again.")
            _, value, kind, number = _EVENT.unpack(text)
            self._take(kind, number, value)
        z = (sign * self._values.get(axis, 0.0) for axis, sign in zip(self._axis, self._sign, strict=True))
        return {**{f"z.{index}": value for index, value in enumerate(z)}, "gripper": float(self._open)}

    def send_feedback(self, feedback: dict[str, Any]) -> None:
        """Nothing."""

    def disconnect(self) -> None:
        """See the base class."""
        if self._file is None:
            raise DeviceNotConnectedError(f"{self} is not connected. Run `.connect()` first.")
        os.close(self._file)
        self._file = None

    def _take(self, kind: int, number: int, value: int) -> None:
        if kind & ~_INITIAL == _AXIS:
            self._values[number] = max(value, -_FULL) / _FULL
        elif kind == _BUTTON and number == self._config.gripper_button and value:
            self._open = not self._open
