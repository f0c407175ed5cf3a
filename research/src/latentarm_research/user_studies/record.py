"""The flat record of one trial, the same for simulated and real people."""

from collections.abc import Callable, Mapping
from dataclasses import asdict, dataclass
from math import isfinite
from pathlib import Path
from typing import Any, TypeVar, cast, final

from latentarm.core.errors import UserError

Listed = TypeVar("Listed")


@final
@dataclass(frozen=True)
class Trial:
    """One trial of one person."""

    person: int  # their number
    condition: str  # name of the condition
    task: str  # what was to be done
    order: int  # place of the condition in the person's order, from 0
    trial: int  # number of the trial in this condition, from 0
    measures: Mapping[str, float]  # figures by name; what was not measured is absent

    def unlabelled(self) -> "UnlabelledTrial":
        """The same without anything that tells the condition."""
        return UnlabelledTrial(self.person, self.task, dict(self.measures))

    def as_json(self) -> dict[str, object]:
        """Plain mapping; figures that are not finite are None."""
        known = {name: value if isfinite(value) else None for name, value in self.measures.items()}
        return {**asdict(self), "measures": known}


@final
@dataclass(frozen=True)
class UnlabelledTrial:
    """A trial as exclusion rules see it: without condition, order and number."""

    person: int  # their number
    task: str  # what was to be done
    measures: Mapping[str, float]  # figures by name


def read_trial(entry: object, where: str) -> Trial:
    """A trial from JSON. Raises a `UserError` where a field is missing or is not what it should be."""
    if not isinstance(entry, dict):
        raise UserError(f"{where} is no trial: it must be an object.")
    fields = cast(dict[str, Any], entry)
    for name, kind in (("person", int), ("condition", str), ("task", str), ("order", int), ("trial", int)):
        if not isinstance(fields.get(name), kind) or isinstance(fields.get(name), bool):
            raise UserError(f"{where}: {name} must be {'a whole number' if kind is int else 'text'}.")
    measures = fields.get("measures")
    if not isinstance(measures, dict):
        raise UserError(f"{where}: measures must be an object.")
    known: dict[str, float] = {}
    for name, value in cast(dict[str, object], measures).items():
        if value is None:
            continue
        if isinstance(value, bool) or not isinstance(value, int | float) or not isfinite(value):
            raise UserError(f"{where}: the measure {name} must be a finite number or null.")
        known[name] = float(value)
    return Trial(
        fields["person"], fields["condition"], fields["task"], fields["order"], fields["trial"], known
    )


def read_listed(
    document: Mapping[str, object], name: str, path: Path, read: Callable[[object, str], Listed]
) -> tuple[Listed, ...]:
    """The list of that name in a document; ``read`` takes an entry and where it stands, for errors.

    Raises:
        UserError: there is no list, or an entry is not what it should be.
    """
    entries = document.get(name)
    if not isinstance(entries, list):
        raise UserError(f"{path} must hold a list of {name}.")
    listed = enumerate(cast(list[object], entries))
    return tuple(read(entry, f"{path}, {name.removesuffix('s')} {index}") for index, entry in listed)


def read_trials(document: Mapping[str, object], path: Path) -> tuple[Trial, ...]:
    """The trials of a document; see `read_listed`."""
    return read_listed(document, "trials", path, read_trial)
