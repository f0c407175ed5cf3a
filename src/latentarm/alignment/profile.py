"""A person's profile: their alignment on disk, next to the model that it was learned for. Loads no torch."""

import hashlib
import json
import re
import shutil
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Final, final

import numpy as np
from safetensors.numpy import save

from latentarm.alignment.runtime import LearnedAlignment, tensor_shapes
from latentarm.demonstrations.folders import check_vacant, staged_folder
from latentarm.errors import UserError
from latentarm.files import sync_folder, write_text, written_whole
from latentarm.models.reading import Section
from latentarm.models.saving import (
    CONFIG_LIMIT,
    CONFIG_NAME,
    MOST_LAYERS,
    WEIGHTS_LIMIT,
    WEIGHTS_NAME,
    read_tensors,
)
from latentarm.types import FloatArray
from latentarm.untrusted.opening import read_bytes

FOLDER: Final = "profiles"
ALIGNMENT_NAME: Final = "alignment.safetensors"
SCHEMA: Final = 1
NAMED: Final = re.compile(r"\w[\w-]{0,63}")

TRIAL: Final = ".trial"
"""Folder of a profile on trial, before it is kept under a person's name; no person can have this name."""


@final
@dataclass(frozen=True, eq=False)
class Profile:
    """What one person means by their input, under one seed of one model.

    Attributes:
        alignment: f.
        fingerprint: of the model and the seed, see `model_fingerprint`.
        seed_index: which of the model's seeds decodes.
    """

    alignment: LearnedAlignment
    fingerprint: str
    seed_index: int

    def __call__(self, u: FloatArray, context: FloatArray) -> FloatArray:
        """``z = f(u, c)``: inputs (..., d) in contexts (..., c) to latent actions (..., d)."""
        return self.alignment(u, context)


def model_fingerprint(run: Path, seed_index: int) -> str:
    """SHA-256 of a saved model's weights and the seed, so that no profile is taken for another model's.

    Raises:
        UserError: the run has no model.
    """
    path = run / WEIGHTS_NAME
    content = read_bytes(path, WEIGHTS_LIMIT)
    return hashlib.sha256(content + f"seed {seed_index}".encode()).hexdigest()


def profile_folder(run: Path, name: str) -> Path:
    """Where a run keeps a person's profile.

    Raises:
        UserError: the name is not one for a folder.
    """
    if not NAMED.fullmatch(name):
        raise UserError(f"{name!r} is not a profile name: use letters, digits, - and _, 64 at most.")
    return run / FOLDER / name


def new_profile_folder(run: Path, name: str) -> Path:
    """Where a run will keep a new profile.

    Raises:
        UserError: the name is not one for a folder, or has been given already.
    """
    folder = profile_folder(run, name)
    check_vacant(folder)
    return folder


def profile_names(run: Path) -> tuple[str, ...]:
    """People who have a profile of a run, in the order of the names."""
    found = (path.name for path in (run / FOLDER).glob("*/"))
    return tuple(sorted(name for name in found if NAMED.fullmatch(name)))


def trial_folder(run: Path) -> Path:
    """Where a run holds a profile on trial."""
    return run / FOLDER / TRIAL


def keep_trial(run: Path, name: str) -> None:
    """Keep the profile on trial under a person's name.

    Raises:
        UserError: the name is not one for a folder or has been given already, or there is nothing to keep.
    """
    folder = new_profile_folder(run, name)
    try:
        trial_folder(run).replace(folder)
        sync_folder(folder.parent)
    except OSError as error:
        raise UserError(f"{folder} cannot be written: {error.strerror or error}.") from error


def discard_trial(run: Path) -> None:
    """Delete the profile on trial, if there is one.

    Raises:
        UserError: it cannot be deleted.
    """
    folder = trial_folder(run)
    try:
        if folder.exists():
            shutil.rmtree(folder)
    except OSError as error:
        raise UserError(f"{folder} cannot be deleted: {error.strerror or error}.") from error


def save_profile(profile: Profile, folder: Path, about: Mapping[str, object]) -> None:
    """Write a profile to a new folder, which appears whole or not at all.

    Args:
        profile: the profile.
        folder: from `new_profile_folder`.
        about: further keys for its ``config.json`` (who answered what, how well it is met, ...).

    Raises:
        UserError: the folder is there already, or cannot be written.
    """
    alignment = profile.alignment
    content = save({name: np.ascontiguousarray(array) for name, array in alignment.tensors.items()})
    section = {
        "schema": SCHEMA,
        "fingerprint": profile.fingerprint,
        "seed_index": profile.seed_index,
        "latent": alignment.latent_dim,
        "context": alignment.context_dim,
        "hidden": list(alignment.hidden),
        "sha256": hashlib.sha256(content).hexdigest(),
    }
    with staged_folder(folder) as staging:
        with written_whole(staging / ALIGNMENT_NAME) as part:
            part.write_bytes(content)
        write_text(staging / CONFIG_NAME, json.dumps({"profile": section, **about}, indent=2) + "\n")


def load_profile(run: Path, name: str) -> Profile:
    """Read and check a person's profile of a run.

    Raises:
        UserError: there is no such profile, its files are broken or foreign, or it was learned for another
            model.
    """
    folder = trial_folder(run) if name == TRIAL else profile_folder(run, name)
    if not folder.is_dir():
        raise UserError(
            f"{run} has no profile '{name}': make one with `latentarm align {run} --name {name}`."
        )
    path = folder / CONFIG_NAME
    section = Section.of_file(path, CONFIG_LIMIT).section("profile")
    schema = section.integer("schema", 0)
    if schema != SCHEMA:
        raise UserError(
            f"{path} has schema {schema} and this version reads schema {SCHEMA}: align the person again."
        )
    seed_index = section.integer("seed_index", 0)
    fingerprint = section.text("fingerprint")
    if fingerprint != model_fingerprint(run, seed_index):
        raise UserError(
            f"The profile '{name}' was learned for another model than {run}: align the person again."
        )
    shapes = tensor_shapes(
        section.integer("latent", 1),
        section.integer("context", 1),
        tuple(section.integers("hidden", 1, longest=MOST_LAYERS)),
    )
    tensors = read_tensors(folder / ALIGNMENT_NAME, shapes, section.text("sha256"))
    return Profile(LearnedAlignment(tensors), fingerprint, seed_index)
