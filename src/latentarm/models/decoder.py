"""A trained decoder as the control loop runs it."""

from typing import final

from latentarm.core.types import FloatArray
from latentarm.models.enclosure import Enclosure
from latentarm.models.kind import TrainedModel
from latentarm.models.way_back.runtime import WayBack


@final
class Decoder:
    """The decoder as the control loop runs it: one seed, NumPy alone, a few microseconds.

    ``a_h = phi(u, c)`` in rad/s, with u in [-1, 1] spanning what the demonstrations used.

    Nothing is checked in `decode`: the control loop has checked its input, and a wrong shape raises in NumPy.

    Attributes:
        kind: kind of model.
        layout: the features that its contexts consist of.
        latent_dim: d.
        context_dim: c.
        action_dim: m.
        way_back: what leads back to the demonstrations; None without it.
    """

    __slots__ = (
        "_frame",
        "_runtime",
        "action_dim",
        "context_dim",
        "kind",
        "latent_dim",
        "layout",
        "way_back",
    )

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
        self.layout = trained.layout
        self._frame = trained.frame
        self.latent_dim = trained.dimensions.latent
        self.context_dim = trained.dimensions.context
        self.action_dim = trained.dimensions.action
        self._runtime = trained.kind.runtime(trained, seed)
        self.way_back = WayBack(trained, seed) if trained.dimensions.way_back else None

    def decode(self, z: FloatArray, context: FloatArray) -> FloatArray:
        """Joint velocities of latent actions in contexts.

        Args:
            z: (..., d), in input units.
            context: (..., c); leading axes broadcast against those of ``z``.

        Returns:
            (..., m), rad/s.
        """
        action = self._runtime(z, context if self._frame is None else self._frame.apply(context))
        return action if self.way_back is None else self.way_back(action, z, context)

    def enclose(self, context: FloatArray, fineness: int = 1) -> Enclosure | None:
        """A proven enclosure of `decode` over all latent actions in [-1, 1]^d; None where none is known.

        Args:
            context: (..., c).
            fineness: 1 for a control loop; more is tighter and takes longer.
        """
        framed = context if self._frame is None else self._frame.apply(context)
        found = self._runtime.enclose(framed, fineness)
        if found is None or self.way_back is None:
            return found
        return self.way_back.enclosed(found, self.latent_dim, context)
