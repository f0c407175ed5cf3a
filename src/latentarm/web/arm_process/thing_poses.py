"""Poses of the things about a simulated arm, for pages."""

from typing import Final, final

from latentarm.arms.contract import SceneArm
from latentarm.core.types import NO_THINGS, FloatArray
from latentarm.robots.kinematics.pose_rows import thing_rows
from latentarm.robots.scene.scene import Scene
from latentarm.web.protocol.report import Things
from latentarm.web.protocol.things import things_at

_EVERY: Final = 4  # ticks between two looks: 25 looks per second; pages interpolate


@final
class ThingPoses:
    """Reads the poses of the things about an arm every few ticks; none without a scene."""

    def __init__(self, scene: Scene | None, arm: SceneArm | None) -> None:
        self._scene = scene
        self._arm = arm

    @property
    def names(self) -> tuple[str, ...]:
        """The things, in the order of the scene."""
        if self._scene is None or self._arm is None:
            return ()
        return self._scene.names

    def rows(self) -> FloatArray:
        """Their poses, (K, 7), see `StepRecord.things`."""
        return NO_THINGS if self._arm is None else thing_rows(self._arm.scene_state().poses, self.names)

    def look(self, tick: int) -> Things | None:
        """Where everything is; None in ticks without a look."""
        if self._scene is None or self._arm is None or tick % _EVERY:
            return None
        return things_at(self._scene, self._arm.scene_state())
