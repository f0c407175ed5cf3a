"""Differentiable forward kinematics in torch, for losses on poses."""

from typing import final

import torch
from torch import Tensor

from latentarm.robots.kinematics.chain import Chain


@final
class TorchChain(torch.nn.Module):
    """Forward kinematics of one tool that rides on a moving link, in double precision like `Chain`."""

    constants: Tensor
    tool: Tensor
    axis_and_anchor: Tensor
    slide: Tensor
    ratio: Tensor

    def __init__(self, chain: Chain, tool: int = 0) -> None:
        super().__init__()
        frame = chain.tools[tool]
        # Only the links between the base and the tool matter, the base's child first.
        path: list[int] = []
        link = frame.link
        while link >= 0:
            path.insert(0, link)
            link = int(chain.parent[link])
        self.register_buffer("constants", torch.from_numpy(chain.motion_constants[path]))
        self.register_buffer("tool", torch.from_numpy(frame.transform.copy()))
        self.register_buffer("axis_and_anchor", torch.from_numpy(chain.axis_and_anchor[path]))
        self.register_buffer("slide", torch.from_numpy(chain.link_slide[path].copy()))
        self.register_buffer("ratio", torch.from_numpy(chain.ratio[path]))

    def forward(self, q: Tensor) -> tuple[Tensor, Tensor]:
        """The tool's position (..., 3), m, and rotation (..., 3, 3), in the base frame."""
        pose = self._links(q)[-1] @ self.tool
        return pose[..., :3, 3], pose[..., :3, :3]

    def jacobian(self, q: Tensor) -> Tensor:
        """Geometric Jacobian (..., 6, n) in the base frame; rows as in `Chain.jacobian`."""
        links = torch.stack(self._links(q), dim=-3)
        position = (links[..., -1, :, :] @ self.tool)[..., :3, 3]
        both = (links @ self.axis_and_anchor)[..., :3, :]
        axes, origins = both[..., 0], both[..., 1]
        slide = self.slide[:, None]
        linear = torch.where(slide, axes, torch.linalg.cross(axes, position[..., None, :] - origins))
        return torch.cat([linear, axes * ~slide], dim=-1).mT @ self.ratio

    def _links(self, q: Tensor) -> list[Tensor]:
        """(..., 4, 4) of each link on the tool's path, in the base frame."""
        on_path = q @ self.ratio.mT
        features = torch.stack([torch.ones_like(on_path), on_path.sin(), on_path.cos(), on_path], dim=-1)
        features = features[..., None, : self.constants.shape[1]]
        local = (features @ self.constants).unflatten(-1, (4, 4)).squeeze(-3)
        links = [local[..., 0, :, :]]
        for i in range(1, len(self.ratio)):
            links.append(links[-1] @ local[..., i, :, :])
        return links
