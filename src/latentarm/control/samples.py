"""How a journal encodes the numbers of a step: exactly, without repetition."""

import struct
from collections.abc import Sequence
from typing import Final

import numpy as np

from latentarm.types import FloatArray, StepRecord

COMPACT: Final = b"\x02"
"""First byte of a compact sample. Older ones begin with a small integer as a float64: a byte of 0."""

_ZERO: Final = 0x8000
_SAME: Final = 0x4000
_WIDEST: Final = 0x3FFF
_LEFT_OUT_MOST: Final = 64
"""Wider parts are always written in full: a small untrusted journal must not expand into a large one."""


def figures_of(record: StepRecord) -> Sequence[FloatArray]:
    """The numbers of a record, in the journal's order: times and scalars first, then arrays."""
    command = record.command
    return (
        np.array([record.time_s, record.alpha, float(record.mode), command.duration_s, record.bound_rad]),
        record.state,
        record.input,
        record.latent,
        record.action_human,
        record.action_assist,
        record.belief,
        command.velocity,
    )


def packed(parts: Sequence[FloatArray]) -> bytes:
    """Parts as one sample: `COMPACT`, two bytes for each part, then the parts that must be written.

    The two bytes hold the part's width, and a bit where it is all zeros, or equals the part before it.

    Args:
        parts: each (k,), float64.

    Raises:
        ValueError: a part is too wide.
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
    return b"".join((COMPACT, struct.pack(f"<{len(heads)}H", *heads), *written))


def unpacked(sample: bytes, count: int) -> list[FloatArray]:
    """The parts of a sample that `packed` made.

    Args:
        sample: as it was written.
        count: how many parts it has.

    Raises:
        ValueError: it is not what `packed` makes.
    """
    start = len(COMPACT) + 2 * count
    if len(sample) < start or sample[: len(COMPACT)] != COMPACT:
        raise ValueError("a sample has the wrong length")
    parts: list[FloatArray] = []
    before = b""
    for head in struct.unpack_from(f"<{count}H", sample, len(COMPACT)):
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
