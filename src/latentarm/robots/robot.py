"""A robot as everything else sees it; importing this loads no physics engine."""

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, final

from latentarm.core.types import FloatArray, IntArray, StatedLimits
from latentarm.robots.attachment import Attachment
from latentarm.robots.gripper import Gripper
from latentarm.robots.kinematics.chain import Capsules, Chain
from latentarm.robots.limits import JointLimits, Source

if TYPE_CHECKING:
    import mujoco


@final
@dataclass(frozen=True, eq=False)
class Robot:
    """An arm: how it moves, how far and how fast it may, and the room it takes.

    Attributes:
        name: its name in the catalogue, or the path of its model.
        chain: its kinematics; the first tool is the end-effector.
        limits: of its joints, and how each is known.
        home: (n,), a configuration to start from, rad.
        capsules: its shape, for distances online.
        self_pairs: (P, 2), index pairs of capsules that could collide with each other.
        mjcf: its model as MJCF text; mesh files in it have absolute paths.
        tool_speed_limit: largest speed of the tool, m/s.
        tool_speed_source: how that is known.
        model_path: the file that the model was read from, or None for a built-in robot.
        still_joints: joints of the model's arms that do not move the end-effector; they stay where they are.
        driven_fingers: joints that look like a gripper's and are driven as the arm's.
        stated_limits: what a limits file says of it, or None.
        gripper: its gripper, or None where it has none that can be driven.
        attachment: what it carries in its hand, or None.
        tuck: (n,), a configuration in which it is out of the way, rad; None where its model states none.
        home_stated: whether the robot or its model states ``home``; else it is the middle of the joints'
            ranges, where an arm need not ever have been.
    """

    name: str
    chain: Chain
    limits: JointLimits
    home: FloatArray
    capsules: Capsules
    self_pairs: IntArray
    mjcf: str = field(repr=False)
    tool_speed_limit: float
    tool_speed_source: Source = "assumed"
    model_path: str | None = None
    still_joints: tuple[str, ...] = ()
    driven_fingers: tuple[str, ...] = ()
    stated_limits: StatedLimits | None = None
    gripper: Gripper | None = None
    attachment: Attachment | None = None
    tuck: FloatArray | None = None
    home_stated: bool = True

    @property
    def dof(self) -> int:
        """Number of joints n."""
        return self.chain.dof

    @property
    def joint_names(self) -> tuple[str, ...]:
        """The n joints' names."""
        return self.chain.joint_names

    @property
    def end_effector(self) -> str | None:
        """The end-effector to name when loading this robot again; None for a built-in robot."""
        return None if self.model_path is None else self.chain.tools[0].name

    def model(self) -> "mujoco.MjModel":
        """The robot's MuJoCo model, compiled anew."""
        import mujoco

        return mujoco.MjModel.from_xml_string(self.mjcf)
