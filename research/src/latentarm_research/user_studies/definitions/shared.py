"""What several studies have in common."""

from typing import Final

from latentarm_research.user_studies.exclusion import Exclusion

NO_INPUT: Final = Exclusion("input_magnitude", "less", 0.05, "the stick was hardly touched")

AGAIN: Final = (
    "The paper does not say what happened after a failure, such as food that fell. Here everything is set up"
    " anew, and the person begins again until the trial's time is over; times, inputs, paths and goal errors"
    " are summed over the attempts."
)
"""A departure of the studies whose trials are more than one attempt."""
