"""What turns a person's inputs into commanded actions."""

from abc import ABC, abstractmethod

from latentarm.types import Context, FloatArray


class Controller(ABC):
    """Maps inputs ``u`` to latent actions ``z`` and those to actions ``a_h``; keeps no state.

    ``u`` and ``z`` may carry leading batch axes; the context is one for all of them, so that many
    candidate inputs can be asked about in one call.
    """

    @property
    @abstractmethod
    def modes(self) -> tuple[str, ...]:
        """Names of the modes that the person can switch between, in order; at least one."""

    @property
    @abstractmethod
    def input_dim(self) -> int:
        """Number of input axes d."""

    @abstractmethod
    def latent(self, u: FloatArray, context: Context, mode: int) -> FloatArray:
        """The alignment ``z = f(u, c)`` (equation 4).

        Args:
            u: (..., d), each entry in [-1, 1].
            context: state and belief.
            mode: index into `modes`.

        Returns:
            (..., d).
        """

    @abstractmethod
    def action(self, z: FloatArray, context: Context, mode: int) -> FloatArray:
        """The commanded action ``a_h = phi(z, c)`` (equation 1).

        Args:
            z: (..., d).
            context: state and belief.
            mode: index into `modes`.

        Returns:
            (..., n), rad/s.
        """
