"""The one function that latentarm calls: daqp has no types of its own."""

from typing import Any

from numpy.typing import NDArray

def solve(
    H: NDArray[Any],
    f: NDArray[Any],
    A: NDArray[Any],
    bupper: NDArray[Any],
    blower: NDArray[Any],
    sense: NDArray[Any],
    *,
    primal_tol: float,
    rho_soft: float,
) -> tuple[NDArray[Any], float, int, dict[str, Any]]: ...
