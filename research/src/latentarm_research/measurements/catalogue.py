"""The measurements by name: what `latentarm measure` offers. None is imported before it runs."""

from collections.abc import Callable, Mapping
from importlib import import_module
from typing import Any, Final

from latentarm_research.measurements import options
from latentarm_research.measurements.measurement import Measurement, Outcome, Work

MEASUREMENTS: Final[Mapping[str, Measurement]] = {
    "clearance": Measurement(
        "Push arms at things and at themselves; MuJoCo measures the distances that they keep.",
        options.Clearance,
        {"drives": 2},
    ),
    "limits": Measurement(
        "Compare the true state of an imperfect arm in physics with the configured limits.",
        options.Limits,
        {"ticks": 240},
    ),
    "zones": Measurement(
        "Measure how fast parts of an arm are in a zone, exact and in physics.",
        options.Drives,
        {"drives": 1},
    ),
    "force": Measurement(
        "Measure how hard an arm in physics presses on what its filters do not know.",
        options.Force,
        {"drives": 1, "stiffness_n_mm": (75.0,)},
    ),
    "stops": Measurement(
        "Measure how long simulated arms take to come to rest after a fault in motion.",
        options.Stops,
        {"tries": 1, "arms": ("kinematic",)},
    ),
    "page-stops": Measurement(
        "Measure how fast the page stops the arm when browser, network or server fail.",
        options.PageStops,
        {"tries": 1, "faults": ("page closed",)},
    ),
    "help": Measurement(
        "Measure what each level of help on the page is worth to simulated people, and what it costs.",
        options.Help,
        {"drives": 1, "episodes": 2, "epochs": 1, "limit_s": 1.0},
    ),
    "step-help": Measurement(
        "Measure what help is worth at the steps of a task, with a way back and without, in physics.",
        options.StepHelp,
        {"tasks": ("entree",), "people": ("greedy",), "drives": 1, "episodes": 2, "epochs": 1},
    ),
    "published-help": Measurement(
        "Measure what published kinds of help are worth to simulated people at marshmallows, in physics.",
        options.PublishedHelp,
        {"drives": 1, "beta": (1000.0,), "kinds": ("hindsight",)},
    ),
    "way-back": Measurement(
        "Measure how far an adversary leads the tool off demonstrations, with a way back and without.",
        options.WayBack,
        {"kinds": ("pca",), "starts": 2, "steps": 50},
    ),
    "calibration": Measurement(
        "Measure what is calibrated of the simulated people: pushes and mode switches.",
        options.Calibrating,
        {"people": 2, "tasks": ("avoid",), "distances_m": (0.03,)},
    ),
    "people": Measurement(
        "Fit the simulated people to half of a public study's persons, and predict the other half.",
        options.People,
        {"people": 1},
    ),
    "null-checks": Measurement(
        "Measure how often the analysis of user studies finds what is not there, and what is.",
        options.NullChecks,
        {"studies": 2},
    ),
    "torque": Measurement(
        "Measure what share of the motors' torque gravity and a stop take, by a model and a limits file.",
        options.Torque,
        {"poses": 20},
    ),
}


def load_measurement(name: str) -> Callable[[Any, Work], Outcome]:
    """The function that measures: ``measure`` in the module of that name."""
    return import_module(f"latentarm_research.measurements.{name.replace('-', '_')}").measure
