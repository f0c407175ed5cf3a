"""The classes that train models, by name, and models loaded into them. Importing this needs no torch."""

from collections.abc import Iterator, Mapping
from dataclasses import fields
from pathlib import Path
from pkgutil import resolve_name
from typing import TYPE_CHECKING, Any, Final, cast, final

from latentarm.core.errors import UserError
from latentarm.core.types import StrPath
from latentarm.models.catalogue import KINDS
from latentarm.models.saving import CONFIG_NAME, read_model

if TYPE_CHECKING:
    from latentarm.models.model import LatentActionModel


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


def load_model(folder: StrPath) -> "LatentActionModel":
    """Read a model that was saved to a folder, to encode with or to fit anew. Imports torch.

    Raises UserError where a file is missing, broken, foreign, of another version, or does not agree with the
    other, or the distribution that the model came from is not installed.
    """
    # pydantic is slow to load, and a list of names does not need it.
    from latentarm.models.parameters import check_parameters

    folder = Path(folder)
    trained = read_model(folder)
    path, kind = folder / CONFIG_NAME, trained.kind.name
    model_class = MODELS[kind]
    parameters: dict[str, Any] = {
        name: tuple(cast(list[object], value)) if isinstance(value, list) else value
        for name, value in trained.parameters.items()
    }
    known = {entry.name for entry in fields(model_class) if entry.init}
    for name in sorted(known ^ set(parameters)):
        state = "lacks the" if name in known else "holds an unknown"
        raise UserError(f"{path} {state} parameter '{name}' of the {kind} model.")
    check_parameters(model_class, parameters)
    model = model_class(**parameters)
    if (model.latent_dim, model.seeds) != (trained.dimensions.latent, trained.dimensions.seeds):
        raise UserError(f"{path} contradicts itself: parameters and dimensions differ.")
    model.trained_ = trained
    return model
