"""What ``--robot.type=latentarm`` is told."""

from dataclasses import dataclass, field

from lerobot.cameras import CameraConfig
from lerobot.robots import RobotConfig


@RobotConfig.register_subclass("latentarm")
@dataclass(kw_only=True)
class LatentarmConfig(RobotConfig):
    """An arm that is driven by a run's latent actions.

    Attributes:
        run: folder of a trained run (`latentarm train`).
        arm: what moves: a simulated arm, or the address of a real one, as `latentarm teleop --arm` takes it.
        profile: the person whose alignment is used (`latentarm align`); z = u without one.
        seed: of where a simulated arm starts.
        cameras: as those of LeRobot's own robots.
    """

    run: str
    arm: str = "kinematic"
    profile: str | None = None
    seed: int = 0
    cameras: dict[str, CameraConfig] = field(default_factory=dict)
