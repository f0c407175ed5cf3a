"""The stick's frame before any answer: on the page, Right leads right and Up leads up or away.

``z = R(theta(x)) M u``: the stick turns smoothly with the place, and may be mirrored everywhere. Rest, half a
push and the opposite push keep their meaning for the decoder.
"""

from dataclasses import dataclass
from typing import Final, final

import numpy as np

from latentarm.alignment.contract import Seat
from latentarm.alignment.meaning import Meaning, rotations
from latentarm.alignment.poses import pose_vectors, pose_vectors_at
from latentarm.alignment.twists import tool_jacobian
from latentarm.core.errors import UserError
from latentarm.core.types import FloatArray
from latentarm.models.decoder import Decoder
from latentarm.robots.kinematics.chain import Chain

CAMERAS: Final[dict[Seat, tuple[float, float, float]]] = {
    "facing": (1.0, 0.0, 0.42),
    "behind": (-1.0, -0.55, 0.75),
}
"""The camera of the page's first view, in the base frame."""

FLAT: Final = (0.0, -0.01, 1.0)  # the same where the whole arm moves in one plane
FLAT_SHARE: Final = 0.1  # an arm whose height is below this share of its reach is shown like that
STEEPEST_RAD_M: Final = 5.0
"""The most that the stick turns per distance between poses, see `pose_vectors`, rad/m."""

LENGTH_M: Final = 0.3  # distance between poses over which the turn changes
ROUGHNESS: Final = 0.01  # weight of the turn's roughness at first, where perfect agreement weighs 2
CONTEXTS: Final = 500
CENTRES: Final = 32
PUSHES: Final = 16
STEPS: Final = 20
"""Sizes of the fit: most contexts, most kernel centres, directions of the stick, and iterations."""


@final
@dataclass(frozen=True, eq=False)
class StickFrame:
    """An alignment that turns the stick with the place, for a person without a profile.

    While the tools move by a distance e between poses, a held push u turns by `STEEPEST_RAD_M` e at most, and
    z changes by at most ``max(‖u‖, ‖u‖^2)`` times that.

    Raises UserError where the stick would turn more steeply, or it is not a turned and perhaps mirrored one.
    """

    turning: Meaning  # ``R(theta(x)) M``, (2, 2) by place
    chain: Chain

    def __post_init__(self) -> None:
        turning = self.turning
        rough = turning.turn_rad @ _kernel(turning.place, turning.place) @ turning.turn_rad
        square = turning.matrix @ turning.matrix.T
        if not np.allclose(square, np.eye(2)) or not rough <= (STEEPEST_RAD_M * LENGTH_M) ** 2:
            raise UserError("The stick turns more steeply than a frame may, or is stretched.")

    def __call__(self, u: FloatArray, context: FloatArray) -> FloatArray:
        """Latent actions (..., 2) of inputs (..., 2) in contexts (..., c), whose leading axes broadcast.

        They are as long as the inputs, but shortened where they would leave [-1, 1]^2.
        """
        z = np.matvec(self.turning(pose_vectors(self.chain, context[..., : self.chain.dof])), u)
        return z / np.maximum(np.abs(z).max(axis=-1, keepdims=True), 1.0)


def fit_frame(decoder: Decoder, chain: Chain, contexts: FloatArray, seat: Seat) -> StickFrame:
    """Turn and mirror the stick so that a push leads where it points: right and up or away.

    Along these two directions, pushes e in a context lead to velocities v(e), in units of the tools' root
    mean square speed there. The turn and the mirror maximise the mean of ``v(R M u) · u`` over all directions
    of u and all contexts, so places count little where the decoder hardly moves the tool along either.

    Contexts are (N, c); the first `CONTEXTS` count, and of the arm the first tool.
    """
    contexts = contexts[:CONTEXTS]
    transforms = chain.link_transforms(contexts[:, : chain.dof])
    angle = 2 * np.pi / PUSHES * np.arange(PUSHES)
    pushes = np.stack([np.cos(angle), np.sin(angle)], axis=-1)
    action = decoder.decode(pushes, contexts[:, None])
    twist = np.matvec(tool_jacobian(chain, transforms)[:, None], action)
    size = np.sqrt(np.square(twist).sum(axis=-1).mean(axis=-1))[:, None, None]
    velocity = twist[..., :3] / np.maximum(size, 1e-9)
    seen = velocity @ right_and_up(velocity.reshape(-1, 3), view(transforms, seat)).T
    gain = 2 / PUSHES * np.einsum("nki,nkj->nij", seen, np.broadcast_to(pushes, seen.shape))
    place = pose_vectors_at(chain, transforms)
    fits: list[tuple[float, Meaning]] = []
    for up in (1.0, -1.0):
        # The trace of gain R(theta) M is cos(theta) even + sin(theta) odd.
        even, odd = gain[:, 0, 0] + up * gain[:, 1, 1], gain[:, 0, 1] - up * gain[:, 1, 0]
        fits.append(_fit(place, even, odd, np.diag([1.0, up])))
    return StickFrame(max(fits, key=lambda fit: fit[0])[1], chain)


def right_and_up(velocity: FloatArray, view: FloatArray) -> FloatArray:
    """Directions (2, 3), unit vectors of the base frame, that the axes of the stick should follow.

    The first is right. The second is that direction across it along which the tool, with velocities (N, 3),
    moves most, be it up or away, with the sign that is up in the `view`.
    """
    across = np.stack([view[1], np.cross(*view)])
    up = np.linalg.svd(velocity @ across.T, full_matrices=False)[2][0] @ across
    return np.stack([view[0], up if up @ view[1] >= 0 else -up])


def view(transforms: FloatArray, seat: Seat) -> FloatArray:
    """Right and up of the page's first view, (2, 3), unit vectors of the base frame.

    ``transforms`` (N, n, 4, 4) are those of the arm's links in some of its states.
    """
    across, along, height = np.ptp(transforms[..., :3, 3], axis=(0, 1))
    camera = np.array(FLAT if height < FLAT_SHARE * max(across, along) else CAMERAS[seat])
    right = np.cross([0.0, 0.0, 1.0], camera)
    up = np.cross(camera, right)
    return np.stack([right / np.linalg.norm(right), up / np.linalg.norm(up)])


def _fit(place: FloatArray, even: FloatArray, odd: FloatArray, mirror: FloatArray) -> tuple[float, Meaning]:
    """The smooth turn that maximises the mean of ``cos(theta) even + sin(theta) odd``, and that mean.

    Each step maximises a quadratic lower bound, so no step loses. The turn's norm in the Hilbert space of its
    kernel is at most ``STEEPEST_RAD_M LENGTH_M``, and a function of norm 1 changes by at most
    ``‖x - x'‖ / LENGTH_M`` between two places.
    """
    weight, goal = np.hypot(even, odd) / len(place), np.arctan2(odd, even)
    centres = place[_apart(place)]
    columns = np.concatenate([np.ones((len(place), 1)), _kernel(place, centres)], axis=1)
    rough = np.zeros((columns.shape[1],) * 2)
    rough[1:, 1:] = _kernel(centres, centres) + 1e-6 * np.eye(len(centres))
    weights, roughness, norm = np.zeros(len(rough)), ROUGHNESS, np.inf
    while norm > STEEPEST_RAD_M * LENGTH_M:
        normal = columns.T @ (weight[:, None] * columns) + roughness * rough + 1e-9 * np.eye(len(rough))
        least_squares = np.linalg.solve(normal, weight * columns.T)
        weights = np.eye(len(rough))[0] * np.arctan2(odd.sum(), even.sum())
        for _ in range(STEPS):
            turn = columns @ weights
            weights = least_squares @ (turn + np.sin(goal - turn))
        norm, roughness = np.sqrt(weights @ rough @ weights), 2 * roughness
    agreement = weight @ np.cos(columns @ weights - goal)
    return float(agreement), Meaning(rotations(weights[0]) @ mirror, centres, weights[1:], LENGTH_M)


def _kernel(place: FloatArray, centres: FloatArray) -> FloatArray:
    return np.exp(-0.5 * np.square(place[:, None] - centres).sum(axis=-1) / LENGTH_M**2)


def _apart(place: FloatArray) -> list[int]:
    """Indices of places that lie far apart: each next one is the farthest from all before."""
    chosen = [0]
    near = np.square(place - place[0]).sum(axis=-1)
    while len(chosen) < min(CENTRES, len(place)):
        chosen.append(int(near.argmax()))
        near = np.minimum(near, np.square(place - place[chosen[-1]]).sum(axis=-1))
    return chosen
