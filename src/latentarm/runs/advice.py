"""Advice on the next model to try; docs/models.md has the measurements behind it."""

from typing import Final

from latentarm.models.catalogue import DEFAULT_MODEL, KINDS

FEW_EPISODES: Final = 20
"""With this many episodes or fewer, the choice of held-out episodes matters more than the seed."""


def model_advice(model: str, episodes: int) -> str:
    """Advice on models besides the trained one; "" where there is none."""
    said = [KINDS[model].advice] if KINDS[model].advice else []
    if episodes <= FEW_EPISODES:
        said.append(f"{episodes} episodes are few: `latentarm evaluate` holds each of them out in turn.")
    return " ".join(said)


def next_step(model: str, way_back: bool, run: str, dataset: str, missed: frozenset[str]) -> str:
    """One sentence on what to do after evaluating."""
    reverses = KINDS[model].reverses
    moves_on = missed & {"drift", "reversal", "reversal_2_s"}
    if way_back and reverses and moves_on:  # by its way back alone, which is there to do this
        missed -= moves_on
        if not missed:
            return (
                f"Next: latentarm teleop {run} (beside the demonstrated motions its way back leads to them,"
                " whichever way is pushed; for pushes that undo each other, train with --way-back-m 0)"
            )
    if not missed:
        return f"Next: latentarm teleop {run}"
    if missed & moves_on and not reverses:
        return (
            f"Next: latentarm train --demonstrations {dataset} --model {DEFAULT_MODEL} --way-back-m 0 (rests"
            " and goes back)"
        )
    if "motion_turn" in missed and model != "low_turning":
        return (
            f"Next: latentarm train --demonstrations {dataset} --model low_turning, for a driver who is still"
            " learning what each push does (its directions turn with the stick)"
        )
    if "search_error_percent_of_pca" in missed:
        return (
            "Next: record more demonstrations of the same motions, or compare all models:"
            f" latentarm compare --demonstrations {dataset}"
        )
    return f"Next: compare all models: latentarm compare --demonstrations {dataset}"
