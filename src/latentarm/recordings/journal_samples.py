"""A journal's encoding of the numbers of a step: exact, without repetition."""

import struct
from collections.abc import Sequence
from typing import Final

import numpy as np

from latentarm.core.types import FloatArray, GripperCommand, GripperReading, StepRecord
from latentarm.robots.kinematics.pose_rows import STORED

COMPACT: Final = {b"\x02": 8, b"\x03": 10, b"\x04": 11, b"\x05": 12}
"""How many parts a compact sample has, by its first byte: two of a gripper came later, then one of things,
then one of where their poses are from. Older samples begin with a small integer as a float64: a byte of 0."""

ALWAYS: Final = 8
"""Parts that every step of an episode has, in one width. The others are a gripper's, empty without a reading
or command, the things', empty where all stand as in the sample before, and who said where they are."""

_WRITTEN: Final = b"\x05"
_ZERO: Final = 0x8000
_SAME: Final = 0x4000
_WIDEST: Final = 0x3FFF
_NOTHING: Final = np.zeros(0)
_LEFT_OUT_MOST: Final = 64
"""Wider parts are always written in full: a small untrusted journal must not expand into a large one."""


def figures_of(record: StepRecord) -> Sequence[FloatArray]:
    """The numbers of a record, in the journal's order: scalars, arrays, the gripper's, the things'."""
    command = record.command
    measured, asked = record.gripper, command.gripper
    figures = record.time_s, record.alpha, float(record.mode), command.duration_s
    return (
        np.array([*figures, record.bound_rad, record.pace, record.added]),
        record.state,
        record.input,
        record.latent,
        record.action_human,
        record.action_assist,
        record.belief,
        command.velocity,
        _NOTHING if measured is None else np.array([measured.width_m, float(measured.holding)]),
        _NOTHING if asked is None else np.array([asked.width_m, asked.speed_m_s, asked.force_n]),
        record.things.ravel(),
        record.sightings.ravel(),
    )


def without_things(parts: Sequence[FloatArray]) -> Sequence[FloatArray]:
    """The parts of a sample whose things all stand as in the one before."""
    return (*parts[:-2], _NOTHING, parts[-1])


def gripper_reading(part: FloatArray) -> GripperReading | None:
    """A gripper's reading from a sample's part; ValueError where it is damaged."""
    if not len(part):
        return None
    width_m, holding = _gripper_figures(part, 2)
    if holding not in (0.0, 1.0):
        raise ValueError("a gripper neither holds something nor holds nothing")
    return GripperReading(width_m, holding == 1.0)


def gripper_command(part: FloatArray) -> GripperCommand | None:
    """A gripper's command from a sample's part; ValueError where it is damaged."""
    if not len(part):
        return None
    width_m, speed_m_s, force_n = _gripper_figures(part, 3)
    return GripperCommand(width_m, speed_m_s, force_n)


def thing_poses(part: FloatArray) -> FloatArray:
    """Poses of things, (K, 7), from a sample's part; ValueError where it is damaged."""
    if len(part) % STORED or not np.isfinite(part).all():
        raise ValueError("figures of things are missing or not finite")
    return part.reshape(-1, STORED)


def _gripper_figures(part: FloatArray, count: int) -> list[float]:
    if len(part) != count or not np.isfinite(part).all():
        raise ValueError("a gripper's figures are missing or not finite")
    return part.tolist()


def packed(parts: Sequence[FloatArray]) -> bytes:
    """Parts, each (k,), as one sample: a byte, two more for each part, then the parts that must be written.

    The two bytes hold the part's width, and a bit where it is all zeros, or equals the part before it. Raises
    ValueError where a part is too wide.
    """
    heads: list[int] = []
    written: list[bytes] = []
    before = b""
    for part in parts:
        if len(part) > _WIDEST:
            raise ValueError(f"{len(part)} figures are more than a sample's part can hold")
        content = np.ascontiguousarray(part, dtype="<f8").tobytes()
        if len(part) > _LEFT_OUT_MOST:
            heads.append(len(part))
            written.append(content)
        elif not content.strip(b"\0"):
            heads.append(len(part) | _ZERO)
        elif content == before:
            heads.append(len(part) | _SAME)
        else:
            heads.append(len(part))
            written.append(content)
        before = content
    return b"".join((_WRITTEN, struct.pack(f"<{len(heads)}H", *heads), *written))


def unpacked(sample: bytes) -> list[FloatArray]:
    """The parts of a compact sample of any version; ValueError where it is damaged."""
    count = COMPACT.get(sample[:1], 0)
    start = 1 + 2 * count
    if not count or len(sample) < start:
        raise ValueError("a sample has the wrong length")
    parts: list[FloatArray] = []
    before = b""
    for head in struct.unpack_from(f"<{count}H", sample, 1):
        size = 8 * (head & _WIDEST)
        if head & ~_WIDEST and size > 8 * _LEFT_OUT_MOST:
            raise ValueError("a sample is too long")
        if head & _ZERO:
            before = bytes(size)
        elif not head & _SAME:
            before = sample[start : start + size]
            start += size
        if len(before) != size:
            raise ValueError("a sample has the wrong length")
        parts.append(np.frombuffer(before, dtype="<f8").astype(np.float64))
    if start != len(sample):
        raise ValueError("a sample has the wrong length")
    return parts
