"""Catalogues of things by name: our own, and those that other distributions register as entry points.

A distribution adds a model, an arm, a task or a belief with a few lines in its ``pyproject.toml``::

    [project.entry-points."latentarm.models"]
    theirs = "their_package.module:Theirs"

Nothing is imported before its name is looked up. A name from a file is only compared with registered names,
so a file cannot make us import a module.
"""

import re
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property
from importlib.metadata import EntryPoint, entry_points
from pkgutil import resolve_name
from typing import Final, Generic, TypeVar, final
from warnings import warn

from latentarm.core.errors import UserError

NAME: Final = re.compile(r"[a-z][a-z0-9_]{0,39}")
"""A plug-in's name becomes a command line choice, a file's entry and a figure's label."""


DISTRIBUTION: Final = re.compile(r"[A-Za-z0-9]([A-Za-z0-9._-]{0,98}[A-Za-z0-9])?")

T = TypeVar("T")
R = TypeVar("R")


class PluginWarning(UserWarning):
    """A registered plug-in cannot be used; everything else can."""


@final
@dataclass(frozen=True)
class Origin:
    """The distribution that registered a plug-in."""

    distribution: str
    version: str

    def __str__(self) -> str:
        return f"{self.distribution} {self.version}"


@final
class Catalogue(Mapping[str, T], Generic[T]):
    """Things of one family by name: our own in their order, then plug-ins by name.

    Listing names imports nothing; looking one up imports what it names, once.

    Args:
        group: of entry points, such as ``latentarm.models``.
        noun: the word for one of them in messages, such as ``model``
        own: this project's, each as ``package.module:attribute``
        check: makes the family's object of an import; raises TypeError or ValueError, with a reason, for
            anything else
    """

    def __init__(
        self, group: str, noun: str, own: Mapping[str, str], check: Callable[[str, object], T]
    ) -> None:
        self._group, self._noun, self._own, self._check = group, noun, dict(own), check
        self._loaded: dict[str, T] = {}

    def __getitem__(self, name: str) -> T:
        """The thing of that name.

        Raises:
            UserError: it is a plug-in that does not load, or whose name two distributions claim.
            KeyError: nobody registered that name.
        """
        if name not in self._loaded:
            self._loaded[name] = self._load(name)
        return self._loaded[name]

    def __iter__(self) -> Iterator[str]:
        yield from self._own
        yield from self._plugins

    def __len__(self) -> int:
        return len(self._own) + len(self._plugins)

    def __contains__(self, name: object) -> bool:
        return name in self._own or name in self._plugins

    def find(self, name: str, where: str, origin: str | None = None) -> T:
        """The thing that a file or a person names.

        ``where`` is the file and field, or the option. ``origin`` is the distribution that it came from when
        the file was written, if known.
        """
        if name in self:
            return self[name]
        if origin and DISTRIBUTION.fullmatch(origin):
            raise UserError(
                f"{where} names the {self._noun} '{name}' of the distribution {origin}, which is not"
                f" installed here: install it (pip install {origin})."
            )
        raise UserError(f"{where} names the {self._noun} '{name}', which is not one of {', '.join(self)}.")

    def usable(self) -> dict[str, T]:
        """Everything that loads, by name, with a `PluginWarning` for each plug-in that does not."""
        found: dict[str, T] = {}
        for name in self:
            try:
                found[name] = self[name]
            except UserError as error:
                if name in self._own:
                    raise
                warn(PluginWarning(str(error)), stacklevel=2)
        return found

    def origin(self, name: str) -> Origin | None:
        """The distribution that registered a name; None for our own."""
        return _origin(self._plugins[name][0]) if name in self._plugins else None

    def running(self, name: str, act: Callable[[], R]) -> R:
        """Run code of a registered thing; if a plug-in's code fails, name its distribution."""
        if name in self._own:
            return act()
        try:
            return act()
        # A plug-in's code runs here, and may fail in any way.
        except Exception as error:
            reason = " ".join(f"{type(error).__name__}: {error}".split())
            raise UserError(
                f"The {self._noun} '{name}' of the distribution {self.origin(name)} does not load ({reason}):"
                " update or uninstall that distribution."
            ) from error

    @cached_property
    def _plugins(self) -> dict[str, list[EntryPoint]]:
        """Registered entry points by name; more than one where distributions clash."""
        found: dict[str, list[EntryPoint]] = {}
        for entry in sorted(entry_points(group=self._group), key=lambda entry: entry.name):
            origin = _origin(entry)
            if entry.name in self._own:
                self._refuse(entry.name, origin, "latentarm already has one of that name")
            elif not NAME.fullmatch(entry.name):
                self._refuse(entry.name, origin, "a name has lower-case letters, digits and underscores only")
            elif entry not in found.setdefault(entry.name, []):
                found[entry.name].append(entry)
        return found

    def _refuse(self, name: str, origin: Origin, reason: str) -> None:
        said = f"The {self._noun} {name!r} of the distribution {origin} is left out: {reason}."
        warn(PluginWarning(said), stacklevel=3)

    def _load(self, name: str) -> T:
        if name in self._own:
            return self._check(name, resolve_name(self._own[name]))
        first, *others = self._plugins[name]
        if others:
            claims = " and ".join(str(_origin(entry)) for entry in (first, *others))
            raise UserError(
                f"The distributions {claims} both register a {self._noun} '{name}': uninstall all but one."
            )
        return self.running(name, lambda: self._check(name, first.load()))


def _origin(entry: EntryPoint) -> Origin:
    found = entry.dist
    return Origin("unknown", "") if found is None else Origin(found.name, found.version)
