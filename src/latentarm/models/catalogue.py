"""Every latent action model by name: ours, and those that other distributions add (`latentarm.models`)."""

from collections.abc import Iterator, Mapping
from pkgutil import resolve_name
from typing import TYPE_CHECKING, Final, final

from latentarm.core.plugins import Catalogue
from latentarm.models.kind import ModelKind

if TYPE_CHECKING:
    from latentarm.models.model import LatentActionModel


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
"""What each kind is, in the order in which tables and figures show them. Needs no torch."""

DEFAULT_MODEL: Final = "homogeneous"
"""What `train`, the demo and the page use unless another is named; docs/decisions/0031 has the rule."""


@final
class _Estimators(Mapping[str, "type[LatentActionModel]"]):
    """The class that trains each kind; looking one up imports torch."""

    def __getitem__(self, name: str) -> "type[LatentActionModel]":
        reference = KINDS[name].estimator
        return KINDS.running(name, lambda: resolve_name(reference))

    def __iter__(self) -> Iterator[str]:
        return iter(KINDS)

    def __len__(self) -> int:
        return len(KINDS)

    def __contains__(self, name: object) -> bool:
        return name in KINDS


MODELS: Final = _Estimators()
