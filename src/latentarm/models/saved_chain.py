"""An arm's kinematics among the tensors of a saved model."""

from collections.abc import Mapping

import numpy as np

from latentarm.core.types import FloatArray
from latentarm.robots.kinematics.chain import Chain, Coupling, Frame


def chain_shapes(joints: int, tools: int, coupled: int) -> dict[str, tuple[int, ...]]:
    """Shapes of the arrays of an arm of n joints and k tools, by name.

    ``coupled`` is its number of links if some of them follow a joint, else 0.
    """
    links = coupled or joints
    coupling = {"chain.ratio": (links, joints), "chain.link_slide": (links,)} if coupled else {}
    return {
        **coupling,
        "chain.parent": (links,),
        "chain.offset": (links, 4, 4),
        "chain.axis": (links, 3),
        "chain.anchor": (links, 3),
        "chain.slide": (joints,),
        "chain.tool_link": (tools,),
        "chain.tool": (tools, 4, 4),
    }


def chain_tensors(chain: Chain) -> dict[str, FloatArray]:
    """Everything that an arm's kinematics consist of, as float64 arrays by name."""
    coupling: dict[str, FloatArray] = {}
    if chain.coupling is not None:
        coupling["chain.ratio"] = chain.coupling.ratio.copy()
        coupling["chain.link_slide"] = chain.coupling.slide.astype(np.float64)
    return {
        **coupling,
        "chain.parent": chain.parent.astype(np.float64),
        "chain.offset": chain.offset.copy(),
        "chain.axis": chain.axis.copy(),
        "chain.anchor": chain.anchor.copy(),
        "chain.slide": chain.slide.astype(np.float64),
        "chain.tool_link": np.array([float(tool.link) for tool in chain.tools]),
        "chain.tool": np.stack([tool.transform for tool in chain.tools]),
    }


def chain_of_tensors(tensors: Mapping[str, FloatArray]) -> Chain:
    """The arm that `chain_tensors` gave; its joints and tools are numbered, since names are not kept."""
    coupling = None
    if (ratio := tensors.get("chain.ratio")) is not None:
        coupling = Coupling(ratio, tensors["chain.link_slide"] > 0.5)
    tools = zip(tensors["chain.tool_link"], tensors["chain.tool"], strict=True)
    return Chain(
        joint_names=tuple(f"joint{joint + 1}" for joint in range(len(tensors["chain.slide"]))),
        parent=tensors["chain.parent"].astype(np.int64),
        offset=tensors["chain.offset"],
        axis=tensors["chain.axis"],
        anchor=tensors["chain.anchor"],
        slide=tensors["chain.slide"] > 0.5,
        tools=tuple(Frame(f"tool{tool + 1}", int(link), at) for tool, (link, at) in enumerate(tools)),
        coupling=coupling,
    )
