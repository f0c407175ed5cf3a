"""What ``--teleop.type=latentarm_stick`` is told."""

from dataclasses import dataclass

from lerobot.teleoperators import TeleoperatorConfig


@TeleoperatorConfig.register_subclass("latentarm_stick")
@dataclass(kw_only=True)
class LatentarmStickConfig(TeleoperatorConfig):
    """A joystick or gamepad of Linux.

    Attributes:
        device: of the kernel's joystick interface.
        axes: numbers of the device's axes that are z.0, z.1, ...; one that is written with a minus sign, as
            in ``-1``, is reversed, and so is ``-0``.
        gripper_button: number of the button that opens and closes the gripper.
    """

    device: str = "/dev/input/js0"
    axes: tuple[str, ...] = ("0", "-1")
    gripper_button: int = 0
