"""PCA without its training. It decodes like an autoencoder without hidden layers."""

from typing import Final

from latentarm.models.autoencoders.runtime import NetworkDecoder
from latentarm.models.kind import Dimensions, ModelKind, Shape


def _sizes(dimensions: Dimensions) -> dict[str, Shape]:
    return {"decoder": (dimensions.latent, dimensions.action)}


PCA: Final = ModelKind(
    name="pca",
    label="PCA",
    estimator="latentarm.models.pca.training:PCA",
    runtime=NetworkDecoder,
    decoder=_sizes,
    encoder="projection",
    sees_context=False,
    advice="The pca moves the joints alike in every state; for motions that depend on the state try"
    " --model homogeneous, or the plainer --model scl.",
)
