"""One decoder per model as a figure shows it, and motions while z is held."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from typing import Final

import numpy as np

from latentarm.core.figure_style import Look
from latentarm.core.types import FloatArray
from latentarm.evaluation.contract import DecodesActions, next_context
from latentarm.evaluation.looks import look_of
from latentarm_research.studies.properties.figures import OURS
from latentarm_research.tasks.planar.motion import PlanarMotion
from latentarm_research.tasks.planar.paths import STEP_S

CONTRASTED: Final = ("vae", "cvae", OURS)
"""The models whose motions are shown side by side; the paper contrasts the first two."""

EPISODES: Final = 60
STREAM: Final = 81  # separates the drawn states from those of the study: no model was trained on them
Decoders = Mapping[str, DecodesActions]  # one decoder per model, of the first seed


@dataclass(frozen=True)
class DrawnModel:
    """One model as it is drawn on one task."""

    model: str  # its name
    decoder: DecodesActions  # of one seed
    # 1 or -1, what z is multiplied by before it is decoded. The sign of a latent axis is chance: without
    # this, two models that do the same would look opposed
    sign: float

    @property
    def look(self) -> Look:
        """Its colour, marker and dash."""
        return look_of(self.model)

    def hold(self, start: FloatArray, z: FloatArray, duration_s: float) -> FloatArray:
        """States (L, N, T + 1, n), rad, while each of L latent actions is held from each of N starts."""
        latent = np.broadcast_to(self.sign * z[:, None], (len(z), len(start), z.shape[-1]))
        passed = [np.broadcast_to(start, (len(z), *start.shape))]
        for _ in range(round(duration_s / STEP_S)):
            passed.append(next_context(passed[-1], self.decoder.decode(latent, passed[-1]), STEP_S))
        return np.stack(passed, axis=2)


def turned(
    decoders: Decoders,
    states: FloatArray,  # (N, n), where to look, rad
    rising: Callable[[FloatArray], FloatArray],  # from states (..., n) to the quantity (...)
) -> list[DrawnModel]:
    """Those of `CONTRASTED` that there are, their 1-D z so that +z, on the whole, raises a quantity."""
    ends = np.array([[-1.0], [1.0]])
    shown: list[DrawnModel] = []
    for model in CONTRASTED:
        if model in decoders:
            plain = DrawnModel(model, decoders[model], 1.0)
            backward, forward = rising(plain.hold(states, ends, STEP_S)[:, :, -1])
            shown.append(plain if np.sum(forward - backward) >= 0 else replace(plain, sign=-1.0))
    return shown


def passed_states(motion: PlanarMotion) -> FloatArray:
    """States (K, n) of demonstrations that no model has seen, rad; always the same."""
    demonstrations = motion.demonstrate(EPISODES, np.random.default_rng(STREAM))
    return np.concatenate([episode.state for episode in demonstrations.episodes])


def spread_states(
    states: FloatArray,  # (K, n)
    quantity: FloatArray,  # (K,), of each of them
    count: int,
) -> FloatArray:
    """States (count, n), the lowest first, at which a quantity is spread evenly over its middle range."""
    low, high = np.quantile(quantity, (0.03, 0.97))
    wanted = low + (np.arange(count) + 0.5) / count * (high - low)
    return states[np.argmin(np.abs(quantity - wanted[:, None]), axis=1)]
