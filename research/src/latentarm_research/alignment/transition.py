"""What an input does: the transition ``T(s, u) = s + phi(f(u, c), c) dt`` (equation 18), differentiable."""

from collections.abc import Sequence
from typing import NamedTuple, final

import torch
from torch import Tensor

from latentarm.alignment.poses import pose_weights
from latentarm.models.torch_decoder import TorchDecoder
from latentarm.robots.kinematics.chain import Chain
from latentarm.robots.kinematics.torch_chain import TorchChain


@final
class TorchPoses:
    """``Psi``: states (..., n) to vectors (..., 12 k) of all k tools' poses, as `pose_vectors` has them."""

    def __init__(self, chain: Chain, dtype: torch.dtype) -> None:
        self._tools = [TorchChain(chain, tool).to(dtype) for tool in range(len(chain.tools))]
        self._position_weight, self._rotation_weight = pose_weights(len(chain.tools))

    def __call__(self, state: Tensor) -> Tensor:
        """Pose vectors of states, m."""
        parts: list[Tensor] = []
        for tool in self._tools:
            position, rotation = tool(state)
            parts += [self._position_weight * position, self._rotation_weight * rotation.flatten(-2)]
        return torch.cat(parts, dim=-1)


class Place(NamedTuple):
    """Contexts, with what follows from them alone."""

    context: Tensor  # (..., c); its first n entries are the state, rad
    observed: Tensor  # (..., o), what the decoder sees; its first c entries are the context, normalised
    pose: Tensor  # (..., 12 k), see `pose_vectors`


class Push(NamedTuple):
    """Inputs held for one motion's time, and where they led."""

    before: Place  # where it began
    context: Tensor  # (..., c), the contexts that it led to; what follows the state in them (a belief) stayed
    pose: Tensor  # (..., 12 k), there

    @property
    def change(self) -> Tensor:
        """Δx, of the pose."""
        return self.pose - self.before.pose


@final
class Transition:
    """The arm under a frozen decoder, in steps of one motion's time."""

    def __init__(
        self,
        decoder: TorchDecoder,
        chain: Chain,
        duration_s: float,  # dt, s
    ) -> None:
        self._decoder = decoder
        self._poses = TorchPoses(chain, decoder.dtype)
        self._duration_s = duration_s

    def pose(self, context: Tensor) -> Tensor:
        """Psi: contexts (..., c) to pose vectors (..., 12 k)."""
        return self._poses(context[..., : self._decoder.action_dim])

    def place(self, context: Tensor) -> Place:
        """Contexts (..., c) as places."""
        return Place(context, self._decoder.observe(context), self.pose(context))

    def after(self, push: Push) -> Place:
        """Where a push led, as the place to push on from; gradients flow through all of it."""
        return Place(push.context, self._decoder.observe(push.context), push.pose)

    def push(self, place: Place, z: Tensor) -> Push:
        """Hold latent actions (..., d) for one motion's time."""
        step = self._duration_s * self._decoder.decode(z, place.observed)
        context = place.context + torch.nn.functional.pad(step, (0, place.context.shape[-1] - step.shape[-1]))
        return Push(place, context, self.pose(context))


def joined(places: Sequence[Place]) -> Place:
    """Places (S, B_i, ...) one after the other along the second axis."""
    return Place(*(torch.cat(parts, dim=1) for parts in zip(*places, strict=True)))


def parted(push: Push, sizes: Sequence[int]) -> list[Push]:
    """A push from joined places, in its parts again."""
    before = zip(*(part.split(list(sizes), dim=1) for part in push.before), strict=True)
    after = zip(push.context.split(list(sizes), dim=1), push.pose.split(list(sizes), dim=1), strict=True)
    return [Push(Place(*there), *here) for there, here in zip(before, after, strict=True)]
