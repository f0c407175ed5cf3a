"""Every measure in one table: unit, label, which direction is better, and its definition."""

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
    "planned_reach_m": Measure(
        "m",
        "reaches goals to, planning",
        "lower",
        "the same asked of a solver that plans all 6 s at once, in pieces of half a second, for some of the"
        " pairs and seeds; never worse than greedy on the same pairs",
        PROPERTIES,
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
    "nonlinearity": Measure(
        "1",
        "not linear in z",
        None,
        "share of the motion's variance, over 36 pushes of the stick, that is not linear in z; the motion at"
        " rest does not count",
    ),
    "findings": Measure("1", "findings", "lower", "how many thresholds of the verdict the model misses"),
    "success_rate": Measure("1", "success rate", "higher", "share of the drives that did the task"),
    "time_s": Measure("s", "time", "lower", "duration of a drive, failed ones included"),
    "idle_s": Measure("s", "time without input", "lower", "time of a drive in which the input is zero"),
    "turned_round": Measure(
        "1",
        "share of the time turned round",
        "lower",
        "share of the time in which the stick is more than 90° from where it was within the last 0.5 s",
    ),
    "steps_done": Measure("1", "steps done", "higher", "share of the steps of a task that were done"),
    "preference_alignment": Measure(
        "1",
        "preference alignment",
        "higher",
        "mean dot product of the direction in which the tool points and the one needed at that moment",
    ),
    "table_force_n": Measure(
        "N", "force on table", "lower", "largest force of the tool on the table or a dish in a drive"
    ),
    "food_force_n": Measure("N", "force on food", None, "largest force of the tool on food in a drive"),
    "spilled_share": Measure("1", "spilled", "lower", "share of the grains that were spilled"),
    "goal_error_m_s": Measure(
        "m s", "goal error, total", "lower", "integral over time of the tool's distance to the closest goal"
    ),
    "goal_error_m": Measure(
        "m", "goal error, mean", "lower", "mean over time of the tool's distance to the closest goal"
    ),
    "input_magnitude": Measure(
        "s", "input magnitude", "lower", "integral of ‖u‖ over time, seconds of full deflection of one axis"
    ),
    "attempts": Measure("1", "attempts", "lower", "how often a task was begun in a trial"),
    "mode_switches": Measure("1", "mode switches", "lower", "how often the controller's mode changed"),
    "stops": Measure("1", "stops", "lower", "how often the arm was stopped and had to be enabled again"),
    "path_length": Measure("m", "path length", "lower", "length of the tool's path"),
    "path_length_percent_of_vae": Measure(
        "%", "path length, of the VAE's", "lower", "the same in % of the VAE's"
    ),
    "path_over_straight": Measure(
        "1",
        "path, over the straight way",
        "lower",
        "length of the tool's path over that of the straight line",
    ),
    "undone_share": Measure(
        "1", "share of the path undone", "lower", "share of the tool's path that was gone back over"
    ),
    "demonstrated_undone_share": Measure(
        "1", "the same of the demonstration", None, "the same of the demonstrated episode itself"
    ),
    "progress": Measure(
        "1", "share of the waypoints reached", "higher", "share of the waypoints that were reached"
    ),
    "final_distance": Measure("m", "final distance", "lower", "of the tool from the target at the end"),
    "final_distance_percent_of_vae": Measure(
        "%", "final distance, of the VAE's", "lower", "the same in % of the VAE's"
    ),
    "relative_alignment_error": Measure(
        "1",
        "relative alignment error",
        "lower",
        "error of the poses that inputs lead to, relative to the length of the motions asked about",
    ),
    "answers": Measure(
        "1", "answers until asking stops", "lower", "questions answered until enough is known"
    ),
    "final_state_error": Measure(
        "1", "final state error", "lower", "distance of the final state from the goal"
    ),
    "final_tool_error": Measure(
        "1", "final tool error", "lower", "distance of the final tool from the goal's"
    ),
    "arrival_rate": Measure(
        "1", "share that arrives", "higher", "share of the drives that arrive at the goal"
    ),
    "extra_time_percent": Measure(
        "%", "time of LA beyond LA+SA's", None, "extra time of latent actions without shared autonomy"
    ),
    "final_belief": Measure(
        "1", "belief in the true goal at the end", "higher", "probability that the robot gives the true goal"
    ),
    "goal_entropy": Measure("nat", "entropy over goals", None, "entropy of the belief over goals"),
    "goal_open_share": Measure(
        "1",
        "steps with the true goal open",
        "higher",
        "share of the steps from which the true goal can be reached",
    ),
    "certified_share_eq_14": Measure(
        "1", "steps certified by equation 14", "higher", "share of the steps that equation 14 certifies"
    ),
    "certified_share_eq_13": Measure(
        "1", "steps certified by equation 13", "higher", "share of the steps that equation 13 certifies"
    ),
    "certified_share_known_help": Measure(
        "1", "steps certified, help known", "higher", "share of the steps certified with the help known"
    ),
    "certified_share_decoder": Measure(
        "1",
        "steps certified, help and decoder known",
        "higher",
        "share of the steps certified with the help and what the decoder can do against the goal known",
    ),
    "certified_share_tools": Measure(
        "1",
        "steps certified, in the metric of the tools",
        "higher",
        "share of the steps certified with help and decoder known, the distance in the metric of the tools",
    ),
    "bound_slack": Measure(
        "1",
        "slack of sigma_h",
        "lower",
        "how far the proven sigma_h is above the largest action among a few inputs, relative to it",
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
