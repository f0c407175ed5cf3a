"""A trained decoder in torch: frozen, and differentiable with respect to z and c."""

from collections.abc import Callable
from typing import final

import torch
from torch import Tensor

from latentarm.core.errors import UserError
from latentarm.core.types import FloatArray
from latentarm.models.kind import TrainedModel
from latentarm.models.networks import Networks, group_layers
from latentarm.models.tool_contexts import ToolContexts
from latentarm.models.torch_tool_contexts import TorchToolContexts

Action = Callable[[Networks, Tensor, Tensor], Tensor]
"""A model's phi: networks, latents (1, B, d) and observations (1, B, o) to normalised actions (1, B, m)."""


@final
class TorchDecoder:
    """``a_h = phi(u, c)`` of one seed in torch, like `Decoder`, as a base for further learning.

    It has two steps, for contexts that come back again and again: `observe` contexts, and decode in
    observations. ``contexts`` normalises contexts (..., c), the first part of an observation.
    """

    def __init__(self, trained: TrainedModel, action: Action, seed: int, dtype: torch.dtype) -> None:
        """Take one seed's decoder, by its index, out of a trained model.

        Raises UserError where there is no such seed, or the model has what is only computed in NumPy.
        """
        trained.check_seed_index(seed)
        if trained.layout.sees_tool_frame or trained.dimensions.way_back:
            raise UserError(
                "The decoder in torch takes no poses in the tool's frame and has no way back: train a model"
                " without them, or align in the space of the tool, as `latentarm align` does."
            )

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
        self._centre, self._scale = tensor(latents.centre[seed, 0]), tensor(latents.scale[seed, 0])
        self._action_scale = tensor(trained.actions.scale)

    def observe(self, context: Tensor) -> Tensor:
        """Contexts (..., c) to inputs of the networks (..., o), whose first c are the normalised context."""
        return (context - self._middle) / self._span if self._tools is None else self._tools(context)

    def decode(self, z: Tensor, observed: Tensor) -> Tensor:
        """Joint velocities (..., m), rad/s, of z (..., d) in observations (..., o)."""
        latent = (self._centre + self._scale * z).reshape(1, -1, self.latent_dim)
        action = self._action(self._networks, latent, observed.reshape(1, -1, observed.shape[-1]))
        return (action * self._action_scale).reshape(*z.shape[:-1], self.action_dim)
