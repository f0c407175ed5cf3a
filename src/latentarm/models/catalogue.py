"""Every latent action model by name: ours, and those that other distributions add (`latentarm.models`)."""

from typing import Final

from latentarm.core.plugins import Catalogue
from latentarm.models.kind import ModelKind


def _as_kind(name: str, thing: object) -> ModelKind:
    if not isinstance(thing, ModelKind):
        raise TypeError(f"it registers a {type(thing).__name__}, not a ModelKind")
    if thing.name != name:
        raise ValueError(f"its ModelKind calls itself '{thing.name}'")
    return thing


KINDS: Final = Catalogue(
    "latentarm.models",
    "model",
    {
        "pca": "latentarm.models.pca.runtime:PCA",
        "ae": "latentarm.models.autoencoders.runtime:AE",
        "vae": "latentarm.models.autoencoders.runtime:VAE",
        "cae": "latentarm.models.autoencoders.runtime:CAE",
        "cvae": "latentarm.models.autoencoders.runtime:CVAE",
        "cae_zero": "latentarm.models.autoencoders.runtime:CAE_ZERO",
        "cae_reversal": "latentarm.models.autoencoders.runtime:CAE_REVERSAL",
        "cae_jacobian": "latentarm.models.autoencoders.runtime:CAE_JACOBIAN",
        "cvae_jacobian": "latentarm.models.autoencoders.runtime:CVAE_JACOBIAN",
        "odd_cae": "latentarm.models.odd_cae.runtime:ODD_CAE",
        "scl": "latentarm.models.scl.runtime:SCL",
        "isometric": "latentarm.models.isometric.runtime:ISOMETRIC",
        "homogeneous": "latentarm.models.homogeneous.runtime:HOMOGENEOUS",
        "low_turning": "latentarm.models.low_turning.runtime:LOW_TURNING",
    },
    _as_kind,
)
"""Every `ModelKind`, in the order of tables and figures. Needs no torch."""

DEFAULT_MODEL: Final = "low_turning"
"""The model of `train`, the demo and the page unless another is named; see docs/decisions/0041."""
