"""How studies fit models: the last demonstrations say which epoch was best, and dead axes are no warning."""

import warnings
from collections.abc import Sequence
from dataclasses import fields, replace
from typing import Any, Final

from latentarm.core.types import Demonstrations
from latentarm.models.estimators import MODELS
from latentarm.models.model import LatentActionModel
from latentarm.models.neural import NeuralModel
from latentarm.models.scaling import CollapseWarning

VALIDATION_SHARE: Final = 0.2  # share of the training demonstrations that is for validation

STATE_NOISE_RAD: Final = 0.05
"""SD of the noise on training states, rad: a driven arm leaves the demonstrated states."""


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
    """A model of a kind, fitted; episodes of ``validation`` say which epoch was best."""
    with warnings.catch_warnings():
        # Studies show what models fail at: a dead axis shows in every figure.
        warnings.simplefilter("ignore", CollapseWarning)
        return _model(kind, kl_weight, parameters).fit(demonstrations, validation=validation, **(fit or {}))


def fit_each(
    kind: str,  # a name of `MODELS`
    demonstrations: Sequence[Demonstrations],
    *,
    validation: Sequence[int],  # episodes that say which epoch was best, the same for all
    seed: int,  # of the first; the others follow
    kl_weight: float | None = None,
    **parameters: Any,
) -> list[LatentActionModel]:
    """A model of one seed for each of some demonstrations; those trained by gradient in one training."""
    model = _model(kind, kl_weight, {**parameters, "seed": seed, "seeds": len(demonstrations)})
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", CollapseWarning)
        if isinstance(model, NeuralModel):
            return [*model.fit_each(demonstrations, validation=validation)]
        return [
            replace(model, seeds=1, seed=number).fit(shown, validation=validation)
            for number, shown in zip(model.seed_numbers, demonstrations, strict=True)
        ]


def _model(kind: str, kl_weight: float | None, parameters: dict[str, Any]) -> LatentActionModel:
    """A model of a kind, with a KL weight if it has one."""
    model_class = MODELS[kind]
    if kl_weight is not None and "kl_weight" in {entry.name for entry in fields(model_class)}:
        parameters = {**parameters, "kl_weight": kl_weight}
    return model_class(**parameters)
