"""A trained decoder in torch: frozen, and differentiable with respect to z and c."""

from collections.abc import Callable
from typing import final

import torch
from torch import Tensor

from latentarm.core.context import JOINTS, OBJECT, OBJECTS_IN_TOOL
from latentarm.core.types import FloatArray
from latentarm.models.kind import TrainedModel
from latentarm.models.networks import Networks, group_layers
from latentarm.models.tool_contexts import ToolContexts
from latentarm.models.tool_frame import ToolFrame
from latentarm.models.torch_tool_contexts import TorchToolContexts
from latentarm.models.way_back.torch_way_back import TorchWayBack
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


Action = Callable[[Networks, Tensor, Tensor], Tensor]
"""A model's phi: networks, latents (1, B, d) and observations (1, B, o) to normalised actions (1, B, m)."""


@final
class TorchDecoder:
    """``a_h = phi(u, c)`` of one seed in torch, like `Decoder`, as a base for further learning.

    It has two steps, for contexts that come back again and again: `observe` contexts, and decode in
    observations. ``contexts`` normalises contexts (..., c), the first part of an observation.
    """

    def __init__(self, trained: TrainedModel, action: Action, seed: int, dtype: torch.dtype) -> None:
        """Take one seed's decoder, by its index, out of a trained model; UserError without such a seed."""
        trained.check_seed_index(seed)

        def tensor(values: FloatArray) -> Tensor:
            return torch.as_tensor(values, dtype=dtype)

        self.layout = trained.layout
        self.latent_dim = trained.dimensions.latent
        self.context_dim = trained.dimensions.context
        self.action_dim = trained.dimensions.action
        self.dtype = dtype
        learned = trained.kind.weight_shapes(trained.dimensions)
        self._networks = group_layers(
            {name: tensor(trained.tensors[name][seed : seed + 1]) for name in learned}
        )
        self._action = action
        contexts, latents = trained.contexts, trained.latents
        self._tools = TorchToolContexts(contexts, dtype) if isinstance(contexts, ToolContexts) else None
        self.contexts = contexts.contexts if isinstance(contexts, ToolContexts) else contexts
        self._middle, self._span = tensor(self.contexts.centre), tensor(self.contexts.scale)
        self._frame = None if trained.frame is None else TorchToolFrame(trained.frame, dtype)
        self._way_back = TorchWayBack(trained, seed, dtype) if trained.dimensions.way_back else None
        self._centre, self._scale = tensor(latents.centre[seed, 0]), tensor(latents.scale[seed, 0])
        self._action_scale = tensor(trained.actions.scale)

    def observe(self, context: Tensor) -> Tensor:
        """Contexts (..., c) to inputs of the networks (..., o), whose first c are the normalised context."""
        framed = context if self._frame is None else self._frame(context)
        seen = (framed - self._middle) / self._span if self._tools is None else self._tools(framed)
        return seen if self._way_back is None else torch.cat([seen, self._way_back.observe(context)], dim=-1)

    def decode(self, z: Tensor, observed: Tensor) -> Tensor:
        """Joint velocities (..., m), rad/s, of z (..., d) in observations (..., o)."""
        lead, back = z.shape[:-1], observed[..., :0]
        if self._way_back is not None:
            observed, back = observed.split(
                [observed.shape[-1] - self._way_back.width, self._way_back.width], dim=-1
            )
        latent = (self._centre + self._scale * z).reshape(1, -1, self.latent_dim)
        action = self._action(self._networks, latent, observed.reshape(1, -1, observed.shape[-1]))
        action = (action * self._action_scale).reshape(*lead, self.action_dim)
        return action if self._way_back is None else self._way_back(action, z, back)
