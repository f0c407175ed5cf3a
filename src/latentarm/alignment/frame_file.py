"""The frames of the stick that a run keeps, for each of its seeds and each seat of a person."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Final, get_args

import numpy as np

from latentarm.alignment.contract import Seat
from latentarm.alignment.frame import CENTRES, LENGTH_M, StickFrame, fit_frame
from latentarm.alignment.meaning import Meaning
from latentarm.alignment.poses import POSE_SIZE
from latentarm.core.errors import UserError
from latentarm.core.types import FloatArray
from latentarm.models.decoder import Decoder
from latentarm.models.reading import Section
from latentarm.models.saving import CONFIG_LIMIT, CONFIG_NAME, read_tensors, write_tensors
from latentarm.robots.kinematics.chain import Chain

FRAME_NAME: Final = "frame.safetensors"
SEATS: Final[tuple[Seat, ...]] = get_args(Seat)


def save_frames(
    folder: Path, decoders: Sequence[Decoder], chain: Chain, contexts: FloatArray
) -> Mapping[str, object]:
    """Fit the frames of a run for each seed's decoder and write them to its folder.

    Returns the key ``frame`` of the run's ``config.json``. Raises UserError where the file cannot be written.
    """
    tensors: dict[str, FloatArray] = {}
    for seat in SEATS:
        turning = [fit_frame(decoder, chain, contexts, seat).turning for decoder in decoders]
        tensors["place"] = turning[0].place  # the same for all: they come from the contexts alone
        tensors[f"{seat}.matrix"] = np.stack([one.matrix for one in turning])
        tensors[f"{seat}.turn"] = np.stack([one.turn_rad for one in turning])
    sha256 = write_tensors(folder / FRAME_NAME, tensors)
    return {"seeds": len(decoders), "places": len(tensors["place"]), "sha256": sha256}


def load_frame(folder: Path, seed_index: int, seat: Seat, chain: Chain) -> StickFrame | None:
    """Read and check a run's frame, None without one; UserError where a file is missing or damaged."""
    config = Section.of_file(folder / CONFIG_NAME, CONFIG_LIMIT)
    if config.plain().get("frame") is None:
        return None
    section = config.section("frame")
    seeds, places = section.integer("seeds", 1), section.integer("places", 1)
    if seed_index >= seeds or places > CENTRES:
        raise UserError(f"{section.where} has no frame of seed {seed_index}: train it again.")
    shapes: dict[str, tuple[int, ...]] = {"place": (places, POSE_SIZE * len(chain.tools))}
    for one in SEATS:
        shapes |= {f"{one}.matrix": (seeds, 2, 2), f"{one}.turn": (seeds, places)}
    tensors = read_tensors(folder / FRAME_NAME, shapes, section.text("sha256"))
    matrix, turn = tensors[f"{seat}.matrix"][seed_index], tensors[f"{seat}.turn"][seed_index]
    try:
        return StickFrame(Meaning(matrix, tensors["place"], turn, LENGTH_M), chain)
    except UserError as error:
        raise UserError(f"{folder / FRAME_NAME} is damaged: {error}") from error
