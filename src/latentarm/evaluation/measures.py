"""Every measure of a model in one table: unit, label, which direction is better, and its definition.

Other distributions may add theirs when they are imported.
"""

from dataclasses import dataclass
from typing import Final, Literal

Better = Literal["higher", "lower"]
ARROWS: Final[dict[Better | None, str]] = {"higher": "↑", "lower": "↓", None: ""}
"""How a table shows which way is better."""


@dataclass(frozen=True)
class Measure:
    """A measure's meaning."""

    unit: str  # "1" is a plain number or ratio
    label: str  # as tables call it, without the unit
    better: Better | None  # which way is better; None where neither is by itself
    definition: str  # one sentence, without a capital or a full stop
    group: str = ""  # heading that it stands under where measures are grouped, or ""


EXPRESSED: Final = "what the decoder can express"
ENCODED: Final = "through the encoder network"
PROPERTIES: Final = "the four properties"
AT_REST: Final = "rest and reversal"
MEASURES: Final[dict[str, Measure]] = {
    "search_error": Measure(
        "rad^2/s^2",
        "error, nearest input",
        "lower",
        "mean squared error of decoding the nearest input: of all z in [−1, 1] on each axis, the one whose"
        " action is nearest, found by the same search for every model; on held-out pairs, with noise on the"
        " states; actions are taken before the noise is added",
        EXPRESSED,
    ),
    "search_noise_free_error": Measure(
        "rad^2/s^2", "noise-free error, nearest input", "lower", "the same on clean states", EXPRESSED
    ),
    "search_error_percent_of_pca": Measure(
        "%",
        "error, nearest input, of PCA's",
        "lower",
        "mean squared error of decoding the nearest input: of all z in [−1, 1] on each axis, the one whose"
        " action is nearest, found by the same search for every model; in % of the error of PCA with as many"
        " components and any z, fitted to all other episodes' actions; actions are taken before noise is"
        " added to the states",
        EXPRESSED,
    ),
    "search_noise_free_error_percent_of_pca": Measure(
        "%", "noise-free error, nearest input, of PCA's", "lower", "the same on clean states", EXPRESSED
    ),
    "error": Measure(
        "rad^2/s^2",
        "error",
        "lower",
        "mean squared error of decoding what the encoder network makes of held-out pairs, with noise on the"
        " states; actions are taken before the noise is added; a dash for models without such a network",
        ENCODED,
    ),
    "noise_free_error": Measure(
        "rad^2/s^2", "noise-free error", "lower", "the same on clean states", ENCODED
    ),
    "error_percent_of_pca": Measure(
        "%",
        "error, of PCA's",
        "lower",
        "mean squared error of decoding what the encoder network makes of held-out pairs, in % of that of PCA"
        " with as many components, fitted to all other episodes' actions; actions are taken before noise is"
        " added to the states",
        ENCODED,
    ),
    "noise_free_error_percent_of_pca": Measure(
        "%", "noise-free error, of PCA's", "lower", "the same on clean states", ENCODED
    ),
    "median_error_percent_of_pca": Measure(
        "%",
        "median error, of PCA's",
        "lower",
        "median over held-out episodes of an episode's mean squared error of decoding what the encoder makes"
        " of its pairs, in % of the same median of PCA's",
        ENCODED,
    ),
    "controllability_m": Measure(
        "m",
        "reaches goals to",
        "lower",
        "a greedy solver with z in [−1, 1], looking one sample ahead, has 6 s to bring the tool where it"
        " was in the same held-out episode 3 s later; least distance",
        PROPERTIES,
    ),
    "controllability_percent_of_pca": Measure(
        "%",
        "reaches goals to, of PCA's",
        "lower",
        "the same in % of the distance that PCA leaves",
        PROPERTIES,
    ),
    "median_controllability_percent_of_pca": Measure(
        "%",
        "reaches goals to, median, of PCA's",
        "lower",
        "median distance over the pairs of start and goal, in % of the median distance that PCA leaves",
        PROPERTIES,
    ),
    "controllability_state_error": Measure(
        "rad", "joint error then", "lower", "‖s − s_goal‖ over all joints at that moment", PROPERTIES
    ),
    "start_distance_m": Measure(
        "m",
        "distance at the start",
        None,
        "distance of the tool from those goals before anything moves",
        PROPERTIES,
    ),
    "r2": Measure(
        "1",
        "R², mean of axes",
        "higher",
        "R² of one line, over 25 held-out states and 21 values in [−1, 1] of one axis, of the tool's signed"
        " way in a sample against z, with one forward for all states, as in the paper",
        PROPERTIES,
    ),
    "r2_local": Measure(
        "1",
        "local R², mean of axes",
        "higher",
        "the same where each state has its own forward, where its +z leads",
        PROPERTIES,
    ),
    "disentanglement_deg": Measure(
        "deg",
        "angle between axes",
        "higher",
        "angle between the lines along which the two axes move the tool, mean over states; 90° is best",
        PROPERTIES,
    ),
    "drift": Measure(
        "1",
        "drift, of motion",
        "lower",
        "how fast the arm moves with the stick at rest, ‖φ(0, s)‖, relative to how fast the"
        " person moved it, ‖φ(z, s)‖; both means over held-out pairs; here and below z is the nearest input",
        AT_REST,
    ),
    "reversal": Measure(
        "1",
        "left after z then -z",
        "lower",
        "z for one sample, then −z for one: what is left, ‖s₂ − s₀‖ over ‖s₁ − s₀‖; both means over"
        " held-out pairs; 0 is a motion undone, 1 leaves as much to go back as the motion was long",
        AT_REST,
    ),
    "reversal_0_5_s": Measure(
        "1",
        "left after 0.5 s of z, 0.5 s of -z",
        "lower",
        "the same with z held for half a second, then −z for as long",
        AT_REST,
    ),
    "reversal_2_s": Measure(
        "1",
        "left after 2 s of z, 2 s of -z",
        "lower",
        "the same with z held for two seconds, then −z for as long",
        AT_REST,
    ),
    "state_change": Measure(
        "1",
        "change of motion in 0.1 rad",
        "lower",
        "how much the same input means something else close by: ‖φ(z, s₂) − φ(z, s₁)‖ over ‖φ(z, s₁)‖ with s₂"
        " 0.1 rad from s₁ in any direction; both means over held-out pairs; the paper's consistency (equation"
        " 5) wants little of it",
        PROPERTIES,
    ),
    "motion_turn": Measure(
        "1",
        "joints' turn per stick's",
        "lower",
        "the stick, pushed all the way, is led around in 36 turns of 10°: by what angle the arm's joint"
        " velocity turns, relative to that of the stick; a linear isometry has 1",
        PROPERTIES,
    ),
    "motion_turn_p95": Measure(
        "1",
        "joints' turn per stick's, 95 %",
        "lower",
        "95th percentile over held-out states and turns: how jumpy the decoder is",
    ),
    "tool_turn": Measure("1", "tool's turn per stick's", "lower", "the same of the tool's velocity"),
    "tool_turn_p95": Measure("1", "tool's turn per stick's, 95 %", "lower", "95th percentile of these"),
    "findings": Measure("1", "findings", "lower", "how many thresholds of the verdict the model misses"),
    "relative_alignment_error": Measure(
        "1",
        "relative alignment error",
        "lower",
        "error of the poses that inputs lead to, relative to the length of the motions asked about",
    ),
}
"""Every measure by name; that of a single latent axis (``r2_axis_0``) is that of the measure."""

AXIS_LABELS: Final[dict[str, str]] = {"r2": "R²", "r2_local": "local R²"}


def measure_of(name: str) -> Measure | None:
    """A measure by name, also of a single latent axis; None for one that is not in the table."""
    return MEASURES.get(name.rpartition("_axis_")[0] or name)


def unit_of(name: str) -> str:
    """Unit of a measure, also of a single latent axis."""
    return MEASURES[name.rpartition("_axis_")[0] or name].unit


def label_of(name: str) -> str:
    """A measure's name in tables, without its unit; the name itself for one that is not in the table."""
    base, _, axis = name.rpartition("_axis_")
    if base in AXIS_LABELS and axis.isdigit():
        return f"{AXIS_LABELS[base]}, axis {int(axis) + 1}"
    return MEASURES[name].label if name in MEASURES else name
