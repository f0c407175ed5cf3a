"""Samples of the demonstrations that a run keeps: to ask people about, and to measure its model on."""

from collections.abc import Mapping
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final, final

import numpy as np

from latentarm.alignment.answers import Motions
from latentarm.alignment.demonstrated import shown
from latentarm.core.errors import UserError
from latentarm.core.types import Demonstrations, FloatArray, IntArray
from latentarm.demonstrations.split import select_episodes
from latentarm.evaluation.evaluation import Probe, take_probe
from latentarm.evaluation.samples import StartGoalPairs
from latentarm.models.reading import Section
from latentarm.models.saving import CONFIG_LIMIT, CONFIG_NAME, read_tensors, write_tensors
from latentarm.robots.kinematics.chain import Chain

if TYPE_CHECKING:
    from latentarm.models.model import LatentActionModel

SAMPLES_NAME: Final = "samples.safetensors"
ALIGN_STREAM: Final = 3  # stream of a seed that draws the motions that a person is asked about
MOST_ROWS: Final = 100_000  # most rows of an array; a run of ours keeps some thousands
_WIDTHS: Final = {
    "unlabelled": "context",  # runs of earlier versions have it
    "motions.start": "action",
    "motions.end": "action",
    "motions.rest": "rest",
    "motions.belief": "rest",  # its name in earlier versions
    "probe.start": "context",
    "probe.goal": "action",
    "probe.states": "context",
    "probe.context": "context",
    "probe.action": "action",
}


@final
@dataclass(frozen=True, eq=False)
class Samples:
    """Samples of the demonstrations in a run's folder."""

    motions: Motions | None  # for questions to people; None where no demonstration moves for long enough
    probe: Probe | None  # for `latentarm evaluate`; None where nothing moves in the held-out episodes


def take_samples(
    model: "LatentActionModel",
    demonstrations: Demonstrations,
    training: IntArray,
    held_out: IntArray,
    chain: Chain,
    rng: np.random.Generator,
) -> Samples:
    """Choose the samples that a run keeps: motions of the training episodes, and held-out samples."""
    motions = probe = None
    # What cannot be taken is not kept; `align` and `evaluate` say why once they need it.
    with suppress(UserError):
        motions = shown(select_episodes(demonstrations, training), model.context, chain, rng)
    with suppress(UserError):
        probe = take_probe(model, demonstrations, held_out.tolist())
    return Samples(motions, probe)


def save_samples(folder: Path, samples: Samples) -> Mapping[str, object]:
    """Write samples to a run's folder; the key ``samples`` of ``config.json``. UserError where it fails."""
    tensors: dict[str, FloatArray] = {}
    motions, probe = samples.motions, samples.probe
    if motions is not None:
        tensors |= {"motions.start": motions.start, "motions.end": motions.end, "motions.rest": motions.rest}
    if probe is not None:
        tensors |= {
            "probe.start": probe.pairs.start,
            "probe.goal": probe.pairs.goal,
            "probe.states": probe.states,
            "probe.context": probe.context,
            "probe.action": probe.action,
        }
    return {
        "shapes": {name: list(array.shape) for name, array in tensors.items()},
        "duration_s": None if motions is None else motions.duration_s,
        "step_s": None if probe is None else probe.step_s,
        "sha256": write_tensors(folder / SAMPLES_NAME, tensors),
    }


def load_samples(folder: Path) -> Samples | None:
    """Read and check a run's samples, None without any; UserError where a file is missing or damaged."""
    config = Section.of_file(folder / CONFIG_NAME, CONFIG_LIMIT)
    if config.plain().get("samples") is None:
        return None
    section = config.section("samples")
    named = section.section("shapes")
    sizes = config.section("model").section("dimensions")
    width = {"context": sizes.integer("context", 1), "action": sizes.integer("action", 1)}
    width["rest"] = width["context"] - width["action"]
    shapes: dict[str, tuple[int, ...]] = {}
    for name in named.values:
        rows, columns = named.integers(name, 0, length=2)
        if rows > MOST_ROWS or columns != width.get(_WIDTHS.get(name, "")):
            raise UserError(f"{named.where}: '{name}' has the shape {rows}, {columns}: the run is damaged.")
        shapes[name] = (rows, columns)
    tensors: dict[str, Any] = read_tensors(folder / SAMPLES_NAME, shapes, section.text("sha256"))
    motions = probe = None
    try:
        if section.plain().get("duration_s") is not None:
            duration_s = float(section.array("duration_s", ()))
            start, end = tensors["motions.start"], tensors["motions.end"]
            rest = tensors["motions.belief" if "motions.belief" in tensors else "motions.rest"]
            motions = Motions(start, end, duration_s, rest)
        if section.plain().get("step_s") is not None:
            pairs = StartGoalPairs(tensors["probe.start"], tensors["probe.goal"])
            states, context, action = (tensors[f"probe.{name}"] for name in ("states", "context", "action"))
            probe = Probe(pairs, states, context, action, float(section.array("step_s", ())))
        return Samples(motions, probe)
    except KeyError as error:
        raise UserError(f"{folder / SAMPLES_NAME} lacks {error}: the run is damaged.") from error
