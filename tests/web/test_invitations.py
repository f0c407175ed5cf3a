"""Links for the next person, as QR codes that read as the link: in the terminal and on a page."""

import json

import numpy as np
import segno

from latentarm.web.server.invitations import Invitations, answer

EDGE = 4
"""Light modules that must be around a code."""

LINK = "http://192.168.1.20:8460/enter?key=" + "Zq3-_xK9" * 5 + "abc"


def dark_of(text):
    """The modules of a code without the light edge, by the library."""
    return np.array([list(row) for row in segno.make_qr(text).matrix_iter(border=0)], bool)


def test_a_terminal_shows_light_modules_with_an_edge_around():
    said = []
    Invitations(iter("a").__next__, "", said.append, True).draw(LINK)
    lines = said[0].split("\n")
    shown = [[half in "█▀" if upper else half in "█▄" for half in line] for line in lines for upper in (1, 0)]
    code = dark_of(LINK)
    light = np.array(shown)[: len(code) + 2 * EDGE]
    assert light[:EDGE].all()
    assert light[:, :EDGE].all()
    assert np.array_equal(~light[EDGE:-EDGE, EDGE:-EDGE], code)


def test_the_picture_of_a_page_has_the_same_modules():
    told = json.loads(answer("POST", True, lambda: LINK).body)
    dark = np.zeros((told["size"], told["size"]), bool)
    for module in told["path"].split("z")[:-1]:
        x, y = module.removeprefix("M").split("h")[0].split()
        dark[int(y), int(x)] = True
    assert np.array_equal(dark, np.pad(dark_of(LINK), EDGE))


def test_each_link_is_said_and_drawn_where_the_terminal_can():
    for draws in (True, False):
        said = []
        invitations = Invitations(iter("abc").__next__, "http://10.0.0.1:8460", said.append, draws)
        first = invitations.new_link()
        assert first == "http://10.0.0.1:8460/enter?key=a"
        assert said == []
        link = invitations.next()
        assert link.endswith("?key=b")
        assert link in said[0]
        assert len(said[1:]) == draws
