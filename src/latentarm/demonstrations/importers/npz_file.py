"""Importing NumPy archives (``.npz``) of plain arrays.

Keys: ``q`` (N, n) joint positions, rad; ``episode_ends`` (E,) exclusive end of each episode; ``rate_hz`` ().
Optional: ``timestamp`` (N,) s, ``action`` (N, n) joint velocities meant as actions, rad/s, ``joint_names``
(n,) and ``robot`` () as text, ``dq`` (N, n) measured velocities, ``tau`` (N, n) measured torques, and
``gripper_toggles`` (G,) samples after which the gripper opened or closed. Measured velocities are noisy and
never become actions. Other arrays are not read, and the record of the import names them.
"""

import lzma
import math
import struct
import tokenize
import zipfile
import zlib
from pathlib import Path
from typing import Final

import numpy as np
from numpy.lib import format as npy
from numpy.typing import NDArray

from latentarm.core.errors import UserError
from latentarm.core.types import Demonstrations, Episode, FloatArray, IntArray
from latentarm.core.untrusted.opening import opened
from latentarm.demonstrations.bounds import MAX_FILE_BYTES, check_values
from latentarm.demonstrations.gripper import GRIPPER_TOGGLED
from latentarm.demonstrations.importers.options import ImportOptions
from latentarm.demonstrations.importers.source import SourceData
from latentarm.demonstrations.info import default_joint_names

FEATURES: Final = {"dq": "observation.velocity", "tau": "observation.effort"}
TEXTS: Final = ("joint_names", "robot")
ARRAYS: Final = {"q", "episode_ends", "rate_hz", "timestamp", "action", "gripper_toggles", *TEXTS, *FEATURES}
MAX_ARRAYS: Final = 100  # in one archive
_DAMAGED: Final = (zipfile.BadZipFile, zlib.error, lzma.LZMAError, struct.error)


def read_npz(source: Path, options: ImportOptions) -> SourceData:
    """Read demonstrations from a NumPy archive; the task is the file's name by default."""
    arrays, others = _read_arrays(source)
    for key in ("q", "episode_ends"):
        if key not in arrays:
            raise UserError(f"{source} has no array '{key}'; it has {', '.join(sorted([*arrays, *others]))}.")
    q = arrays["q"].astype(np.float64)
    if q.ndim != 2:
        raise UserError(f"{source}: the array 'q' has the shape {q.shape}, not (samples, joints).")
    ends = _episode_ends(arrays["episode_ends"], len(q), source)
    rate = options.rate_hz or _rate(arrays, source)
    by_sample = {key: arrays[key].astype(np.float64) for key in ("action", *FEATURES) if key in arrays}
    timestamp = arrays["timestamp"].astype(np.float64) if "timestamp" in arrays else None
    for key, values in (by_sample if timestamp is None else by_sample | {"timestamp": timestamp}).items():
        expected = q.shape[:1] if key == "timestamp" else q.shape
        if values.shape != expected:
            shape = f"has the shape {values.shape}; with this 'q' it must be {expected}"
            raise UserError(f"{source}: the array '{key}' {shape}.")
    extras = {feature: by_sample[key] for key, feature in FEATURES.items() if key in by_sample}
    if "gripper_toggles" in arrays:
        extras[GRIPPER_TOGGLED] = _gripper(arrays["gripper_toggles"], ends, source)
    episodes = tuple(
        Episode(
            state=q[start:end],
            timestamp=np.arange(end - start) / rate
            if timestamp is None
            else timestamp[start:end] - timestamp[start],
            action=by_sample["action"][start:end] if "action" in by_sample else None,
            task=options.instruction or source.stem,
            extras={name: values[start:end] for name, values in extras.items()},
        )
        for start, end in zip([0, *ends[:-1]], ends, strict=True)
    )
    demonstrations = Demonstrations(
        episodes=episodes,
        rate_hz=rate,
        joint_names=_joint_names(arrays, q.shape[1], source),
        robot="" if "robot" not in arrays else str(arrays["robot"].reshape(-1)[0]),
    )
    return SourceData(
        demonstrations, "NumPy archive", in_rad=True, record={"arrays left out": ", ".join(others)}
    )


def _joint_names(arrays: dict[str, NDArray[np.generic]], dof: int, source: Path) -> tuple[str, ...]:
    if "joint_names" not in arrays:
        return default_joint_names(dof)
    names = tuple(str(name) for name in arrays["joint_names"].reshape(-1))
    if len(names) != dof:
        raise UserError(f"{source}: 'joint_names' has {len(names)} names, but 'q' has {dof} columns.")
    return names


def _read_arrays(source: Path) -> tuple[dict[str, NDArray[np.generic]], list[str]]:
    """The arrays that are used, once known to be plain and of bearable size, and the names of all others."""
    try:
        with opened(source, MAX_FILE_BYTES) as stream, zipfile.ZipFile(stream) as archive:
            members = [member for member in archive.infolist() if member.filename.endswith(".npy")]
            if not members:
                raise UserError(f"{source} is a .zip of other files: unpack it and import what is in it.")
            if len(members) > MAX_ARRAYS:
                raise UserError(f"{source} holds {len(members):,} arrays, over the limit of {MAX_ARRAYS}.")
            named = {member.filename.removesuffix(".npy"): member for member in members}
            used = {key: member for key, member in named.items() if key in ARRAYS}
            count = sum(_declared_count(archive, member, source) for member in used.values())
            check_values(source, "it", count)
            arrays: dict[str, NDArray[np.generic]] = {}
            for key, member in used.items():
                with archive.open(member) as stream:
                    arrays[key] = npy.read_array(stream, allow_pickle=False)
            return arrays, [key for key in named if key not in ARRAYS]
    except (*_DAMAGED, EOFError, ValueError, OSError, RuntimeError) as error:
        raise UserError(
            f"{source} is not a whole .npz file; it is truncated, damaged or encrypted."
        ) from error


def _declared_count(archive: zipfile.ZipFile, member: zipfile.ZipInfo, source: Path) -> int:
    """Numbers that a member declares, checked against its actual bytes."""
    key = member.filename.removesuffix(".npy")
    with archive.open(member) as stream:
        version = npy.read_magic(stream)
        if version not in {(1, 0), (2, 0)}:
            raise UserError(f"{source}: the array '{key}' is of an unknown format version.")
        read_header = npy.read_array_header_1_0 if version == (1, 0) else npy.read_array_header_2_0
        try:
            shape, _, dtype = read_header(stream)
        except (SyntaxError, tokenize.TokenError) as error:
            raise UserError(f"{source}: the array '{key}' has a damaged header.") from error
        header_bytes = stream.tell()
    if dtype.hasobject:
        raise UserError(f"{source}: the array '{key}' holds pickled objects, which are never opened.")
    if dtype.kind not in ("U" if key in TEXTS else "fiu") or (key in TEXTS and 0 in shape):
        raise UserError(f"{source}: the array '{key}' holds {dtype}, not plain numbers.")
    count = math.prod(shape)
    if min(shape, default=0) < 0 or header_bytes + count * dtype.itemsize != member.file_size:
        raise UserError(f"{source}: the array '{key}' declares the shape {shape} but does not hold as much.")
    return count


def _rate(arrays: dict[str, NDArray[np.generic]], source: Path) -> float:
    if "rate_hz" not in arrays or arrays["rate_hz"].size != 1:
        raise UserError(f"{source} has no single 'rate_hz'; give the sampling rate with --rate-hz.")
    rate = float(arrays["rate_hz"].astype(np.float64).ravel()[0])
    if not (math.isfinite(rate) and rate > 0):
        raise UserError(f"{source}: the sampling rate is {rate:g} Hz; it must be a finite number above zero.")
    return rate


def _episode_ends(values: NDArray[np.generic], samples: int, source: Path) -> list[int]:
    if values.ndim != 1 or values.dtype.kind not in "iu":
        raise UserError(f"{source}: 'episode_ends' must be a row of whole numbers.")
    if values.size == 0:
        raise UserError(f"{source}: there are no episodes in it.")
    ends: list[int] = values.tolist()
    for index, (start, end) in enumerate(zip([0, *ends[:-1]], ends, strict=True)):
        if end == start:
            raise UserError(f"{source}: episode {index} is empty: it ends at sample {end}, where it begins.")
        if end < start:
            raise UserError(
                f"{source}: episode {index} ends at sample {end}, before it begins at sample {start}."
            )
    if ends[-1] != samples:
        raise UserError(
            f"{source}: 'episode_ends' ends at {ends[-1]}, but there are {samples} samples; one is truncated."
        )
    return ends


def _gripper(toggles: NDArray[np.generic], ends: list[int], source: Path) -> FloatArray:
    """(N, 1), one after an odd number of toggles since the episode began: another state than at its start."""
    samples = ends[-1]
    index: IntArray = toggles.astype(np.int64)
    whole = toggles.dtype.kind in "iu" or not toggles.size  # NumPy calls an empty row a row of floats
    if toggles.ndim != 1 or not whole or (toggles.size and not 0 <= index.min() <= index.max() < samples):
        raise UserError(f"{source}: 'gripper_toggles' must be indices of its {samples} samples.")
    toggled = np.bincount(index, minlength=samples)
    # A toggle counts from the sample after it on.
    each = [np.cumsum([0, *one[:-1]]) % 2 for one in np.split(toggled, ends[:-1])]
    return np.concatenate(each)[:, None].astype(np.float64)
