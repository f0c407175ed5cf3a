"""`WayBack` in torch, differentiable with respect to z and the state."""

from typing import TYPE_CHECKING, final

import torch
from torch import Tensor

from latentarm.core.context import OBJECT
from latentarm.core.types import FloatArray
from latentarm.models.networks import group_layers, mlp
from latentarm.models.numpy_networks import NORM_FLOOR
from latentarm.models.saved_chain import chain_of_tensors
from latentarm.models.tool_contexts import TWIST, twist_weight
from latentarm.models.way_back.runtime import DAMPING_M2, GATE_M, NETWORK, STRENGTH, pull_columns
from latentarm.robots.kinematics.torch_chain import TorchChain

if TYPE_CHECKING:
    from latentarm.models.kind import TrainedModel


@final
class TorchWayBack:
    """The way back of one seed, as `WayBack` computes it, in two steps like `TorchDecoder`."""

    def __init__(self, trained: "TrainedModel", seed: int, dtype: torch.dtype) -> None:
        def tensor(values: FloatArray) -> Tensor:
            return torch.as_tensor(values, dtype=dtype)

        tensors = trained.tensors
        own = {name: tensor(tensors[name][seed : seed + 1]) for name in tensors if name.startswith(NETWORK)}
        self._layers = group_layers({name: one for name, one in own.items() if one.ndim == 3})[NETWORK]
        self._speed, self._length = map(float, tensors[f"{NETWORK}.scale"])
        chain = chain_of_tensors(tensors)
        self._tools = [TorchChain(chain, tool).to(dtype) for tool in range(len(chain.tools))]
        self._weight = tensor(twist_weight(len(chain.tools)))[:, None]
        self._joints = trained.dimensions.action
        self._things, self._others = pull_columns(trained.layout)
        self.width = self._joints * (1 + TWIST * len(chain.tools))
        """Entries that `observe` gives."""

    def observe(self, context: Tensor) -> Tensor:
        """D and ``J_w`` in contexts (..., c) with all poses in the base frame: (..., width)."""
        state = context[..., : self._joints]
        poses = [tool(state) for tool in self._tools]
        parts = [state]
        for position, rotation in poses:
            parts += [position, rotation[..., :2].flatten(-2)]
        if self._things is not None:
            position, rotation = poses[0]
            rows = context[..., self._things].unflatten(-1, (-1, OBJECT))
            near = (rows[..., :3] - position[..., None, :]) @ rotation
            columns = rotation.mT[..., None, :, :] @ rows[..., 3:].unflatten(-1, (3, 2))
            parts += [rows.flatten(-2), near.flatten(-2), columns.flatten(-3)]
        parts += [context[..., columns] for columns in self._others]
        seen = torch.cat(parts, dim=-1)
        way = mlp(self._layers, seen.reshape(1, -1, seen.shape[-1])).reshape(*seen.shape[:-1], -1)
        jacobian = torch.cat([tool.jacobian(state) for tool in self._tools], dim=-2) * self._weight
        return torch.cat([way, jacobian.flatten(-2)], dim=-1)

    def __call__(self, action: Tensor, z: Tensor, observed: Tensor) -> Tensor:
        """The action (..., m), rad/s, from the decoder's own one, z (..., d) and an observation."""
        way, jacobian = observed[..., : self._joints], observed[..., self._joints :]
        jacobian = jacobian.unflatten(-1, (-1, self._joints))
        fastest = self._speed * torch.linalg.vector_norm(z, dim=-1, keepdim=True)
        length = _metric_length(jacobian, way)
        gain = (2.0 - length / GATE_M).clamp(0.0, 1.0) / self._length
        person = torch.minimum(fastest, _metric_length(jacobian, action))
        led = action + torch.minimum(fastest * gain, STRENGTH * person / length) * way
        return led * (fastest / _metric_length(jacobian, led)).clamp(max=1.0)


def _metric_length(jacobian: Tensor, vector: Tensor) -> Tensor:
    twist = (jacobian * vector[..., None, :]).sum(-1)
    size = twist.square().sum(-1, keepdim=True) + DAMPING_M2 * vector.square().sum(-1, keepdim=True)
    return (size + NORM_FLOOR).sqrt()
