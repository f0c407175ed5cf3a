"""How a simulated person gets faster and surer from trial to trial."""

from typing import Final

TRIAL_S: Final = 60.0
"""Practice of so long teaches as much as a trial, s. Chosen: about as long as the studies' trials last."""


def time_share(
    exponent: float,  # how fast they learn, 0 or more; at 0 they never do
    trial: int,  # number of trials before this one
    practice_s: float = 0.0,  # practised before the first trial, s
) -> float:
    """Effort in a trial, as a share of that in the first trial without practice.

    The power law of practice: times shrink as ``N^-exponent`` (Newell and Rosenbloom 1981). N counts this
    trial, those before it and what was practised before all of them. Practice of several minutes thus leaves
    little to learn in the trials. Averages over people follow this law; single people rather follow an
    exponential (Heathcote, Brown and Mewhort 2000), which is not modelled.
    """
    return (1.0 + trial + practice_s / TRIAL_S) ** -exponent
