"""`ToolContexts` in torch: what a decoder is shown of the arm, differentiable with respect to the state."""

from typing import final

import torch
from torch import Tensor

from latentarm.kinematics.torch_chain import TorchChain
from latentarm.models.layout import TWIST
from latentarm.models.tool_contexts import ToolContexts
from latentarm.types import FloatArray


@final
class TorchToolContexts:
    """The map from contexts to observations ``[c, x, J_w, G^-1 J_w^T]``, as `ToolContexts` computes it.

    Args:
        contexts: the map in NumPy.
        dtype: of all tensors.
    """

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
        """Observe contexts (..., c): (..., c + 9 k + 12 k n), laid out as `ToolSizes` has it."""
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
        return torch.cat(
            [
                (context - centre) / scale,
                (torch.cat(places, dim=-1) - place_centre) / place_scale,
                jacobian.flatten(-2),
                lift.flatten(-2),
            ],
            dim=-1,
        )
