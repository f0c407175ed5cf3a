"""LeRobot's tools drive an arm by a run's latent actions: ``--robot.type=latentarm``.

LeRobot imports this package because of the distribution's name; that registers the robot, and a joystick to
drive it with (``--teleop.type=latentarm_stick``).
"""

from lerobot_robot_latentarm.config_robot import LatentarmConfig
from lerobot_robot_latentarm.config_stick import LatentarmStickConfig
from lerobot_robot_latentarm.robot import Latentarm
from lerobot_robot_latentarm.stick import LatentarmStick

__all__ = ["Latentarm", "LatentarmConfig", "LatentarmStick", "LatentarmStickConfig"]
