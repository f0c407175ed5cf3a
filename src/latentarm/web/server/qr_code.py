"""QR codes for links: ISO/IEC 18004 in byte mode, with error correction of level M, in numbers 1 to 14.

It is here because the packages for it have had no release for a year and a half, and because a link needs
only a small part of the standard.
"""

from functools import cache
from itertools import product
from typing import Final

import numpy as np
import numpy.typing as npt

from latentarm.errors import UserError

Modules = npt.NDArray[np.bool_]
"""(n, n), True where a module is dark, without the light edge around."""

Indices = npt.NDArray[np.int64]

MOST_BYTES: Final = 362
"""The longest text in `_NUMBERS`."""

EDGE: Final = 4
"""Light modules that must be around a code."""

_NUMBERS: Final = range(1, 15)
_CHECKS: Final = (10, 16, 26, 18, 24, 16, 18, 22, 22, 26, 30, 22, 22, 24)
"""Codewords of error correction in each block, by number."""
_BLOCKS: Final = (1, 1, 1, 2, 2, 4, 4, 4, 5, 5, 5, 8, 9, 9)

_BYTE_MODE: Final = 0b0100
_LEVEL_M: Final = 0b00
_FIELD: Final = 0x11D
"""x^8 + x^4 + x^3 + x^2 + 1, over which codewords are multiplied."""


def qr_code(text: str) -> Modules:
    """A text as the smallest code that holds it.

    Raises:
        UserError: it is longer than `MOST_BYTES`.
    """
    content = text.encode()
    number = next((n for n in _NUMBERS if len(content) <= _room(n)), None)
    if number is None:
        raise UserError(f"{len(content)} bytes are too many for a QR code: {MOST_BYTES} fit.")
    fixed, reserved = _fixed(number)
    drawn = _place(_codewords(number, content), fixed, reserved)
    return min((_masked(drawn, reserved, mask) for mask in range(8)), key=_penalty)


def terminal_text(modules: Modules) -> str:
    """A code for a terminal with a dark ground: two rows of modules in a line, light ones drawn."""
    light = ~np.pad(modules, EDGE)
    rows = np.vstack([light, np.zeros((len(light) % 2, len(light)), bool)])
    return "\n".join(
        "".join(" ▄▀█"[2 * upper + lower] for upper, lower in zip(*pair, strict=True))
        for pair in zip(rows[0::2].tolist(), rows[1::2].tolist(), strict=True)
    )


def svg_path(modules: Modules) -> str:
    """The dark modules as the path of an SVG whose units are modules, with the edge around."""
    return "".join(f"M{x + EDGE} {y + EDGE}h1v1h-1z" for y, x in np.argwhere(modules).tolist())


def _room(number: int) -> int:
    """Bytes of text that a code of this number holds."""
    blocks, checks = _BLOCKS[number - 1], _CHECKS[number - 1]
    bits = (_capacity(number) - blocks * checks) * 8 - 4 - _length_bits(number)
    return bits // 8


def _length_bits(number: int) -> int:
    return 8 if number < 10 else 16


@cache
def _capacity(number: int) -> int:
    """All codewords of a code."""
    return int(np.count_nonzero(~_fixed(number)[1])) // 8


def _codewords(number: int, content: bytes) -> list[int]:
    """The content with its error correction, as it is laid into the code."""
    blocks, checks = _BLOCKS[number - 1], _CHECKS[number - 1]
    room = _capacity(number) - blocks * checks
    bits = f"{_BYTE_MODE:04b}{len(content):0{_length_bits(number)}b}" + "".join(
        f"{byte:08b}" for byte in content
    )
    bits += "0" * min(4, 8 * room - len(bits))
    bits += "0" * (-len(bits) % 8)
    data = [int(bits[at : at + 8], 2) for at in range(0, len(bits), 8)]
    data += [(0xEC, 0x11)[index % 2] for index in range(room - len(data))]
    # The last blocks are longer by one where the data cannot be shared out evenly.
    shorter = blocks - room % blocks
    sizes = [room // blocks + (index >= shorter) for index in range(blocks)]
    starts = [sum(sizes[:index]) for index in range(blocks)]
    parts = [data[start : start + size] for start, size in zip(starts, sizes, strict=True)]
    corrections = [_correction(part, checks) for part in parts]
    longest = max(sizes)
    return [part[index] for index in range(longest) for part in parts if index < len(part)] + [
        correction[index] for index in range(checks) for correction in corrections
    ]


def _inverted(y: Indices, x: Indices) -> list[Modules]:
    """The eight masks: which modules are inverted."""
    by_two, by_three = y * x % 2, y * x % 3
    return [
        (y + x) % 2 == 0,
        y % 2 == 0,
        x % 3 == 0,
        (y + x) % 3 == 0,
        (y // 2 + x // 3) % 2 == 0,
        by_two + by_three == 0,
        (by_two + by_three) % 2 == 0,
        ((y + x) % 2 + by_three) % 2 == 0,
    ]


def _times(one: int, other: int) -> int:
    """The product of two codewords."""
    found = 0
    for bit in range(7, -1, -1):
        found = (found << 1) ^ (found >> 7) * _FIELD
        found ^= (other >> bit & 1) * one
    return found


@cache
def _divisor(degree: int) -> list[int]:
    """The generator polynomial, its largest coefficient (1) left out."""
    found = [0] * (degree - 1) + [1]
    root = 1
    for _ in range(degree):
        found = [
            _times(coefficient, root) ^ (found[index + 1] if index + 1 < degree else 0)
            for index, coefficient in enumerate(found)
        ]
        root = _times(root, 2)
    return found


def _correction(data: list[int], degree: int) -> list[int]:
    """Reed and Solomon's codewords for a block."""
    rest = [0] * degree
    for codeword in data:
        factor = codeword ^ rest[0]
        rest = [
            coefficient ^ _times(divisor, factor)
            for coefficient, divisor in zip([*rest[1:], 0], _divisor(degree), strict=True)
        ]
    return rest


@cache
def _fixed(number: int) -> tuple[Modules, Modules]:
    """What is the same in all codes of a number, and which modules carry no content."""
    size = 17 + 4 * number
    dark = np.zeros((size, size), bool)
    reserved = np.zeros((size, size), bool)
    dark[6, ::2] = dark[::2, 6] = True
    reserved[6, :] = reserved[:, 6] = True
    for y, x in ((0, 0), (0, size - 7), (size - 7, 0)):
        around = np.s_[max(y - 1, 0) : y + 8, max(x - 1, 0) : x + 8]
        dark[around] = False
        reserved[around] = True
        dark[y : y + 7, x : x + 7] = _ring(7)
    # Room for the format, which the mask decides.
    reserved[8, :9] = reserved[:9, 8] = reserved[8, size - 8 :] = reserved[size - 8 :, 8] = True
    dark[size - 8, 8] = True
    middles = _alignments(number)
    corners = {(6, 6), (6, size - 7), (size - 7, 6)}
    for y, x in product(middles, middles):
        if (y, x) not in corners:
            dark[y - 2 : y + 3, x - 2 : x + 3] = _ring(5)
            reserved[y - 2 : y + 3, x - 2 : x + 3] = True
    if number >= 7:
        version = number << 12 | _remainder(number, 12, 0x1F25)
        for bit in range(18):
            y, x = size - 11 + bit % 3, bit // 3
            dark[y, x] = dark[x, y] = bool(version >> bit & 1)
            reserved[y, x] = reserved[x, y] = True
    return dark, reserved


def _ring(size: int) -> Modules:
    """A dark square with a light ring, one module from its rim."""
    from_rim = np.minimum(np.arange(size), np.arange(size)[::-1])
    return np.minimum.outer(from_rim, from_rim) != 1


def _alignments(number: int) -> list[int]:
    """Rows, and columns, of the middles of alignment patterns."""
    if number == 1:
        return []
    count = number // 7 + 2
    step = (number * 4 + count * 2 + 1) // (count * 2 - 2) * 2
    size = 17 + 4 * number
    return [6, *sorted(size - 7 - index * step for index in range(count - 1))]


def _remainder(value: int, degree: int, divisor: int) -> int:
    """The check bits of a format or a version."""
    rest = value
    for _ in range(degree):
        rest = rest << 1 ^ (rest >> (degree - 1)) * divisor
    return rest


def _place(codewords: list[int], fixed: Modules, reserved: Modules) -> Modules:
    """The content in its winding columns, from the lower right corner on."""
    drawn = fixed.copy()
    size = len(drawn)
    bits = [bool(codeword >> bit & 1) for codeword in codewords for bit in range(7, -1, -1)]
    columns = [*range(size - 1, 6, -2), *range(5, 0, -2)]
    places = [
        (y, x)
        for turn, right in enumerate(columns)
        for y in (range(size - 1, -1, -1) if turn % 2 == 0 else range(size))
        for x in (right, right - 1)
        if not reserved[y, x]
    ]
    for (y, x), bit in zip(places, bits, strict=False):  # a few modules may be left over
        drawn[y, x] = bit
    return drawn


def _masked(drawn: Modules, reserved: Modules, mask: int) -> Modules:
    """With a mask, and the format that names it."""
    size = len(drawn)
    y, x = np.arange(size)[:, None], np.arange(size)[None, :]
    code = drawn ^ (_inverted(y, x)[mask] & ~reserved)
    value = _LEVEL_M << 3 | mask
    bits = (value << 10 | _remainder(value, 10, 0x537)) ^ 0x5412
    first = [(8, i) for i in range(6)] + [(8, 7), (8, 8), (7, 8)] + [(14 - i, 8) for i in range(9, 15)]
    second = [(size - 1 - i, 8) for i in range(8)] + [(8, size - 15 + i) for i in range(8, 15)]
    for places in (first, second):
        for bit, (at_x, at_y) in enumerate(places):
            code[at_y, at_x] = bool(bits >> bit & 1)
    code[size - 8, 8] = True
    return code


def _penalty(code: Modules) -> int:
    """How hard a code is to read, as the standard counts it."""
    found = 0
    finder = np.array([1, 0, 1, 1, 1, 0, 1], bool)
    light = np.zeros(4, bool)
    for lines in (code, code.T):
        for line in lines:
            edges = np.flatnonzero(np.diff(line)) + 1
            runs = np.diff(np.concatenate([[0], edges, [len(line)]]))
            found += int(sum(run - 2 for run in runs if run >= 5))
            windows = np.lib.stride_tricks.sliding_window_view(np.concatenate([light, line, light]), 11)
            for pattern in (np.concatenate([finder, light]), np.concatenate([light, finder])):
                found += 40 * int((windows == pattern).all(axis=1).sum())
    same = (
        (code[1:, 1:] == code[:-1, 1:]) & (code[1:, 1:] == code[1:, :-1]) & (code[1:, 1:] == code[:-1, :-1])
    )
    found += 3 * int(same.sum())
    return found + 10 * int(abs(code.mean() * 100 - 50) // 5)
