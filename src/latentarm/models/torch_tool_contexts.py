"""`ToolContexts` and the metric of the tools in torch, differentiable with respect to the state.

Joint velocities a come with their weighted twists J_w a of `latentarm.models.tool_contexts`; then
``a^T G b = (J_w a)^T (J_w b) + damping a^T b``, and G itself is never needed.
"""

from typing import final

import torch
from torch import Tensor

from latentarm.core.types import FloatArray
from latentarm.models.tool_contexts import TWIST, ToolContexts
from latentarm.robots.kinematics.torch_chain import TorchChain


@final
class TorchToolContexts:
    """The map from contexts to observations ``[c, x, J_w, G^-1 J_w^T]``, as `ToolContexts` computes it."""

    def __init__(self, contexts: ToolContexts, dtype: torch.dtype) -> None:
        def tensor(values: FloatArray) -> Tensor:
            return torch.as_tensor(values, dtype=dtype)

        self._joints = contexts.sizes.joints
        self._context = tensor(contexts.contexts.centre), tensor(contexts.contexts.scale)
        self._place = tensor(contexts.places.centre), tensor(contexts.places.scale)
        self._weight = tensor(contexts.twist_weight)[:, None]
        self._damping = contexts.damping * torch.eye(self._joints, dtype=dtype)
        self._tools = [TorchChain(contexts.chain, tool).to(dtype) for tool in range(contexts.sizes.tools)]

    def __call__(self, context: Tensor) -> Tensor:
        """Observe contexts (..., c): (..., c + 9 k + 12 k n), laid out as in `ToolSizes`."""
        state = context[..., : self._joints]
        places: list[Tensor] = []
        jacobians: list[Tensor] = []
        for tool in self._tools:
            position, rotation = tool(state)
            places += [position, rotation[..., :2].reshape(*state.shape[:-1], TWIST)]
            jacobians.append(tool.jacobian(state))
        jacobian = torch.cat(jacobians, dim=-2) * self._weight
        lift = torch.linalg.solve(jacobian.mT @ jacobian + self._damping, jacobian.mT)
        (centre, scale), (place_centre, place_scale) = self._context, self._place
        place = (torch.cat(places, dim=-1) - place_centre) / place_scale
        return torch.cat([(context - centre) / scale, place, jacobian.flatten(-2), lift.flatten(-2)], dim=-1)


def inner(first: Tensor, first_twist: Tensor, second: Tensor, second_twist: Tensor, damping: float) -> Tensor:
    """``a^T G b`` of joint velocities (..., m) with weighted twists (..., 6 k): (..., 1)."""
    joints = damping * (first * second).sum(-1, keepdim=True)
    return (first_twist * second_twist).sum(-1, keepdim=True) + joints


def applied(matrix: Tensor, vector: Tensor) -> Tensor:
    """``A v`` of (..., k, d) and (..., d): (..., k). Element by element, since they are small and many."""
    return (matrix * vector[..., None, :]).sum(-1)
