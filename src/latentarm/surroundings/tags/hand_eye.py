"""Hand-eye calibration: a fixed camera with a board in the gripper, or a wrist camera with a fixed board."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final, Literal, final

import cv2
import numpy as np
from scipy.optimize import least_squares
from scipy.spatial.transform import Rotation

from latentarm.core.errors import UserError
from latentarm.core.types import FloatArray, IntArray
from latentarm.surroundings.tags.board import BoardView, board_pose
from latentarm.surroundings.tags.frames import inverse, mean_frame, moved, shifted, transform_of
from latentarm.surroundings.tags.lens import Lens

Mount = Literal["base", "tool"]

FEWEST_POSES: Final = 10
LEAST_TURN_DEG: Final = 10.0  # SD of the poses' turns about the second of their main axes
MOST_RESIDUAL_MM: Final = 5.0
MOST_RESIDUAL_DEG: Final = 1.0
MOST_SD_MM: Final = 5.0
MOST_SCALE: Final = 0.01  # by which the board may seem larger or smaller than stated, as a share
_METHODS: Final = (
    cv2.CALIB_HAND_EYE_TSAI,
    cv2.CALIB_HAND_EYE_PARK,
    cv2.CALIB_HAND_EYE_HORAUD,
    cv2.CALIB_HAND_EYE_ANDREFF,
    cv2.CALIB_HAND_EYE_DANIILIDIS,
)


@final
@dataclass(frozen=True, eq=False)
class Shot:
    """A picture of the board, and where the arm was."""

    name: str  # of the picture, for messages
    tool: FloatArray  # (4, 4), pose of the arm's end-effector in its base frame, m
    view: BoardView


@final
@dataclass(frozen=True, eq=False)
class HandEye:
    """Pose of a camera, and the residuals of its calibration."""

    camera: FloatArray  # (4, 4), its pose in the frame of the base or of the tool, m
    residual_mm: float  # RMS distance of the board from where the arm has it
    residual_deg: float  # RMS of its turn against that
    position_sd_m: float  # of the camera's position, along the worst axis, by leaving out each pose in turn
    orientation_sd_rad: float  # of its turn, about the worst axis


def calibrate_hand_eye(shots: Sequence[Shot], lens: Lens, mount: Mount) -> HandEye:
    """Calibrate from pictures at different poses of the arm.

    ``mount`` is what the camera is fixed to: ``base`` means still in the room, with the board in the
    gripper; ``tool`` means on the wrist, with the board still in the room.

    OpenCV's five methods give a start, of which the best is refined over all corners in all pictures.
    Raises UserError, which says what to do, where the poses do not determine it, or contradict each other.
    """
    posed = [(shot, pose) for shot in shots if (pose := board_pose(shot.view, lens)) is not None]
    if len(posed) < FEWEST_POSES:
        raise UserError(
            f"The board is visible at {len(posed)} poses, and {FEWEST_POSES} are needed: take it to more."
        )
    tools = np.array([shot.tool for shot, _ in posed])
    turned_deg = _second_turn_deg(tools)
    if turned_deg < LEAST_TURN_DEG:
        raise UserError(
            f"The poses are turned too much alike: by {turned_deg:.0f}° about the second of their axes, and"
            f" {LEAST_TURN_DEG:.0f}° are needed. Tilt and twist the gripper about all axes from pose to pose."
        )
    problem = _Problem([shot for shot, _ in posed], np.array([pose for _, pose in posed]), lens, mount)
    everyone = np.arange(len(posed))
    found = problem.refined(problem.start(), everyone)
    off_mm, off_deg = problem.residuals(found)
    residual_mm, residual_deg = (float(np.sqrt((off**2).mean())) for off in (off_mm, off_deg))
    if residual_mm > MOST_RESIDUAL_MM or residual_deg > MOST_RESIDUAL_DEG:
        worst = posed[int(np.argmax(off_mm / MOST_RESIDUAL_MM + off_deg / MOST_RESIDUAL_DEG))][0].name
        raise UserError(
            f"The board is {residual_mm:.1f} mm and {residual_deg:.2f}° from where the arm has it, and"
            f" {MOST_RESIDUAL_MM:g} mm and {MOST_RESIDUAL_DEG:g}° are the most: the worst is {worst}. Fix the"
            " board so that it cannot slip, measure its squares, and check that the arm's model is the arm."
        )
    scale, scale_sd = problem.scale(found)
    if abs(scale - 1.0) > max(MOST_SCALE, 3.0 * scale_sd):
        raise UserError(
            f"By the arm, the board is {100 * scale:.1f} % as large as stated: measure a square again, and"
            " check that the arm's model is the arm."
        )
    left_out = [problem.refined(found, np.delete(everyone, k)) for k in everyone]
    position_sd_m, orientation_sd_rad = _jackknife_sd([camera for camera, _ in left_out])
    if 1000.0 * position_sd_m > MOST_SD_MM:
        raise UserError(
            f"The camera's position is known to {1000 * position_sd_m:.1f} mm, and {MOST_SD_MM:g} mm is the"
            " most: add poses that differ more, with the board nearer to the camera."
        )
    return HandEye(found[0], residual_mm, residual_deg, position_sd_m, orientation_sd_rad)


@final
class _Problem:
    """One equation for both mounts: ``arm[i] @ camera @ seen[i] = board``, all (4, 4)."""

    def __init__(self, shots: Sequence[Shot], seen: FloatArray, lens: Lens, mount: Mount) -> None:
        tools = np.array([shot.tool for shot in shots])
        self._arm = tools if mount == "tool" else inverse(tools)
        self._seen = seen
        self._points = [shot.view.points for shot in shots]
        self._seen_at = [lens.normalised(shot.view.pixels) for shot in shots]

    def start(self) -> tuple[FloatArray, FloatArray]:
        """Poses of camera and board by the method of OpenCV that fits best."""
        arm, seen = self._arm, self._seen
        everyone = np.arange(len(arm))
        found: list[tuple[FloatArray, FloatArray]] = []
        for method in _METHODS:
            try:
                turn, position = cv2.calibrateHandEye(
                    list(arm[:, :3, :3]), list(arm[:, :3, 3]), list(seen[:, :3, :3]), list(seen[:, :3, 3]),
                    method=method,
                )  # fmt: skip
            except cv2.error:  # this method finds nothing
                continue
            camera = transform_of(turn, position)
            if np.isfinite(camera).all() and np.linalg.det(camera) > 0.5:
                found.append((camera, mean_frame(arm @ camera @ seen)))
        if not found:
            raise UserError("No place of the camera fits these poses: check that the arm's model is the arm.")
        return min(found, key=lambda one: float((self._off_m(one, everyone) ** 2).sum()))

    def refined(self, start: tuple[FloatArray, FloatArray], used: IntArray) -> tuple[FloatArray, FloatArray]:
        """Poses of camera and board with the least squared error of the corners in the used pictures."""

        def off_m(twists: FloatArray) -> FloatArray:
            return self._off_m(_shifted(start, twists), used)

        return _shifted(start, least_squares(off_m, np.zeros(12), method="lm").x)

    def scale(self, start: tuple[FloatArray, FloatArray]) -> tuple[float, float]:
        """The size of the board as a share of the stated one, where it is free too, and its SD."""

        def off_m(free: FloatArray) -> FloatArray:
            return self._off_m(_shifted(start, free[:12]), np.arange(len(self._arm)), 1.0 + free[12])

        best = least_squares(off_m, np.zeros(13), method="lm")
        # Corners of one picture err together, by what the arm's pose errs: they count as its six figures.
        variance = 2.0 * float(best.cost) / (6 * len(self._arm) - 13)
        return 1.0 + float(best.x[12]), float(
            np.sqrt(variance * np.linalg.inv(best.jac.T @ best.jac)[12, 12])
        )

    def residuals(self, found: tuple[FloatArray, FloatArray]) -> tuple[FloatArray, FloatArray]:
        """Residuals of the board at each pose, mm and degrees."""
        off = inverse(found[1]) @ self._arm @ found[0] @ self._seen
        turn = Rotation.from_matrix(off[:, :3, :3]).magnitude()
        return 1000.0 * np.linalg.norm(off[:, :3, 3], axis=-1), np.degrees(turn)

    def _off_m(self, found: tuple[FloatArray, FloatArray], used: IntArray, scale: float = 1.0) -> FloatArray:
        to_camera = inverse(self._arm @ found[0]) @ found[1]
        off: list[FloatArray] = []
        for k in used:
            at = moved(to_camera[k], scale * self._points[k])
            off.append((at[:, :2] - at[:, 2:] * self._seen_at[k]).ravel())
        return np.concatenate(off)


def _shifted(found: tuple[FloatArray, FloatArray], twists: FloatArray) -> tuple[FloatArray, FloatArray]:
    return shifted(found[0], twists[:6]), shifted(found[1], twists[6:])


def _second_turn_deg(tools: FloatArray) -> float:
    """SD of the turns (N, 4, 4) about the second of their main axes: a hand-eye problem needs two."""
    turns = Rotation.from_matrix(tools[:, :3, :3])
    away = (turns.mean().inv() * turns).as_rotvec()
    return float(np.degrees(np.sqrt(np.linalg.eigvalsh(away.T @ away / len(away))[1])))


def _jackknife_sd(left_out: Sequence[FloatArray]) -> tuple[float, float]:
    """SDs of position, m, and turn, rad, along their worst axes, from the results without each pose."""
    found = np.array(left_out)
    middle = mean_frame(found)
    shift = found[:, :3, 3] - middle[:3, 3]
    turn = Rotation.from_matrix(found[:, :3, :3] @ middle[:3, :3].T).as_rotvec()
    share = (len(found) - 1) / len(found)
    return tuple(float(np.sqrt(share * np.linalg.eigvalsh(one.T @ one)[-1])) for one in (shift, turn))  # pyright: ignore[reportReturnType]
