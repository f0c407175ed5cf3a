"""Which model to try next, and why; docs/models.md has the measurements behind it."""

from typing import Final

FEW_EPISODES: Final = 20
"""With so many episodes or fewer, which of them are held out moves the figures more than the seed does."""

MOVING_AT_REST: Final = ("ae", "vae", "cae", "cvae")
"""Models that may move with the stick at rest, and do not go back when the stick is pressed back."""


def model_advice(model: str, episodes: int) -> str:
    """One sentence on which model to try besides the one that was trained.

    Args:
        model: its name.
        episodes: of the dataset.
    """
    few = (
        f" {episodes} episodes are few: `latentarm evaluate` holds each of them out in turn."
        if episodes <= FEW_EPISODES
        else ""
    )
    if model in MOVING_AT_REST:
        return (
            f"The {model} may move with the stick at rest and need not go back when it is pressed back; for"
            f" rest and reversal by construction try --model homogeneous, or the plainer --model scl.{few}"
        )
    if model == "pca":
        return (
            "The pca moves the joints alike in every state; for motions that depend on the state try"
            f" --model homogeneous, or the plainer --model scl.{few}"
        )
    if model == "cae_zero":
        return (
            "The cae_zero nearly rests but need not go back when the stick is pressed back; for both by"
            f" construction try --model homogeneous, or the plainer --model scl.{few}"
        )
    if model == "scl":
        return (
            "The scl rests and goes back; on recordings of real arms --model homogeneous had a lower error"
            f" and reached goals nearer, and takes longer to train.{few}"
        )
    return (
        f"The {model} rests and goes back; where its motions turn too fast for the stick, try the plainer"
        f" --model scl.{few}"
    )


def next_step(model: str, run: str, dataset: str, missed: frozenset[str]) -> str:
    """One sentence on what to do after evaluating.

    Args:
        model: name of the model that was measured.
        run: its folder.
        dataset: folder of its demonstrations.
        missed: measures of the thresholds that it misses.
    """
    if not missed:
        return f"Next: latentarm drive {run}"
    if missed & {"drift", "reversal"} and model not in ("homogeneous", "scl", "isometric"):
        return f"Next: latentarm train --demonstrations {dataset} --model homogeneous (rests and goes back)"
    if "error_percent_of_pca" in missed:
        return (
            "Next: record more demonstrations of the same motions, or compare all models:"
            f" latentarm compare --demonstrations {dataset}"
        )
    return f"Next: compare all models: latentarm compare --demonstrations {dataset}"
