"""The interface of everything that turns a person's input into an action."""

from abc import ABC, abstractmethod

from latentarm.core.types import Context, FloatArray


class Controller(ABC):
    """Turns inputs into actions; stateless, and batched over the leading axes of its input.

    Batches matter: the belief asks what *other* inputs would have done, and a simulated operator
    asks the same of every mode. A planner asks about hypothetical states, so the context's state may have
    leading axes (..., n) too, which broadcast against those of the input.

    Methods take the context of one moment, and the mode as its index in `modes`.
    """

    @property
    @abstractmethod
    def modes(self) -> tuple[str, ...]:
        """Names of the modes that the person switches between; at least one."""

    @property
    @abstractmethod
    def input_dim(self) -> int:
        """Number of axes d of the person's input."""

    @property
    def objects(self) -> tuple[str, ...]:
        """Names of the things whose poses it looks at, in order; none, as here, for most."""
        return ()

    @abstractmethod
    def latent(self, u: FloatArray, context: Context, mode: int) -> FloatArray:
        """Alignment ``z = f(u, c)`` (Algorithm 1, line 6): u in [-1, 1], (..., d), to z (..., d)."""

    @abstractmethod
    def action(self, z: FloatArray, context: Context, mode: int) -> FloatArray:
        """Decoding ``a_h = phi(z, c)`` (Algorithm 1, line 7): z (..., d) to (..., n), rad/s."""

    def speed_bound(self, context: Context, mode: int) -> float | None:
        """sigma_h of equation 14, rad/s: a proven upper bound of ``‖a_h‖`` over all inputs in [-1, 1]^d.

        None where no bound is known, as here: then no bound on the help is recorded.
        """
        return None
