"""The pose of a thing from the corners of its tags in all views at once, and how sure it is."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final, final

import cv2
import numpy as np
from scipy.optimize import least_squares

from latentarm.core.types import FloatArray, IntArray
from latentarm.surroundings.tags.frames import inverse, moved, shifted, transform_of
from latentarm.surroundings.tags.lens import Lens

CORNER_PX: Final = 0.2  # SD of a corner that is assumed at least: blur and the lens leave errors in common
_NEAR_PX: Final = 12.0  # tags farther than this from where a first guess has them do not take part
_FITS_PX: Final = 1.2  # RMS over the corners of a tag beyond which it contradicts the others
_SURER: Final = 25.0  # by this much more squared error, in variances, the second best pose must be worse
_SAME_RAD: Final = 0.1  # poses nearer than this are one minimum
_SAME_GUESS_RAD: Final = 0.35  # guesses nearer than this lead to one
_MOST_GUESSES: Final = 6
_MOST_STEPS: Final = 25
_SHARE: Final = 1e-5  # of the squared error, or of the step, by which a step must still improve
_SCALE: Final = np.array([0.05, 0.05, 0.05, 1.0, 1.0, 1.0])  # m and rad that move corners alike
# (3, 9): p @ _CROSS is, by rows, the matrix that takes a small turn to the shift of p.
_CROSS: Final = np.array([np.cross(np.eye(3), axis) for axis in np.eye(3)]).mT.reshape(3, 9)
_HALF: Final = np.array([(-1.0, 1.0, 0.0), (1.0, 1.0, 0.0), (1.0, -1.0, 0.0), (-1.0, -1.0, 0.0)]) / 2.0


def corners_on_tag(size_m: float) -> FloatArray:
    """Corners of a tag in its own frame, (4, 3), m, in the detector's order: x right, y up, z out of it."""
    return size_m * _HALF


@final
@dataclass(frozen=True, eq=False)
class SeenTag:
    """A tag of a thing in one picture."""

    corners: FloatArray  # (4, 2), px
    lens: Lens
    camera: FloatArray  # (4, 4), the camera's pose in the arm's base frame, m
    size_m: float
    on_thing: FloatArray  # (4, 4), the tag's pose in the thing's frame, m


@final
@dataclass(frozen=True, eq=False)
class Solved:
    """A pose that the tags agree on."""

    pose: FloatArray  # (4, 4), of the thing in the arm's base frame, m
    covariance: FloatArray  # (6, 6), of position, m, and of the turn about the thing's origin, rad
    used: int  # tags that it rests on, each picture counted

    @property
    def position_sd_m(self) -> float:
        """SD along the worst direction, m."""
        return float(np.sqrt(np.linalg.eigvalsh(self.covariance[:3, :3])[-1]))

    @property
    def orientation_sd_rad(self) -> float:
        """SD of the turn about the worst axis, rad."""
        return float(np.sqrt(np.linalg.eigvalsh(self.covariance[3:, 3:])[-1]))


def solve(seen: Sequence[SeenTag], most_tilt_rad: float = np.pi) -> Solved | None:
    """The pose of the thing that all the tags are on; None where they do not agree on one.

    A square seen from nearly in front fits two poses. Both of every tag are tried against all tags in all
    pictures, if the thing would then lean by ``most_tilt_rad`` at most. Where two different poses fit about
    equally well, there is no answer. Tags that do not fit are left out; more than half must fit.
    """
    if not seen:
        return None
    problem = _Problem(seen)
    possible = [pose for tag in seen for pose in _two_poses(tag) if pose[2, 2] >= np.cos(most_tilt_rad)]
    guesses = _different(sorted(possible, key=problem.cost))
    fits = [fit for fit in map(problem.fit, guesses) if fit is not None]
    if not fits:
        return None
    best = min(fits, key=lambda fit: fit.cost)
    rivals = [fit for fit in fits if fit.cost < best.cost + _SURER * best.variance]
    if 2 * len(best.used) <= len(seen) or any(_apart_rad(fit.pose, best.pose) > _SAME_RAD for fit in rivals):
        return None
    return best.solved


@final
@dataclass(frozen=True, eq=False)
class _Fit:
    pose: FloatArray
    used: IntArray  # (U,), indices of the tags that fit
    cost: float  # squared error over all corners, bounded for each tag, px²
    variance: float  # of a residual, px²
    jacobian: FloatArray  # (8 U, 6)

    @property
    def solved(self) -> Solved:
        information: FloatArray = self.jacobian.T @ self.jacobian / self.variance
        return Solved(self.pose, np.asarray(np.linalg.inv(information), np.float64), len(self.used))


@final
class _Problem:
    def __init__(self, seen: Sequence[SeenTag]) -> None:
        self._points = np.array([moved(tag.on_thing, corners_on_tag(tag.size_m)) for tag in seen])
        self._to_camera = np.array([inverse(tag.camera) for tag in seen])
        self._seen = np.array([tag.lens.normalised(tag.corners) for tag in seen])
        self._focal_px = np.array([tag.lens.focal_px for tag in seen])
        self._all = np.arange(len(seen))

    def cost(self, pose: FloatArray) -> float:
        """Squared error over all corners, bounded for each tag, px²."""
        return 4.0 * float((np.minimum(self._rms_px(pose), _NEAR_PX) ** 2).sum())

    def fit(self, guess: FloatArray) -> _Fit | None:
        """The best pose near a guess, by the tags that fit it; None where none does."""
        used = np.flatnonzero(self._rms_px(guess) < _NEAR_PX)
        for _ in range(2 * len(self._points)):
            if not len(used):
                return None
            fit = self._refined(guess, used)
            off_px = self._rms_px(fit.pose)
            fits = np.flatnonzero(off_px < _FITS_PX)
            if np.array_equal(fits, used):
                return fit
            worst = used[np.argmax(off_px[used])]
            # One that is far off draws the pose away from the others, so only it leaves.
            used = fits if worst in fits else used[used != worst]
            guess = fit.pose
        return None

    def _refined(self, start: FloatArray, used: IntArray) -> _Fit:
        def off_px(twist: FloatArray) -> FloatArray:
            return self._residuals(shifted(start, twist), used).ravel()

        def by_twist(twist: FloatArray) -> FloatArray:
            return self._jacobian(shifted(start, twist), used)

        found = least_squares(
            off_px,
            np.zeros(6),
            jac=by_twist,  # pyright: ignore[reportArgumentType]
            method="lm",
            x_scale=_SCALE,
            ftol=_SHARE,
            xtol=_SHARE,
            max_nfev=_MOST_STEPS,
        )
        pose = shifted(start, found.x)
        variance = max(CORNER_PX**2, 2.0 * float(found.cost) / (8 * len(used) - 6))
        return _Fit(pose, used, self.cost(pose), variance, self._jacobian(pose, used))

    def _rms_px(self, pose: FloatArray) -> FloatArray:
        return np.sqrt((self._residuals(pose, self._all) ** 2).sum(axis=-1).mean(axis=-1))

    def _in_camera(self, pose: FloatArray, used: IntArray) -> FloatArray:
        return moved(self._to_camera[used], moved(pose, self._points[used]))

    def _residuals(self, pose: FloatArray, used: IntArray) -> FloatArray:
        """(U, 4, 2), px."""
        at = self._in_camera(pose, used)
        depth = np.maximum(at[..., 2:], 1e-3)  # no camera sees what is behind it
        return (at[..., :2] / depth - self._seen[used]) * self._focal_px[used, None, None]

    def _jacobian(self, pose: FloatArray, used: IntArray) -> FloatArray:
        """(8 U, 6), of `_residuals` by a shift of the pose, px/m and px/rad."""
        at = self._in_camera(pose, used)
        scale = self._focal_px[used, None, None] / np.maximum(at[..., 2:], 1e-3)
        by_point = np.zeros((*at.shape[:-1], 2, 3))  # in the camera's frame
        by_point[..., 0, 0] = by_point[..., 1, 1] = scale[..., 0]
        by_point[..., 2] = -scale * at[..., :2] / np.maximum(at[..., 2:], 1e-3)
        by_point = by_point @ self._to_camera[used, None, :3, :3]
        arm = self._points[used] @ pose[:3, :3].T
        by_turn = by_point @ (arm @ _CROSS).reshape(*arm.shape, 3)
        return np.concatenate([by_point, by_turn], axis=-1).reshape(-1, 6)


def _two_poses(tag: SeenTag) -> list[FloatArray]:
    """Both poses of the thing that fit one tag in one picture, the better one first."""
    count, turns, positions, _ = cv2.solvePnPGeneric(
        corners_on_tag(tag.size_m),
        tag.lens.normalised(tag.corners),
        np.eye(3),
        None,
        flags=cv2.SOLVEPNP_IPPE_SQUARE,
    )
    to_tag = inverse(tag.on_thing)
    return [tag.camera @ transform_of(turns[k], positions[k]) @ to_tag for k in range(count)]


def _different(guesses: Sequence[FloatArray]) -> list[FloatArray]:
    """The guesses without those that an earlier one is near."""
    kept: list[FloatArray] = []
    for guess in guesses:
        if all(_apart_rad(guess, one) > _SAME_GUESS_RAD for one in kept):
            kept.append(guess)
    return kept[:_MOST_GUESSES]


def _apart_rad(one: FloatArray, other: FloatArray) -> float:
    cosine = (np.trace(one[:3, :3].T @ other[:3, :3]) - 1.0) / 2.0
    return float(np.arccos(np.clip(cosine, -1.0, 1.0)))
