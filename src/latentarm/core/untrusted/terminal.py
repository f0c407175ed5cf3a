"""Text that this program may not have written, made safe to show in a terminal.

A file's name can hold escape sequences that recolour a terminal or write over earlier output, and characters
that reverse the text direction. They appear as escapes in Python's notation and have no effect.
"""

import unicodedata
from typing import Final

MOST_CHARACTERS: Final = 1000  # length of a message; both ends of a longer one are shown
_JOINERS: Final = "\u200c\u200d"  # invisible, but Persian and emoji are not written without them

_HIDDEN: Final = frozenset({"Cc", "Cf", "Cs", "Co", "Cn", "Zl", "Zp"})
"""Unicode's categories of controls, formats, halves of characters, private and unassigned ones, and ends
of lines."""


def visible(text: str) -> str:
    """The text with every control or invisible character escaped. Line breaks are kept."""
    if text.isascii() and text.isprintable():
        return text
    return "".join(character if _is_harmless(character) else _escaped(character) for character in text)


def one_line(sentence: str) -> str:
    """As `visible`, on one line of bounded length, for errors, which quote untrusted text."""
    line = visible(sentence).replace("\n", "\\n")
    if len(line) <= MOST_CHARACTERS:
        return line
    return f"{line[: MOST_CHARACTERS // 2]} … {line[-MOST_CHARACTERS // 2 :]}"


def _is_harmless(character: str) -> bool:
    return character in _JOINERS or character == "\n" or unicodedata.category(character) not in _HIDDEN


def _escaped(character: str) -> str:
    return character.encode("unicode_escape", "surrogatepass").decode("ascii")
