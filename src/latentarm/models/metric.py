"""The metric of the tools in torch: products of joint velocities that know which motion the tools show.

Joint velocities a come with their weighted twists J_w a, as `latentarm.models.tool_contexts` has them; then
``a^T G b = (J_w a)^T (J_w b) + damping a^T b``, and G itself is never needed.
"""

from torch import Tensor


def inner(first: Tensor, first_twist: Tensor, second: Tensor, second_twist: Tensor, damping: float) -> Tensor:
    """``a^T G b`` of joint velocities (..., m) with weighted twists (..., 6 k): (..., 1)."""
    joints = damping * (first * second).sum(-1, keepdim=True)
    return (first_twist * second_twist).sum(-1, keepdim=True) + joints


def applied(matrix: Tensor, vector: Tensor) -> Tensor:
    """``A v`` of (..., k, d) and (..., d): (..., k). Element by element, since they are small and many."""
    return (matrix * vector[..., None, :]).sum(-1)
