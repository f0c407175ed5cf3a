"""Several ways to steer in one controller, so that a person can switch between them while they drive."""

from collections.abc import Sequence
from typing import final

import numpy as np

from latentarm.assistance.controllers.contract import Controller
from latentarm.core.errors import UserError
from latentarm.core.types import Context, FloatArray


@final
class JoinedController(Controller):
    """The modes of several controllers, one after the other.

    A controller with fewer axes than the others leaves the last ones unused: its latent actions are zero
    there.

    Raises:
        UserError: no controllers were given, or two of them use different objects.
    """

    def __init__(self, controllers: Sequence[Controller]) -> None:
        if not controllers:
            raise UserError("Joining controllers needs at least one.")
        looked_at = {one.objects for one in controllers if one.objects}
        if len(looked_at) > 1:
            raise UserError("Controllers that look at different things cannot be joined.")
        self._objects = next(iter(looked_at), ())
        self._parts = tuple((one, mode) for one in controllers for mode in range(len(one.modes)))
        self._modes = tuple(name for one in controllers for name in one.modes)
        self._input_dim = max(one.input_dim for one in controllers)

    @property
    def modes(self) -> tuple[str, ...]:
        return self._modes

    @property
    def input_dim(self) -> int:
        """As many axes as the controller with the most."""
        return self._input_dim

    @property
    def objects(self) -> tuple[str, ...]:
        return self._objects

    def latent(self, u: FloatArray, context: Context, mode: int) -> FloatArray:
        """The latent action of the mode's own controller; zero on axes that it lacks."""
        controller, own = self._parts[mode]
        axes = controller.input_dim
        if axes == self._input_dim:
            return controller.latent(u, context, own)
        z = np.zeros(u.shape)
        z[..., :axes] = controller.latent(u[..., :axes], context, own)
        return z

    def action(self, z: FloatArray, context: Context, mode: int) -> FloatArray:
        controller, own = self._parts[mode]
        return controller.action(z[..., : controller.input_dim], context, own)

    def speed_bound(self, context: Context, mode: int) -> float | None:
        controller, own = self._parts[mode]
        return controller.speed_bound(context, own)
