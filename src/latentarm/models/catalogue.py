"""Every latent action model by name, and reading a saved one back."""

from dataclasses import fields
from pathlib import Path
from typing import Any, Final, cast

from latentarm.errors import UserError
from latentarm.models.autoencoders import AE, CAE, CVAE, VAE
from latentarm.models.homogeneous import Homogeneous
from latentarm.models.isometric import Isometric
from latentarm.models.linear import SCL
from latentarm.models.model import LatentActionModel
from latentarm.models.parameters import check_parameters
from latentarm.models.pca import PCA
from latentarm.models.saving import read_model
from latentarm.models.zero_penalty import CAEZero
from latentarm.types import StrPath

MODELS: Final[dict[str, type[LatentActionModel]]] = {
    "pca": PCA,
    "ae": AE,
    "vae": VAE,
    "cae": CAE,
    "cvae": CVAE,
    "cae_zero": CAEZero,
    "scl": SCL,
    "isometric": Isometric,
    "homogeneous": Homogeneous,
}


def load_model(folder: StrPath) -> LatentActionModel:
    """Read a model that was saved to a folder.

    Raises:
        UserError: a file is missing, broken, foreign, of another version, or does not agree with the
            other.
    """
    folder = Path(folder)
    trained = read_model(folder)
    model_class = MODELS[trained.kind]
    parameters = cast(dict[str, Any], dict(trained.parameters))
    if isinstance(parameters.get("hidden"), list):
        parameters["hidden"] = tuple(parameters["hidden"])
    known = {entry.name for entry in fields(model_class) if entry.init}
    for name in sorted(known ^ set(parameters)):
        state = "lacks the" if name in known else "holds an unknown"
        raise UserError(f"{folder / 'config.json'} {state} parameter '{name}' of the {trained.kind} model.")
    check_parameters(parameters)
    model = model_class(**parameters)
    if (model.latent_dim, model.seeds) != (trained.dimensions.latent, trained.dimensions.seeds):
        raise UserError(f"{folder / 'config.json'} contradicts itself: parameters and dimensions differ.")
    model.trained_ = trained
    return model
