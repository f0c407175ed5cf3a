"""The decoder as the control loop runs it: one seed, NumPy alone, a few microseconds."""

from pathlib import Path
from typing import cast, final

from latentarm.models.kind import TrainedModel
from latentarm.models.saving import read_model
from latentarm.types import FloatArray, StrPath


@final
class Decoder:
    """``a_h = phi(u, c)`` in rad/s, with u in [-1, 1] spanning what the demonstrations used.

    Nothing is checked in `decode`: the control loop has checked its input, and a wrong shape raises in NumPy.

    Attributes:
        kind: kind of model.
        context: kind of context, ``state`` or ``state_belief``.
        latent_dim: d.
        context_dim: c.
        action_dim: m.
    """

    __slots__ = ("_runtime", "action_dim", "context", "context_dim", "kind", "latent_dim")

    def __init__(self, trained: TrainedModel, seed: int = 0) -> None:
        """Take one seed's decoder out of a trained model.

        Args:
            trained: the model.
            seed: index of the seed, 0..S-1.

        Raises:
            UserError: there is no such seed.
        """
        trained.check_seed_index(seed)
        self.kind = trained.kind.name
        self.context = cast(str, trained.parameters["context"])
        self.latent_dim = trained.dimensions.latent
        self.context_dim = trained.dimensions.context
        self.action_dim = trained.dimensions.action
        self._runtime = trained.kind.runtime(trained, seed)

    def decode(self, z: FloatArray, context: FloatArray) -> FloatArray:
        """Joint velocities of latent actions in contexts.

        Args:
            z: (..., d), in input units.
            context: (..., c); leading axes broadcast against those of ``z``.

        Returns:
            (..., m), rad/s.
        """
        return self._runtime(z, context)


def load_decoder(folder: StrPath, seed: int = 0) -> Decoder:
    """Read one seed's decoder from a folder that a model was saved to. Loads no torch.

    Args:
        folder: holds ``config.json`` and ``model.safetensors``.
        seed: index of the seed, 0..S-1.

    Raises:
        UserError: the files are missing, broken or foreign, or there is no such seed.
    """
    return Decoder(read_model(Path(folder)), seed)
