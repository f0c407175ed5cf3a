"""The measurements by name, with their options: what `latentarm measure` offers.

The docstring of a measurement's options is the first line of its help.
Nothing heavy is imported, and no measurement before it runs, so that help is quick.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from importlib import import_module
from pathlib import Path
from typing import Annotated, Any, Final

from tyro.conf import arg

from latentarm_research.measurements.measurement import Measurement, Outcome, Work

Names = tuple[str, ...]
Numbers = tuple[float, ...]
Counts = tuple[int, ...]


@dataclass(frozen=True)
class Clearance:
    """Push arms at things and at themselves; MuJoCo measures the distances that they keep."""

    drives: Annotated[int, arg(help="How many, over all arms.")] = 2000
    held_ticks: Annotated[int, arg(help="Ticks of 10 ms with a cup or a long spoon, about.")] = 100_000


@dataclass(frozen=True)
class Limits:
    """Compare the true state of an imperfect arm in physics with the configured limits."""

    ticks: Annotated[int, arg(help="Ticks of 10 ms, at least.")] = 100_000


@dataclass(frozen=True)
class Drives:
    """Measure how fast parts of an arm are in a zone, exact and in physics."""

    drives: Annotated[int, arg(help="With each arm.")] = 30


@dataclass(frozen=True)
class Force:
    """Measure how hard an arm in physics presses on what its filters do not know."""

    drives: Annotated[int, arg(help="At each thing.")] = 8
    zone: Annotated[float | None, arg(metavar="M_PER_S", help="Speed of a zone about the thing.")] = None
    stiffness_n_mm: Annotated[Numbers, arg(help="Of springs, N/mm.")] = (150.0, 75.0, 25.0, 10.0)
    feels: Annotated[bool, arg(help="Whether the arm estimates external torques.")] = False


@dataclass(frozen=True)
class Stops:
    """Measure how long simulated arms take to come to rest after a fault in motion."""

    arms: Annotated[Names, arg(help="Simulated arms, of `latentarm arms list`.")] = ("kinematic", "mujoco")
    tries: Annotated[int, arg(help="Of each fault.")] = 20


@dataclass(frozen=True)
class PageStops:
    """Measure how fast the page stops the arm when browser, network or server fail."""

    run: Annotated[Path, arg(help="A trained run, which `latentarm teleop` serves.")]
    tries: Annotated[int, arg(help="Of each fault.")] = 20
    faults: Annotated[Names, arg(help="Which, such as `page closed`; by default all.")] = ()


@dataclass(frozen=True)
class PageLatency:
    """Measure how long after a key press the page shows the push and the arm's response."""

    run: Annotated[Path, arg(help="A trained run, which `latentarm teleop` serves.")]
    presses: Annotated[int, arg(help="Of arrow keys.")] = 500


@dataclass(frozen=True)
class StudyLoad:
    """Measure how many people can drive at the same time in a study on this machine."""

    people: Annotated[Counts, arg(help="How many at once, one number after another.")] = (1, 2, 3, 4, 6, 8)
    seconds: Annotated[float, arg(help="That each drive lasts; each person does two.")] = 30.0


@dataclass(frozen=True)
class Help:
    """Measure what each level of help on the page is worth to simulated people, and what it costs."""

    drives: Annotated[int, arg(help="To each item.")] = 5
    limit_s: Annotated[float, arg(help="Longest time of a drive, s.")] = 40.0
    episodes: Annotated[int, arg(help="Demonstrations that the model learns from.")] = 60
    epochs: Annotated[int | None, arg(help="Of training; by default the model's.")] = None


@dataclass(frozen=True)
class WayBack:
    """Measure how far an adversary leads the tool off demonstrations, with a way back and without."""

    kinds: Annotated[Names, arg(help="Models; by default all.")] = ()
    starts: Annotated[int, arg(help="Demonstrated states to start from.")] = 64
    steps: Annotated[int, arg(help="Of 20 ms.")] = 1000


@dataclass(frozen=True)
class Calibrating:
    """Measure what is calibrated of the simulated people: pushes and mode switches."""

    people: Annotated[int, arg(help="Simulated people.")] = 12
    repeats: Annotated[int, arg(help="Of each movement by each person.")] = 1
    tasks: Annotated[Names, arg(help="Driven for the share of mode switches.")] = ("marshmallows", "avoid")
    distances_m: Annotated[Numbers, arg(help="Of movements, m.")] = (0.03, 0.06, 0.12)


@dataclass(frozen=True)
class Torque:
    """Measure what share of the motors' torque gravity and a stop take, by a model and a limits file."""

    model: Annotated[Path, arg(help="MJCF file of the arm.")]
    limits: Annotated[Path, arg(help="Limits file, TOML or YAML.")]
    stall_n_m: Annotated[Numbers, arg(help="Torques of motors at standstill, N·m.")] = ()
    poses: Annotated[int, arg(help="Random poses.")] = 20_000


@dataclass(frozen=True)
class People:
    """Fit the simulated people to half of a public study's persons, and predict the other half."""

    clone: Annotated[Path, arg(help="A clone of mpan31415/AutonomyFitts.")]
    people: Annotated[int, arg(help="Simulated in each try of the fit; four times as many predict.")] = 4


@dataclass(frozen=True)
class Tags:
    """Measure how well things are found by tags, and cameras calibrated, in rendered pictures."""

    scenes: Annotated[int, arg(help="Rendered in each condition.")] = 200
    seconds: Annotated[float, arg(help="That a loop runs, with tags and without.")] = 20.0


@dataclass(frozen=True)
class Surroundings:
    """Drive models that look at things, with their true places and with those that sources tell."""

    runs: Annotated[int, arg(help="At each task with each source.")] = 50
    tasks: Annotated[Names, arg(help="Of `latentarm reproduce tasks`.")] = (
        "moved_marshmallows",
        "moved_reach_and_pour",
    )
    sources: Annotated[Names, arg(help="Which, such as `touch`; by default all.")] = ()
    demonstrations: Annotated[int, arg(help="That each model learns from.")] = 40
    epochs: Annotated[int, arg(help="Of training.")] = 60


MEASUREMENTS: Final[Mapping[str, Measurement]] = {
    "clearance": Measurement(Clearance, {"drives": 2, "held_ticks": 300}),
    "limits": Measurement(Limits, {"ticks": 240}),
    "zones": Measurement(Drives, {"drives": 1}),
    "force": Measurement(Force, {"drives": 1, "stiffness_n_mm": (75.0,)}),
    "stops": Measurement(Stops, {"tries": 1, "arms": ("kinematic",)}),
    "page-stops": Measurement(PageStops, {"tries": 1, "faults": ("page closed",)}),
    "page-latency": Measurement(PageLatency, {"presses": 4}),
    "study-load": Measurement(StudyLoad, {"people": (1,), "seconds": 1.0}),
    "help": Measurement(Help, {"drives": 1, "episodes": 2, "epochs": 1, "limit_s": 1.0}),
    "way-back": Measurement(WayBack, {"kinds": ("pca",), "starts": 2, "steps": 50}),
    "calibration": Measurement(Calibrating, {"people": 2, "tasks": ("avoid",), "distances_m": (0.03,)}),
    "people": Measurement(People, {"people": 1}),
    "torque": Measurement(Torque, {"poses": 20}),
    "tags": Measurement(Tags, {"scenes": 1, "seconds": 0.5}),
    "surroundings": Measurement(
        Surroundings,
        {"runs": 1, "tasks": ("marshmallows",), "sources": ("touch",), "demonstrations": 3, "epochs": 2},
        resumes=True,
    ),
}


def load_measurement(name: str) -> Callable[[Any, Work], Outcome]:
    """The function that measures: ``measure`` in the module of that name."""
    return import_module(f"latentarm_research.measurements.{name.replace('-', '_')}").measure
