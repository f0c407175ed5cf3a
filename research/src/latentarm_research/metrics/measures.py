"""Measures of drives, of people and of help, beside those of models in `latentarm.evaluation.measures`."""

from latentarm.evaluation.measures import MEASURES, Measure

MEASURES.update(
    {
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
            "m s",
            "goal error, total",
            "lower",
            "integral over time of the tool's distance to the closest goal",
        ),
        "goal_error_m": Measure(
            "m", "goal error, mean", "lower", "mean over time of the tool's distance to the closest goal"
        ),
        "input_magnitude": Measure(
            "s",
            "input magnitude",
            "lower",
            "integral of ‖u‖ over time, seconds of full deflection of one axis",
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
        "progress": Measure(
            "1", "share of the waypoints reached", "higher", "share of the waypoints that were reached"
        ),
        "final_distance": Measure("m", "final distance", "lower", "of the tool from the target at the end"),
        "final_distance_percent_of_vae": Measure(
            "%", "final distance, of the VAE's", "lower", "the same in % of the VAE's"
        ),
        "final_state_error": Measure(
            "1", "final state error", "lower", "distance of the final state from the goal"
        ),
        "arrival_rate": Measure(
            "1", "share that arrives", "higher", "share of the drives that arrive at the goal"
        ),
        "extra_time_percent": Measure(
            "%", "time of LA beyond LA+SA's", None, "extra time of latent actions without shared autonomy"
        ),
        "certified_share_eq_14": Measure(
            "1", "steps certified by equation 14", "higher", "share of the steps that equation 14 certifies"
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
            "share of the steps certified with help and decoder known, distances in the metric of the tools",
        ),
    }
)
