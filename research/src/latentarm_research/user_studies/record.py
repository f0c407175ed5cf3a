"""The flat record of one trial, the same for simulated and real people."""

from collections.abc import Callable, Mapping
from dataclasses import asdict, dataclass
from math import isfinite
from pathlib import Path
from typing import Any, Literal, TypeVar, cast, final

from latentarm.core.errors import UserError

Listed = TypeVar("Listed")
PeopleAre = Literal["simulated", "real"]


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

    def as_json(self) -> dict[str, object]:
        """Plain mapping; figures that are not finite are None."""
        known = {name: value if isfinite(value) else None for name, value in self.measures.items()}
        return {**asdict(self), "measures": known}


def read_trial(entry: object, where: str) -> Trial:
    """A trial from JSON, whose measures that are null are absent.

    Raises a `UserError` where a field is missing or is not what it should be.
    """
    from latentarm_research.user_studies.own.records import read_record  # pydantic, which help does not need

    fields = cast(dict[str, Any], entry) if isinstance(entry, dict) else {}
    if isinstance(fields.get("measures"), dict):
        known = {name: value for name, value in fields["measures"].items() if value is not None}
        return read_record(Trial, {**fields, "measures": known}, where)
    return read_record(Trial, entry, where)


def read_listed(
    document: Mapping[str, object], name: str, path: Path, read: Callable[[object, str], Listed]
) -> tuple[Listed, ...]:
    """The list of that name in a document; ``read`` takes an entry and where it stands, for errors."""
    entries = document.get(name)
    if not isinstance(entries, list):
        raise UserError(f"{path} must hold a list of {name}.")
    listed = enumerate(cast(list[object], entries))
    return tuple(read(entry, f"{path}, {name.removesuffix('s')} {index}") for index, entry in listed)


def read_trials(document: Mapping[str, object], path: Path) -> tuple[Trial, ...]:
    """The trials of a document; see `read_listed`."""
    return read_listed(document, "trials", path, read_trial)
