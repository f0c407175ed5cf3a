"""The robot that LeRobot sees: latent actions in, joints and the tool's pose out."""

import logging
import math
from collections.abc import Mapping
from functools import cached_property
from typing import Any, ClassVar, Final, final

from latentarm_process.client import DrivingProcess, Seen
from latentarm_process.driven import Wanted, load
from lerobot.cameras import make_cameras_from_configs
from lerobot.robots import Robot
from lerobot.utils.errors import DeviceAlreadyConnectedError, DeviceNotConnectedError

from latentarm.core.types import GripperAsk
from lerobot_robot_latentarm.config_robot import LatentarmConfig
from lerobot_robot_latentarm.nothing_to_calibrate import NothingToCalibrate

_TOOL: Final = ("tool.x", "tool.y", "tool.z", "tool.qw", "tool.qx", "tool.qy", "tool.qz")

_logger = logging.getLogger(__name__)


@final
class Latentarm(NothingToCalibrate, Robot):
    """An arm that is driven by a run's latent actions, behind latentarm's safety filters.

    Actions: ``z.0``, ``z.1``, ... as many as the run has, each in [-1, 1], and ``gripper`` where the arm has
    one: 1 is open, 0 is closed, and it moves only when the value crosses 0.5. Observations: ``JOINT.pos`` in
    rad, the tool's position in m and its quaternion (w, x, y, z), ``gripper.width`` in m, and cameras.

    A process of its own moves the arm, with a loop at 100 Hz. An action counts for 50 ms; the arm slows
    down after that, and stops for good after 120 ms, until neutral actions have come for half a second. After
    any other stop (a fault, an emergency stop, a reading that cannot be true) the robot has to be connected
    again.

    Connecting enables the arm. It stands still until the first action comes.

    Args:
        config: see `LatentarmConfig`.

    Raises:
        UserError: the run, its robot or the profile cannot be loaded.
    """

    config_class = LatentarmConfig
    name: ClassVar[str] = "latentarm"

    def __init__(self, config: LatentarmConfig) -> None:
        super().__init__(config)
        self.config = config
        self._wanted = Wanted(config.run, config.arm, config.profile, config.seed)
        driven = load(self._wanted)
        self._joints = driven.robot.joint_names
        self._latent = tuple(f"z.{axis}" for axis in range(driven.controller.input_dim))
        self._has_gripper = driven.robot.gripper is not None
        self._gripper: float | None = None
        self._process: DrivingProcess | None = None
        self._stopped = ""
        self.cameras = make_cameras_from_configs(config.cameras)

    @cached_property
    def action_features(self) -> dict[str, type]:
        """See the base class."""
        return dict.fromkeys((*self._latent, *(["gripper"] if self._has_gripper else [])), float)

    @cached_property
    def observation_features(self) -> dict[str, Any]:
        """See the base class."""
        names = [f"{joint}.pos" for joint in self._joints]
        widths = ["gripper.width"] if self._has_gripper else []
        pictures = {name: (one.height, one.width, 3) for name, one in self.config.cameras.items()}
        return {**dict.fromkeys((*names, *_TOOL, *widths), float), **pictures}

    @property
    def is_connected(self) -> bool:
        """See the base class."""
        return self._process is not None and all(one.is_connected for one in self.cameras.values())

    def connect(self, calibrate: bool = True) -> None:
        """See the base class.

        Raises:
            UserError: the arm cannot be driven.
        """
        if self._process is not None:
            raise DeviceAlreadyConnectedError(f"{self} is already connected.")
        for camera in self.cameras.values():
            camera.connect()
        self._process = DrivingProcess(self._wanted)
        self._gripper, self._stopped = None, ""

    def get_observation(self) -> dict[str, Any]:
        """See the base class.

        Raises:
            UserError: the process that drives the arm does not answer.
        """
        seen = self._look()
        observed: dict[str, Any] = dict(zip((f"{joint}.pos" for joint in self._joints), seen.q, strict=True))
        observed |= dict(zip(_TOOL, seen.tool, strict=True))
        if self._has_gripper:
            observed["gripper.width"] = math.nan if seen.width_m is None else seen.width_m
        for name, camera in self.cameras.items():
            observed[name] = camera.read_latest()
        return observed

    def send_action(self, action: Mapping[str, Any]) -> dict[str, Any]:
        """Hand over an action.

        Returns:
            The action that counts: neutral while the arm is stopped.

        Raises:
            ValueError: an action lacks an entry.
        """
        process = self._connected()
        missing = [name for name in self.action_features if name not in action]
        if missing:
            raise ValueError(f"the action of latentarm lacks {', '.join(missing)}")
        u = [min(max(float(action[name]), -1.0), 1.0) for name in self._latent]
        process.drive(u, self._ask(float(action["gripper"])) if self._has_gripper else None)
        sent = dict(zip(self._latent, [0.0] * len(u) if self._stopped else u, strict=True))
        return sent | ({"gripper": float(action["gripper"])} if self._has_gripper else {})

    def disconnect(self) -> None:
        """Bring the arm to rest."""
        process, self._process = self._connected(), None
        process.close()
        for camera in self.cameras.values():
            camera.disconnect()

    def _ask(self, gripper: float) -> GripperAsk | None:
        """What an action asks of the gripper: something new only where it crosses the middle."""
        before, self._gripper = self._gripper, gripper
        if before is None or (before < 0.5) == (gripper < 0.5):
            return None
        return "close" if gripper < 0.5 else "open"

    def _connected(self) -> DrivingProcess:
        if self._process is None:
            raise DeviceNotConnectedError(f"{self} is not connected. Run `.connect()` first.")
        return self._process

    def _look(self) -> Seen:
        seen = self._connected().look()
        if seen.stopped != self._stopped:
            self._stopped = seen.stopped
            if seen.stopped:
                _logger.warning("The arm has stopped: %s", seen.stopped)
            else:
                _logger.warning("The arm may move again.")
        return seen
