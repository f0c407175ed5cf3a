"""Poses of things in the frame of the arm's tool, at any state that a decoder is asked about."""

from dataclasses import dataclass
from typing import final

import numpy as np

from latentarm.core.context import JOINTS, OBJECT, OBJECTS_IN_TOOL, ContextLayout
from latentarm.core.types import FloatArray
from latentarm.robots.kinematics.chain import Chain


@final
@dataclass(frozen=True, eq=False)
class ToolFrame:
    """Turns the poses of one feature of a context from the base frame into that of the arm's first tool.

    A context keeps these poses in the base frame, so that looking ahead changes nothing but the state. A
    network gets them through here.
    """

    chain: Chain
    layout: ContextLayout  # of the contexts, with the feature `OBJECTS_IN_TOOL`

    def apply(self, context: FloatArray) -> FloatArray:
        """Contexts (..., c) with the poses of the feature in the tool's frame, (..., c)."""
        columns = self.layout.columns(OBJECTS_IN_TOOL)
        tool = self.chain.forward(context[..., self.layout.columns(JOINTS)])
        poses = context[..., columns].reshape(*context.shape[:-1], -1, OBJECT)
        to_tool = tool.rotation.mT[..., None, :, :]
        position = poses[..., :3] - tool.position[..., None, :]
        axes = poses[..., 3:].reshape(*poses.shape[:-1], 3, 2)
        seen = np.concatenate(
            [(to_tool @ position[..., None])[..., 0], (to_tool @ axes).reshape(*axes.shape[:-2], 6)], -1
        )
        turned = context.copy()
        turned[..., columns] = seen.reshape(*context.shape[:-1], -1)
        return turned
