"""The texts of the pages in each language, and the choice of a language.

A language is a file ``<code>.json`` in this folder: a flat object of keys and texts. ``{name}`` in a text is
a parameter; a text that depends on the parameter ``count`` is an object of plural forms, named as in
`Intl.PluralRules`. Adding a file adds the language to every page.
"""

import json
import re
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from importlib.resources import files
from types import MappingProxyType
from typing import Final, final

DEFAULT: Final = "en"
COOKIE: Final = "latentarm_language"  # holds the language chosen under Settings
_MOST_CHARACTERS: Final = 200  # characters of an ``Accept-Language`` header that are read

_RANGE: Final = re.compile(
    r"\s*([a-z]{2,8})(?:-[a-z0-9-]*)?\s*(?:;\s*q=([01](?:\.\d{0,3})?)\s*)?", re.IGNORECASE
)


@final
@dataclass(frozen=True)
class Words:
    """The texts of one language."""

    language: str  # its code, as in ``<html lang>``
    # by key; a dictionary of plural forms where a text depends on a count
    texts: Mapping[str, str | Mapping[str, str]]

    @property
    def name(self) -> str:
        """The language's own name."""
        return self.say("language.name")

    def say(self, key: str, parameters: Mapping[str, str | int] = MappingProxyType({})) -> str:
        """A text; with a ``count`` of 1 the singular is taken where there is one.

        Raises KeyError if there is no such text, or it names other parameters.
        """
        text = self.texts[key]
        if not isinstance(text, str):
            text = text["one" if parameters.get("count") == 1 and "one" in text else "other"]
        return text.format_map(parameters)


@cache
def languages(package: str = "latentarm.web.words") -> dict[str, Words]:
    """Every language that a package has a file of, by its code, sorted; English fills the gaps."""
    texts = {
        file.name.removesuffix(".json"): json.loads(file.read_text(encoding="utf-8"))
        for file in files(package).iterdir()
        if file.name.endswith(".json")
    }
    return {code: Words(code, {**texts[DEFAULT], **own}) for code, own in sorted(texts.items())}


def chosen_language(cookie: str, accepted: str) -> Words:
    """The language of the `COOKIE` ("" for none), else of the ``Accept-Language`` header, else English."""
    known = languages()
    wanted = [cookie, *_wanted(accepted[:_MOST_CHARACTERS])]
    return known[next((code for code in wanted if code in known), DEFAULT)]


def _wanted(accepted: str) -> list[str]:
    found = [match for part in accepted.split(",") if (match := _RANGE.fullmatch(part))]
    by_weight = sorted(found, key=lambda match: -float(match[2] or 1.0))
    return [match[1].lower() for match in by_weight if float(match[2] or 1.0) > 0.0]
