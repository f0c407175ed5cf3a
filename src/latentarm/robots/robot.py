"""A robot as plain data; importing this loads no physics engine."""

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, final

from latentarm.core.types import FloatArray, IntArray, StatedLimits
from latentarm.robots.gripper import Gripper
from latentarm.robots.kinematics.chain import Capsules, Chain
from latentarm.robots.limits import JointLimits, Source
from latentarm.robots.tines import Tines

if TYPE_CHECKING:
    import mujoco


@final
@dataclass(frozen=True, eq=False)
class Robot:
    """An arm: its kinematics, limits and shape."""

    name: str  # in the catalogue, or the path of its model
    chain: Chain  # the first tool is the end-effector
    limits: JointLimits
    home: FloatArray  # (n,), start configuration, rad
    capsules: Capsules  # its shape, for distances online
    self_pairs: IntArray  # (P, 2), index pairs of capsules that could collide with each other
    mjcf: str = field(repr=False)  # MJCF text; mesh files in it have absolute paths
    tool_speed_limit: float  # m/s
    tool_speed_source: Source = "assumed"
    model_path: str | None = None  # None for a built-in robot
    # joints of the model's arms that do not move the end-effector and stay where they are
    still_joints: tuple[str, ...] = ()
    driven_fingers: tuple[str, ...] = ()  # joints that look like a gripper's and are driven as the arm's
    stated_limits: StatedLimits | None = None  # from a limits file, or None
    gripper: Gripper | None = None  # None where there is none to command
    tines: Tines | None = None  # of the fork that it holds, or None
    # (n,), a configuration out of the way, rad; None where its model states none
    tuck: FloatArray | None = None
    # whether the robot or its model states ``home``; else it is the middle of the joints' ranges, where an
    # arm may never have been
    home_stated: bool = True
    held: int = 0  # how many of the capsules, the last ones, stand for what the gripper holds

    @property
    def dof(self) -> int:
        """Number of joints n."""
        return self.chain.dof

    @property
    def joint_names(self) -> tuple[str, ...]:
        """Names of the n joints."""
        return self.chain.joint_names

    @property
    def end_effector(self) -> str | None:
        """Name of the end-effector for loading this robot again; None for a built-in robot."""
        return None if self.model_path is None else self.chain.tools[0].name

    def model(self) -> "mujoco.MjModel":
        """A newly compiled MuJoCo model."""
        import mujoco

        return mujoco.MjModel.from_xml_string(self.mjcf)
