"""A person's profile: their alignment on disk, next to the model that it was learned for. Loads no torch."""

import hashlib
import json
import re
import shlex
import shutil
from collections.abc import Mapping
from contextlib import suppress
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from typing import Final, final

import numpy as np

from latentarm.alignment.contract import Alignment
from latentarm.alignment.demonstrated_directions import DemonstratedDirections
from latentarm.alignment.meaning import Meaning
from latentarm.alignment.poses import POSE_SIZE
from latentarm.alignment.runtime import LearnedAlignment, tensor_shapes
from latentarm.alignment.tool_space import ToolSpace
from latentarm.core.errors import UserError
from latentarm.core.files import sync_folder, write_text
from latentarm.core.types import FloatArray
from latentarm.core.untrusted.names import clean_name
from latentarm.core.untrusted.opening import read_bytes
from latentarm.demonstrations.folders import check_vacant, staged_folder
from latentarm.models.decoder import Decoder
from latentarm.models.kind import Shape
from latentarm.models.reading import Section
from latentarm.models.saving import (
    CONFIG_LIMIT,
    CONFIG_NAME,
    MOST_LAYERS,
    WEIGHTS_LIMIT,
    WEIGHTS_NAME,
    read_tensors,
    write_tensors,
)
from latentarm.robots.kinematics.chain import Chain

FOLDER: Final = "profiles"
ALIGNMENT_NAME: Final = "alignment.safetensors"
SCHEMA: Final = 2
NETWORK_SCHEMA: Final = 1  # older profiles hold a network; they are still read
MOST_PLACES: Final = 10_000  # most answers and most regions; a profile of ours keeps some tens
NAMED: Final = re.compile(r"\w[\w-]{0,63}")  # names that are also the name of their folder
MOST_CHARACTERS: Final = 64
_DIGEST: Final = re.compile(r"\+[0-9a-f]{24}")
"""Folders of all other names; the name itself is in ``config.json``."""

SCALES: Final = "lengths.scale"
"""Tensor of the turn's length, m, the regions' width, m, the fastest motion, m/s, and its duration, s."""

TRIAL: Final = ".trial"
"""Folder of a profile on trial, before it is kept under a person's name; no person can have this name."""


@final
@dataclass(frozen=True, eq=False)
class Profile:
    """One person's meaning of an input, under one seed of one model."""

    known: ToolSpace | LearnedAlignment  # of an older profile the network f
    fingerprint: str  # of the model and the seed, see `model_fingerprint`
    seed_index: int  # which of the model's seeds decodes

    def alignment(self, decoder: Decoder, chain: Chain) -> Alignment:
        """``z = f(u, c)`` with the model's decoder; UserError where the profile is for another arm."""
        if isinstance(self.known, LearnedAlignment):
            return self.known
        return self.known.with_arm(decoder, chain)


def model_fingerprint(run: Path, seed_index: int) -> str:
    """SHA-256 of a saved model's weights and the seed, so that no other model gets the profile."""
    path = run / WEIGHTS_NAME
    content = read_bytes(path, WEIGHTS_LIMIT)
    return hashlib.sha256(content + f"seed {seed_index}".encode()).hexdigest()


def profile_folder(run: Path, name: str) -> Path:
    """The folder of a person's profile in a run, for any name in any script; UserError where it is none."""
    return run / FOLDER / _folder_name(name)


def _folder_name(name: str) -> str:
    if NAMED.fullmatch(name):
        return name
    if name == TRIAL:
        raise UserError(f"{name!r} cannot be the name of a profile: choose another one.")
    clean = clean_name(name, MOST_CHARACTERS)
    return clean if NAMED.fullmatch(clean) else f"+{hashlib.sha256(clean.encode()).hexdigest()[:24]}"


def new_profile_folder(run: Path, name: str) -> Path:
    """The folder of a new profile; UserError where its name is none or has been given already."""
    folder = profile_folder(run, name)
    check_vacant(folder)
    return folder


def profile_names(run: Path) -> tuple[str, ...]:
    """People who have a profile of a run, in the order of the names."""
    found = (_name_of(path) for path in (run / FOLDER).glob("*/"))
    return tuple(sorted(name for name in found if name is not None))


def _name_of(folder: Path) -> str | None:
    """The name of the profile in a folder; None where it holds none."""
    if NAMED.fullmatch(folder.name):
        return folder.name
    if not _DIGEST.fullmatch(folder.name):
        return None
    with suppress(OSError, UserError):
        config = folder / CONFIG_NAME
        name = _written_name(config, config.stat().st_mtime_ns)
        return name if _folder_name(name) == folder.name else None
    return None


@lru_cache(maxsize=256)
def _written_name(config: Path, changed_ns: int) -> str:
    """The name in a profile's ``config.json``, read once for each change of the file."""
    return clean_name(Section.of_file(config, CONFIG_LIMIT).text("name"), MOST_CHARACTERS)


def trial_folder(run: Path) -> Path:
    """The folder of a run's profile on trial."""
    return run / FOLDER / TRIAL


def folder_of(run: Path, name: str) -> Path:
    """The folder of the profile of a name, which may be on trial; UserError where it is no name."""
    return trial_folder(run) if name == TRIAL else profile_folder(run, name)


def keep_trial(run: Path, name: str) -> None:
    """Keep the profile on trial under a person's name.

    Raises UserError where it is no name or has been given already, or there is nothing to keep.
    """
    folder = new_profile_folder(run, name)
    try:
        trial_folder(run).replace(folder)
        sync_folder(folder.parent)
    except OSError as error:
        raise UserError(f"{folder} cannot be written: {error.strerror or error}.") from error


def discard_trial(run: Path) -> None:
    """Delete the profile on trial, if there is one; UserError where it cannot be deleted."""
    folder = trial_folder(run)
    try:
        if folder.exists():
            shutil.rmtree(folder)
    except OSError as error:
        raise UserError(f"{folder} cannot be deleted: {error.strerror or error}.") from error


def save_profile(
    known: ToolSpace, fingerprint: str, seed_index: int, folder: Path, about: Mapping[str, object]
) -> None:
    """Write a profile to a new folder, from `new_profile_folder`, which appears whole or not at all.

    ``about`` has further keys for its ``config.json`` (who answered what, how well it is met).

    Raises UserError where the folder is there already, or cannot be written.
    """
    inputs, twist = known.meaning.matrix.shape
    section: dict[str, object] = {
        "schema": SCHEMA,
        "fingerprint": fingerprint,
        "seed_index": seed_index,
        "latent": inputs,
        "tools": twist // 6,
        "answers": len(known.meaning.place),
        "regions": len(known.surroundings.place),
    }
    with staged_folder(folder) as staging:
        section["sha256"] = write_tensors(staging / ALIGNMENT_NAME, _tensors(known))
        write_text(staging / CONFIG_NAME, json.dumps({"profile": section, **about}, indent=2) + "\n")


def load_profile(run: Path, name: str) -> Profile:
    """Read and check a person's profile of a run.

    Raises UserError where there is no such profile, its files are broken or foreign, or it was learned for
    another model.
    """
    folder = folder_of(run, name)
    if not folder.is_dir():
        raise UserError(
            f"{run} has no profile '{name}': make one with"
            f" `latentarm align {run} --name {shlex.quote(name)}`."
        )
    path = folder / CONFIG_NAME
    section = Section.of_file(path, CONFIG_LIMIT).section("profile")
    schema = section.integer("schema", 0)
    if schema not in (SCHEMA, NETWORK_SCHEMA):
        raise UserError(
            f"{path} has schema {schema} and this version reads schema {SCHEMA}: align the person again."
        )
    seed_index = section.integer("seed_index", 0)
    fingerprint = section.text("fingerprint")
    if fingerprint != model_fingerprint(run, seed_index):
        raise UserError(
            f"The profile '{name}' was learned for another model than {run}: align the person again."
        )
    if schema == NETWORK_SCHEMA:
        known: ToolSpace | LearnedAlignment = LearnedAlignment(_read(folder, section, _network(section)))
    else:
        known = _tool_space(_read(folder, section, _tool_space_shapes(section)))
    return Profile(known, fingerprint, seed_index)


def _read(folder: Path, section: Section, shapes: Mapping[str, Shape]) -> dict[str, FloatArray]:
    return read_tensors(folder / ALIGNMENT_NAME, shapes, section.text("sha256"))


def _network(section: Section) -> dict[str, Shape]:
    """Shapes of an older profile's tensors."""
    latent, context = section.integer("latent", 1), section.integer("context", 1)
    return tensor_shapes(latent, context, tuple(section.integers("hidden", 1, longest=MOST_LAYERS)))


def _tool_space_shapes(section: Section) -> dict[str, Shape]:
    inputs, tools = section.integer("latent", 1), section.integer("tools", 1)
    answers, regions = section.integer("answers", 1), section.integer("regions", 1)
    if max(inputs, tools, answers, regions) > MOST_PLACES:
        raise UserError(f"{section.where} describes a profile that is too large: align the person again.")
    return {
        "meaning": (inputs, 6 * tools),
        "answers.place": (answers, POSE_SIZE * tools),
        "answers.turn": (answers,),
        "regions.place": (regions, POSE_SIZE * tools),
        "regions.outside": (regions, 6 * tools, 6 * tools),
        SCALES: (4,),
    }


def _tensors(known: ToolSpace) -> dict[str, FloatArray]:
    meaning, surroundings = known.meaning, known.surroundings
    return {
        "meaning": meaning.matrix,
        "answers.place": meaning.place,
        "answers.turn": meaning.turn_rad,
        "regions.place": surroundings.place,
        "regions.outside": surroundings.outside,
        SCALES: np.array([meaning.length_m, surroundings.width_m, surroundings.fast_m_s, known.duration_s]),
    }


def _tool_space(tensors: Mapping[str, FloatArray]) -> ToolSpace:
    length_m, width_m, fast_m_s, duration_s = map(float, tensors[SCALES])
    return ToolSpace(
        Meaning(tensors["meaning"], tensors["answers.place"], tensors["answers.turn"], length_m),
        DemonstratedDirections(tensors["regions.place"], tensors["regions.outside"], width_m, fast_m_s),
        duration_s,
    )
