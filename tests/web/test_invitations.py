"""Links for the next person, as QR codes that read as the link: in the terminal and on a page."""

import numpy as np
import pytest

from latentarm.errors import UserError
from latentarm.web.server.invitations import Invitations
from latentarm.web.server.qr_code import EDGE, MOST_BYTES, qr_code, svg_path, terminal_text

LINK = "http://192.168.1.20:8460/enter?key=" + "Zq3-_xK9" * 5 + "abc"


def content_of(code):
    """What a code says: format, mask, winding columns and blocks as the standard has them."""
    size = len(code)
    number = (size - 17) // 4
    bits = [int(code[8, x]) for x in (0, 1, 2, 3, 4, 5, 7, 8)] + [
        int(code[y, 8]) for y in (7, 5, 4, 3, 2, 1, 0)
    ]
    format_ = int("".join(map(str, bits)), 2) ^ 0b101010000010010
    assert format_ >> 13 == 0  # level M
    mask = format_ >> 10 & 7
    y, x = np.indices(code.shape)
    inverted = [
        (y + x) % 2, y % 2, x % 3, (y + x) % 3, (y // 2 + x // 3) % 2, y * x % 2 + y * x % 3,
        (y * x % 2 + y * x % 3) % 2, ((y + x) % 2 + y * x % 3) % 2,
    ][mask] == 0  # fmt: skip
    plain = code ^ inverted
    taken = np.zeros_like(code)
    taken[:9, :9] = taken[:9, -8:] = taken[-8:, :9] = taken[6] = taken[:, 6] = True
    if number > 1:  # up to 6 there is one alignment pattern
        assert number < 7
        taken[size - 9 : size - 4, size - 9 : size - 4] = True
    read, upwards = [], True
    for right in [*range(size - 1, 6, -2), 5, 3, 1]:
        rows = range(size - 1, -1, -1) if upwards else range(size)
        read += [
            plain[row, column] for row in rows for column in (right, right - 1) if not taken[row, column]
        ]
        upwards = not upwards
    codewords = np.packbits(np.array(read[: len(read) // 8 * 8])).tolist()
    blocks, checks = {1: (1, 10), 2: (1, 16), 3: (1, 26), 4: (2, 18), 5: (2, 24), 6: (4, 16)}[number]
    room = len(codewords) - blocks * checks
    assert room % blocks == 0
    data = [codewords[at] for block in range(blocks) for at in range(block, room, blocks)]
    stream = "".join(f"{codeword:08b}" for codeword in data)
    assert stream[:4] == "0100"
    length = int(stream[4:12], 2)
    return bytes(int(stream[12 + 8 * at : 20 + 8 * at], 2) for at in range(length)).decode()


@pytest.mark.parametrize("text", ["a", "http://a.b/", LINK, LINK[:62], "Zoë 名"])
def test_a_code_reads_as_its_link(text):
    assert content_of(qr_code(text)) == text


def test_a_code_is_the_one_that_another_program_makes():
    # Rows of the code that qrcode 8.2 makes, with the same mask: error correction and all.
    rows = """1fcd7f 104c41 17565d 17585d 17595d 105641 1fd57f 1000 17c67c 1c1b3f c6186 123f1c f159 19fd
        1fc666 10509f 175e59 175934 175d64 104234 1fd27a"""
    expected = [[bool(int(row, 16) >> (20 - x) & 1) for x in range(21)] for row in rows.split()]
    assert qr_code("http://a.b/").tolist() == expected


def test_a_text_that_is_too_long_is_said():
    assert len(qr_code("a" * MOST_BYTES)) == 73
    with pytest.raises(UserError, match="362 fit"):
        qr_code("a" * (MOST_BYTES + 1))


def test_a_terminal_shows_light_modules_with_an_edge_around():
    code = qr_code(LINK)
    lines = terminal_text(code).split("\n")
    shown = [[half in "█▀" if upper else half in "█▄" for half in line] for line in lines for upper in (1, 0)]
    light = np.array(shown)[: len(code) + 2 * EDGE]
    assert light[:EDGE].all()
    assert light[:, :EDGE].all()
    assert content_of(~light[EDGE:-EDGE, EDGE:-EDGE]) == LINK


def test_the_picture_of_a_page_has_the_same_modules():
    code = qr_code(LINK)
    dark = np.zeros_like(code)
    for module in svg_path(code).split("z")[:-1]:
        x, y = module.removeprefix("M").split("h")[0].split()
        dark[int(y) - EDGE, int(x) - EDGE] = True
    assert np.array_equal(dark, code)


def test_each_link_is_said_and_drawn_where_the_terminal_can():
    for draws in (True, False):
        said = []
        invitations = Invitations(iter("abc").__next__, "http://10.0.0.1:8460", said.append, draws)
        first = invitations.first()
        assert first == "http://10.0.0.1:8460/enter?key=a"
        assert said == []
        link = invitations.next()
        assert link.endswith("?key=b")
        assert link in said[0]
        assert said[1:] == ([terminal_text(qr_code(link))] if draws else [])
