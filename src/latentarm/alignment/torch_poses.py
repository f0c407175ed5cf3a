"""`pose_vectors` in torch, differentiable with respect to the state."""

from typing import final

import torch
from torch import Tensor

from latentarm.alignment.poses import pose_weights
from latentarm.kinematics.chain import Chain
from latentarm.kinematics.torch_chain import TorchChain


@final
class TorchPoses:
    """``Psi``: states (..., n) to vectors (..., 12 k) of all k tools' poses, as `pose_vectors` has them.

    Args:
        chain: the arm.
        dtype: of all tensors.
    """

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
