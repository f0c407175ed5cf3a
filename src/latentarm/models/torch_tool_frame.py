"""`ToolFrame` in torch, differentiable with respect to the state."""

from typing import final

import torch
from torch import Tensor

from latentarm.core.context import JOINTS, OBJECT, OBJECTS_IN_TOOL
from latentarm.models.tool_frame import ToolFrame
from latentarm.robots.kinematics.torch_chain import TorchChain


@final
class TorchToolFrame:
    """Contexts with the poses of one feature in the tool's frame, as `ToolFrame` computes it."""

    def __init__(self, frame: ToolFrame, dtype: torch.dtype) -> None:
        self._tool = TorchChain(frame.chain).to(dtype)
        self._joints = frame.layout.columns(JOINTS)
        self._columns = frame.layout.columns(OBJECTS_IN_TOOL)

    def __call__(self, context: Tensor) -> Tensor:
        """Contexts (..., c) to contexts (..., c)."""
        position, rotation = self._tool(context[..., self._joints])
        poses = context[..., self._columns].unflatten(-1, (-1, OBJECT))
        to_tool = rotation.mT[..., None, :, :]
        away = (to_tool @ (poses[..., :3] - position[..., None, :])[..., None])[..., 0]
        axes = (to_tool @ poses[..., 3:].unflatten(-1, (3, 2))).flatten(-2)
        seen = torch.cat([away, axes], dim=-1).flatten(-2)
        start, stop = self._columns.start, self._columns.stop
        return torch.cat([context[..., :start], seen, context[..., stop:]], dim=-1)
