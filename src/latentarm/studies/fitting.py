"""How studies fit models: the last demonstrations say which epoch was best, and dead axes are no warning."""

import warnings
from collections.abc import Sequence
from dataclasses import fields
from typing import Any, Final

from latentarm.models.catalogue import MODELS
from latentarm.models.model import LatentActionModel
from latentarm.models.scaling import CollapseWarning
from latentarm.types import Demonstrations

VALIDATION_SHARE: Final = 0.2
"""Share of the training demonstrations that is for validation."""


def validation_episodes(demonstrations: Demonstrations) -> range:
    """The last episodes, for validation."""
    episodes = len(demonstrations.episodes)
    return range(episodes - max(1, round(VALIDATION_SHARE * episodes)), episodes)


def fit_model(
    kind: str,
    demonstrations: Demonstrations,
    *,
    validation: Sequence[int] | None = None,
    kl_weight: float | None = None,
    fit: dict[str, Any] | None = None,
    **parameters: Any,
) -> LatentActionModel:
    """A model of a kind, fitted.

    Args:
        kind: a name of `MODELS`.
        demonstrations: to learn from.
        validation: episodes that say which epoch was best, such as `validation_episodes`; the model draws its
            own where None.
        kl_weight: for models that have one.
        fit: further arguments of ``fit``, such as the chain.
        parameters: of the model.

    Raises:
        UserError: the parameters or the demonstrations make no sense to the model.
    """
    model_class = MODELS[kind]
    if kl_weight is not None and "kl_weight" in {entry.name for entry in fields(model_class)}:
        parameters["kl_weight"] = kl_weight
    with warnings.catch_warnings():
        # Studies show what models fail at: a dead axis shows in every figure.
        warnings.simplefilter("ignore", CollapseWarning)
        return model_class(**parameters).fit(demonstrations, validation=validation, **(fit or {}))
