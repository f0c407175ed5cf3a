"""Which tensors each kind of model consists of: the trainer, the files and the runtime all read it here."""

from dataclasses import dataclass
from itertools import pairwise
from typing import Final, Literal

DecoderForm = Literal["linear", "latent", "latent_context", "matrix", "isometry", "homogeneous"]
EncoderForm = Literal["projection", "nearest", "deterministic", "gaussian"]
Shape = tuple[int, ...]

TWIST: Final = 6
"""Entries of a tool's twist: 3 of velocity, 3 of angular velocity."""

ISOMETRIC_DAMPING_M2: Final = 1e-2
HOMOGENEOUS_DAMPING_M2: Final = 1e-3

ORDERS: Final = (3, 5, 7)
"""Odd degrees by which the homogeneous model bends."""

PLACE: Final = 9
"""Numbers that tell a network where a tool is: its position and the first two columns of its rotation."""


@dataclass(frozen=True)
class Layout:
    """The form of a model's two halves.

    Attributes:
        decoder: ``linear`` is phi(z) without hidden layers, ``latent`` is phi(z), ``latent_context`` is
            phi(z, c), ``matrix`` is M(c) z, ``isometry`` is g(‖z‖) R(c, ‖z‖) z / ‖z‖ and ``homogeneous``
            is ‖z‖ R(c, z / ‖z‖), both in the metric of the tools.
        encoder: ``projection`` onto the columns of the decoder or the ``nearest`` action that it can
            decode (neither has weights of its own), or a network of (c, a) whose output is z
            (``deterministic``) or (mu, log sigma^2) (``gaussian``).
        damping_m2: what a joint's motion by 1 rad counts beside the square of a tool's motion by 1 m, in the
            metric of the tools: enough to keep motions that no tool shows from being free. None where the
            model does not look at the tools.
    """

    decoder: DecoderForm
    encoder: EncoderForm
    damping_m2: float | None = None


LAYOUTS: Final[dict[str, Layout]] = {
    "pca": Layout("linear", "projection"),
    "ae": Layout("latent", "deterministic"),
    "vae": Layout("latent", "gaussian"),
    "cae": Layout("latent_context", "deterministic"),
    "cvae": Layout("latent_context", "gaussian"),
    "cae_zero": Layout("latent_context", "deterministic"),
    "scl": Layout("matrix", "projection"),
    "isometric": Layout("isometry", "nearest", ISOMETRIC_DAMPING_M2),
    "homogeneous": Layout("homogeneous", "nearest", HOMOGENEOUS_DAMPING_M2),
}
"""Every kind of model, by the name that it has on disk and on the command line."""


@dataclass(frozen=True)
class Dimensions:
    """The sizes that fix every tensor's shape.

    Attributes:
        seeds: S, models trained side by side.
        latent: d.
        context: c.
        action: m.
        hidden: units of each hidden layer, the same in encoder and decoder.
        tools: k, end-effectors of the arm; 0 where the model does not look at them.
    """

    seeds: int
    latent: int
    context: int
    action: int
    hidden: tuple[int, ...]
    tools: int = 0


def network_sizes(layout: Layout, dimensions: Dimensions) -> dict[str, Shape]:
    """Layer widths, input first, of each network that a model has."""
    d, c, m, hidden = dimensions.latent, dimensions.context, dimensions.action, dimensions.hidden
    seen = c + PLACE * dimensions.tools
    decoder: dict[DecoderForm, Shape] = {
        "linear": (d, m),
        "latent": (d, *hidden, m),
        "latent_context": (d + c, *hidden, m),
        "matrix": (c, *hidden, d * m),
        "isometry": (seen, *hidden, 2 * d * TWIST * dimensions.tools),
        "homogeneous": (c, *hidden, (1 + len(ORDERS)) * d * m),
    }
    beside: dict[str, Shape] = (
        {"posture": (seen, *hidden, 2 * d * m), "gain": (1, 1)} if layout.decoder == "isometry" else {}
    )
    encoder: dict[EncoderForm, dict[str, Shape]] = {
        "projection": {},
        "nearest": {},
        "deterministic": {"encoder": (c + m, *hidden, d)},
        "gaussian": {"encoder": (c + m, *hidden, 2 * d)},
    }
    return {"decoder": decoder[layout.decoder], **beside, **encoder[layout.encoder]}


def weight_shapes(layout: Layout, dimensions: Dimensions) -> dict[str, Shape]:
    """Shape, with the leading seed axis, of every learned tensor by name (``decoder.0.weight``, ...)."""
    shapes: dict[str, Shape] = {}
    for network, sizes in network_sizes(layout, dimensions).items():
        for layer, (inputs, outputs) in enumerate(pairwise(sizes)):
            shapes[f"{network}.{layer}.weight"] = (dimensions.seeds, inputs, outputs)
            shapes[f"{network}.{layer}.bias"] = (dimensions.seeds, 1, outputs)
    return shapes


def tensor_shapes(layout: Layout, dimensions: Dimensions) -> dict[str, Shape]:
    """Shape of every tensor of a saved model: the learned ones, the normalisers and the latent scale."""
    return {
        **weight_shapes(layout, dimensions),
        **({} if layout.damping_m2 is None else _tool_shapes(dimensions)),
        "context.centre": (dimensions.context,),
        "context.scale": (dimensions.context,),
        "action.scale": (1,),
        "latent.centre": (dimensions.seeds, dimensions.latent),
        "latent.scale": (dimensions.seeds, dimensions.latent),
    }


def _tool_shapes(dimensions: Dimensions) -> dict[str, Shape]:
    """Shapes of what a decoder keeps of the arm that it was trained for (see `ToolContexts`)."""
    n, k = dimensions.action, dimensions.tools
    return {
        "place.centre": (PLACE * k,),
        "place.scale": (PLACE * k,),
        "metric.scale": (2,),
        "chain.parent": (n,),
        "chain.offset": (n, 4, 4),
        "chain.axis": (n, 3),
        "chain.anchor": (n, 3),
        "chain.slide": (n,),
        "chain.tool_link": (k,),
        "chain.tool": (k, 4, 4),
    }
