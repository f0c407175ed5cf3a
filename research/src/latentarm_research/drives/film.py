"""Film strips: a drive at a task with things as a few pictures side by side, rendered by MuJoCo."""

import copy
import warnings
from collections.abc import Sequence
from dataclasses import dataclass, replace
from textwrap import fill
from typing import TYPE_CHECKING, Final, final

import mujoco
import numpy as np
from numpy.typing import NDArray

from latentarm.arms.contract import Arm
from latentarm.arms.mujoco import MujocoArm
from latentarm.core.errors import UserError
from latentarm.core.figure_style import FONT_SIZE, SMALL_FONT_SIZE, TWO_COLUMNS_MM, new_figure
from latentarm.core.types import FloatArray

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from latentarm_research.drives.trace import Trace

PERIOD_S: Final = 0.1
"""How often a picture may be taken, s."""

FRAMES: Final = 8
ACROSS: Final = 4
"""Pictures in a row of a strip."""

ROW_MM: Final = 43.0
HEAD_MM: Final = 7.0

CHARACTERS: Final = 28
"""In a line under a picture."""

AMBIENT: Final = 0.5
DIFFUSE: Final = 0.6
"""Light from all sides and from the camera."""

Image = NDArray[np.uint8]
"""(H, W, 3), red, green, blue."""


@final
@dataclass(frozen=True)
class Camera:
    """From where pictures are taken, and their size."""

    # (3,), what is in the middle, in the base frame of the arm, m
    look_at: tuple[float, float, float] = (0.5, 0.0, 0.15)
    distance_m: float = 0.5  # from there, m
    azimuth_deg: float = 155.0  # in which direction it looks, from x towards y
    elevation_deg: float = -36.0  # how far up it looks; below 0 it looks down
    width: int = 480  # pixels
    height: int = 360  # pixels


WHOLE: Final = Camera(look_at=(0.15, -0.22, 0.36), distance_m=1.5, azimuth_deg=150.0, elevation_deg=-18.0)
"""All of an arm the size of a Panda, from its base to what it does on a table, with room for the corner."""

SKY: Final = 238  # grey of what is behind everything, which MuJoCo leaves black

EDGE_PX: Final = 3

CLOSE_SHARE: Final = 0.46
"""Width of the picture from close by, in the corner of that of the whole arm."""


@final
class Film:
    """Watches a drive, and renders moments of it afterwards.

    Give `sees` to `latentarm_research.drives.drive.drive` as ``watch``.
    """

    def __init__(self) -> None:
        self._model: mujoco.MjModel | None = None
        self._time_s: list[float] = []
        self._positions: list[FloatArray] = []

    def sees(self, arm: Arm) -> None:
        """Remember where everything is."""
        if not isinstance(arm, MujocoArm):
            raise UserError(f"A film needs an arm in MuJoCo, not {type(arm).__name__}: take the arm mujoco.")
        time_s = float(arm.data.time)
        self._model = arm.model
        if not self._time_s or time_s - self._time_s[-1] >= PERIOD_S - 1e-9:
            self._time_s.append(time_s)
            self._positions.append(arm.data.qpos.copy())

    def frames(self, camera: Camera, count: int = FRAMES) -> tuple[list[float], list[Image]]:
        """Moments of the drive, evenly spaced: when each was, s, and the arm, with a close-up in a corner."""
        if self._model is None:
            raise UserError("There is nothing to show: no drive was watched.")
        chosen = np.linspace(0, len(self._time_s) - 1, count).round().astype(int)
        positions = [self._positions[index] for index in chosen]
        near = replace(camera, width=int(CLOSE_SHARE * WHOLE.width), height=int(CLOSE_SHARE * WHOLE.height))
        pictures = _render(self._model, positions, WHOLE)
        for picture, close in zip(pictures, _render(self._model, positions, near), strict=True):
            high, wide = close.shape[:2]
            picture[-high - EDGE_PX :, : wide + EDGE_PX] = 255
            picture[-high:, :wide] = close
        return [self._time_s[index] for index in chosen], pictures


def strip(heading: str, time_s: Sequence[float], pictures: Sequence[Image], trace: "Trace") -> "Figure":
    """Pictures of a drive in rows, each with the time and the step that is under way."""
    down = -(-len(pictures) // ACROSS)
    figure = new_figure(ROW_MM * down + HEAD_MM, TWO_COLUMNS_MM)
    figure.suptitle(heading, fontsize=FONT_SIZE)
    figure.set_layout_engine("constrained", w_pad=0.02, h_pad=0.02, wspace=0.0, hspace=0.0)
    panels = np.ravel(figure.subplots(down, ACROSS, squeeze=False))
    for axes in panels:
        axes.set(xticks=[], yticks=[])
        axes.spines[:].set_visible(False)
    for axes, at_s, picture in zip(panels, time_s, pictures, strict=False):
        axes.imshow(picture)
        said = fill(f"{at_s:.1f} s: {_under_way(trace, at_s)}", CHARACTERS)
        axes.set_xlabel(said, fontsize=SMALL_FONT_SIZE)
    return figure


def _under_way(trace: "Trace", at_s: float) -> str:
    """The step that is to be done at a time, in words."""
    done = int(np.searchsorted(trace.done_s, at_s, side="right"))
    return trace.steps[done].name if done < len(trace.steps) else "done"


def _render(model: mujoco.MjModel, positions: Sequence[FloatArray], camera: Camera) -> list[Image]:
    lit = copy.copy(model)
    lit.vis.headlight.ambient[:] = AMBIENT
    lit.vis.headlight.diffuse[:] = DIFFUSE
    data = mujoco.MjData(lit)
    seen_from = mujoco.MjvCamera()
    seen_from.lookat[:] = camera.look_at
    seen_from.distance = camera.distance_m
    seen_from.azimuth, seen_from.elevation = camera.azimuth_deg, camera.elevation_deg
    pictures: list[Image] = []
    with _renderer(lit, camera) as renderer:
        for position in positions:
            data.qpos[:] = position
            mujoco.mj_forward(lit, data)
            renderer.update_scene(data, seen_from)
            picture = renderer.render()
            picture[(picture == 0).all(axis=-1)] = SKY
            pictures.append(picture)
    return pictures


def _renderer(model: mujoco.MjModel, camera: Camera) -> mujoco.Renderer:
    """A renderer of this model. Raises UserError where this computer cannot render."""
    with warnings.catch_warnings():
        # Without a screen GLFW warns before MuJoCo fails.
        warnings.simplefilter("ignore")
        try:
            return mujoco.Renderer(model, camera.height, camera.width)
        except (mujoco.FatalError, AttributeError, ImportError, RuntimeError) as error:
            raise UserError(
                f"MuJoCo cannot render here ({error}): set MUJOCO_GL=egl before Python starts, and install"
                " EGL (Debian: libegl1 and libgl1-mesa-dri)."
            ) from error
