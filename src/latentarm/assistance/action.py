"""The robot's own action (equation 3)."""

from latentarm.types import FloatArray


def assistive_action(
    state: FloatArray, belief: FloatArray, goals: FloatArray, gain_per_s: float = 1.0
) -> FloatArray:
    """``a_r = k Σ_g b(g) (g - s)`` (equation 3): towards the goals, each by how likely it is.

    The paper's ``g - s`` is a displacement; the gain k makes it a velocity.

    Args:
        state: (..., n), rad.
        belief: (..., G), probabilities.
        goals: (G, n), configurations, rad.
        gain_per_s: k, 1/s.

    Returns:
        (..., n), rad/s.
    """
    return gain_per_s * (belief @ goals - state * belief.sum(axis=-1, keepdims=True))
