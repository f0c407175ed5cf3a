"""Names of people, in any script, in one form."""

import re
import unicodedata
from typing import Final

from latentarm.core.errors import UserError
from latentarm.core.untrusted.terminal import visible

MOST_CHARACTERS: Final = 40


def clean_name(text: str, most: int = MOST_CHARACTERS) -> str:
    """The name in composed form (NFC), with single spaces inside and none around it."""
    if len(text) > 4 * most:
        raise _too_long(most)
    name = " ".join(part for part in unicodedata.normalize("NFC", text).split(" ") if part)
    if len(name) > most:
        raise _too_long(most)
    if "\n" in name or visible(name) != name:
        raise UserError("The name holds characters that cannot be shown: type it without them.")
    if not any(unicodedata.category(character)[0] in "LNS" for character in name):
        raise UserError("The name has no letter: type a name.")
    return name


def same_name(one: str, other: str) -> bool:
    """Whether two names look the same to people: case and compatible forms of characters do not count."""
    return _folded(one) == _folded(other)


def file_words(name: str) -> str:
    """A name as part of a file's name on any system: letters and digits of any script, and hyphens."""
    kept = (one if unicodedata.category(one)[0] in "LMN" else "-" for one in name)
    return re.sub("-+", "-", "".join(kept)).strip("-") or "person"


def _folded(name: str) -> str:
    return unicodedata.normalize("NFKC", unicodedata.normalize("NFKC", name).casefold())


def _too_long(most: int) -> UserError:
    return UserError(f"The name is longer than {most} characters: type a shorter one.")
