"""A bowl, a cup and a spoon with tags, and a board, as MuJoCo renders them for two cameras."""

from collections.abc import Mapping, Sequence
from typing import Any, Final, final

import cv2
import mujoco
import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from latentarm.core.types import FloatArray
from latentarm.surroundings.tags.board import Board
from latentarm.surroundings.tags.detecting import FAMILIES
from latentarm.surroundings.tags.files import TagEntry
from latentarm.surroundings.tags.frames import frame
from latentarm.surroundings.tags.lens import Lens

FAMILY: Final = "apriltag_36h11"
WIDE, HIGH = 640, 480  # px
BOARD: Final = Board(7, 5, 0.03)
_FOV_DEG: Final = 45.0
_FOCAL_PX: Final = HIGH / 2 / np.tan(np.radians(_FOV_DEG / 2))
_MATRIX: Final = [[_FOCAL_PX, 0, (WIDE - 1) / 2], [0, _FOCAL_PX, (HIGH - 1) / 2], [0, 0, 1]]
LENS: Final = Lens((WIDE, HIGH), np.array(_MATRIX), np.zeros(5))
_AWAY: Final = frame(np.eye(3), np.array([0.0, 0.0, -9.0]))
_BOX, _ROD, _TIN = (getattr(mujoco.mjtGeom, f"mjGEOM_{name}") for name in ("BOX", "CAPSULE", "CYLINDER"))
PARTS: Final = {  # of each body: shape, size, m, and position, m
    "bowl": [(_BOX, [0.16, 0.16, 0.003], [0, 0, -0.004]), (_TIN, [0.06, 0.03, 0], [0, 0, 0.03])],
    "cup": [(_TIN, [0.04, 0.05, 0], [0, 0, 0.05])],
    "spoon": [(_BOX, [0.1, 0.006, 0.004], [0, 0, 0])],
    "arm": [(_ROD, [0.04, 0.25, 0], [0, 0, 0.25])],
    "board": [],
}


def tags_on_things() -> list[TagEntry]:
    """Four tags on the bowl's tray, four upright around the cup, and one on the spoon."""
    quarters = [Rotation.from_euler("z", 90 * k, degrees=True) for k in range(4)]
    upright = Rotation.from_euler("xyz", [90, 0, 90], degrees=True)
    placed = [("bowl", 0.04, turn.apply([0.13, 0.0, 0.0]), turn) for turn in quarters]
    placed += [("cup", 0.04, turn.apply([0.045, 0.0, 0.05]), turn * upright) for turn in quarters]
    placed.append(("spoon", 0.05, np.array([-0.1, 0.0, 0.01]), Rotation.identity()))
    return [
        TagEntry(
            id=k,
            thing=thing,
            size_m=size,
            position_m=at,
            quaternion_wxyz=turn.as_quat(scalar_first=True),
            most_tilt_deg=45.0,
        )
        for k, (thing, size, at, turn) in enumerate(placed)
    ]


@final
class Room:
    """The things, and two cameras at poses ``cameras`` (4, 4)."""

    def __init__(
        self,
        parts: Mapping[str, Sequence[Any]] = PARTS,  # of each body
        tags: Sequence[TagEntry] | None = None,  # by default `tags_on_things`
        finer: int = 3,  # each pixel is the mean of so many squared
    ) -> None:
        self.names = tuple(parts)
        spec = mujoco.MjSpec()
        spec.visual.global_.offwidth, spec.visual.global_.offheight = WIDE * finer, HIGH * finer
        spec.visual.headlight.active, spec.visual.map.znear = 0, 0.005
        world, sun = spec.worldbody, mujoco.mjtLightType.mjLIGHT_DIRECTIONAL
        world.add_light(type=sun, dir=[0.2, 0.1, -1], diffuse=[0.6] * 3, ambient=[0.3] * 3)
        world.add_geom(type=_BOX, size=[0.7, 0.7, 0.01], pos=[0.4, 0, -0.02], rgba=[0.5, 0.4, 0.3, 1])
        bodies = {name: world.add_body(name=name, mocap=True) for name in parts}
        for name, solids in parts.items():
            for shape, size, at in solids:
                bodies[name].add_geom(type=shape, size=size, pos=at, rgba=[0.7, 0.5, 0.4, 1])
        family = cv2.aruco.getPredefinedDictionary(FAMILIES[FAMILY])
        for tag in tags_on_things() if tags is None else tags:
            image = cv2.aruco.generateImageMarker(family, tag.id, 400)
            image = cv2.copyMakeBorder(image, 50, 50, 50, 50, cv2.BORDER_CONSTANT, value=255)
            _stick(spec, bodies[tag.thing], image, tag.size_m * 500 / 400, tag.pose)
        middle = np.array([BOARD.columns, BOARD.rows, 0.0]) * BOARD.square_m / 2.0
        facing = frame(np.diag([1.0, -1.0, -1.0]), middle)  # the board's own z leads into it
        image = BOARD.made.generateImage((100 * BOARD.columns, 100 * BOARD.rows))
        if "board" in bodies:
            _stick(spec, bodies["board"], image, BOARD.columns * BOARD.square_m, facing)
        self.cameras = [_looking(np.array([0.95, y, 0.55]), np.array([0.45, 0, 0.03])) for y in (-0.45, 0.45)]
        for number, pose in enumerate(self.cameras):
            turn = _quaternion(pose[:3, :3] @ np.diag([1.0, -1.0, -1.0]))
            world.add_camera(name=str(number), pos=pose[:3, 3], quat=turn, fovy=_FOV_DEG)
        self._model = spec.compile()
        self._data = mujoco.MjData(self._model)
        self._renderer = mujoco.Renderer(self._model, HIGH * finer, WIDE * finer)

    def put(self, poses: dict[str, FloatArray]) -> None:
        """Place things by name, and take all others away."""
        for name in self.names:
            number, pose = self._model.body(name).mocapid[0], poses.get(name, _AWAY)
            self._data.mocap_pos[number] = pose[:3, 3]
            self._data.mocap_quat[number] = _quaternion(pose[:3, :3])
        mujoco.mj_forward(self._model, self._data)

    def picture(self, camera: int) -> NDArray[np.float64]:
        """A clear picture in grey, (H, W)."""
        self._renderer.update_scene(self._data, str(camera))
        grey = cv2.cvtColor(self._renderer.render(), cv2.COLOR_RGB2GRAY)
        return cv2.resize(grey, (WIDE, HIGH), interpolation=cv2.INTER_AREA).astype(np.float64)


def _stick(spec: Any, body: Any, image: NDArray[Any], wide_m: float, pose: FloatArray) -> None:
    """Put a flat picture on a body, its middle and its outward z at a pose."""
    name = f"picture {len(spec.textures)}"
    high, wide = image.shape
    texture = spec.add_texture(
        name=name, type=mujoco.mjtTexture.mjTEXTURE_2D, width=wide, height=high, nchannel=3
    )
    texture.data = np.repeat(image[..., None], 3, axis=2).tobytes()
    material = spec.add_material(name=name, specular=0.1)
    material.textures[mujoco.mjtTextureRole.mjTEXROLE_RGB] = name
    size = [wide_m / 2, wide_m / 2 * high / wide, 0.0005]
    at = pose[:3, 3] - 0.0005 * pose[:3, 2]
    body.add_geom(type=_BOX, size=size, pos=at, quat=_quaternion(pose[:3, :3]), material=name)


def _looking(eye: FloatArray, at: FloatArray) -> FloatArray:
    ahead: FloatArray = (at - eye) / np.linalg.norm(at - eye)
    right = np.array([ahead[1], -ahead[0], 0.0]) / np.hypot(ahead[0], ahead[1])
    return frame(np.stack([right, np.cross(ahead, right), ahead], axis=1).astype(np.float64), eye)


def _quaternion(rotation: FloatArray) -> FloatArray:
    return Rotation.from_matrix(rotation).as_quat(scalar_first=True)
