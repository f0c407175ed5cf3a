"""A trained decoder of one seed for the control loop."""

from typing import final

from latentarm.core.types import FloatArray
from latentarm.models.enclosure import Enclosure
from latentarm.models.kind import TrainedModel
from latentarm.models.way_back.runtime import WayBack


@final
class Decoder:
    """One seed's decoder ``a_h = phi(u, c)``, rad/s: NumPy alone, a few microseconds.

    u in [-1, 1] spans the demonstrations. Nothing is checked in `decode`: the control loop has checked its
    input, and a wrong shape raises in NumPy.

    ``latent_dim``, ``context_dim`` and ``action_dim`` are d, c and m; ``layout`` lists the features of its
    contexts, and ``way_back`` is None in a model without one.
    """

    def __init__(self, trained: TrainedModel, seed: int = 0) -> None:
        """Take one seed's decoder, by its index, out of a trained model; UserError without such a seed."""
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
        """Joint velocities (..., m), rad/s, of z (..., d) in contexts (..., c), which broadcast."""
        action = self._runtime(z, context if self._frame is None else self._frame.apply(context))
        return action if self.way_back is None else self.way_back(action, z, context)

    def enclose(self, context: FloatArray, fineness: int = 1) -> Enclosure | None:
        """A proven enclosure of `decode` over all latent actions in [-1, 1]^d; None where none is known.

        ``fineness`` is 1 for a control loop; more is tighter and takes longer.
        """
        framed = context if self._frame is None else self._frame.apply(context)
        found = self._runtime.enclose(framed, fineness)
        if found is None or self.way_back is None:
            return found
        return self.way_back.enclosed(found, self.latent_dim, context)
