"""The people who drive: a folder each, named by a random id and never by the name."""

import shutil
import threading
from collections.abc import Callable
from itertools import chain, count
from pathlib import Path
from typing import Annotated, Final, Literal, final

from pydantic import Field

from latentarm.core.errors import UserError
from latentarm.core.untrusted.names import MOST_CHARACTERS, clean_name, same_name
from latentarm.web.protocol.notice import Message, Notice, NoticeError
from latentarm.web.records.pin import PinHash, hash_of
from latentarm.web.records.record_files import (
    ID,
    disk_errors,
    new_id,
    read_record,
    stamp,
    unreadable,
    write_record,
)

VERSION: Final = 1
MOST_PEOPLE: Final = 500
MOST_SETTINGS: Final = 200
PERSON_NAME: Final = "person.json"
_STAGING: Final = ".adding-"

PersonId = Annotated[str, Field(pattern=rf"^{ID.pattern}$")]
SettingName = Annotated[str, Field(pattern=r"^[A-Za-z][A-Za-z0-9]{0,39}$")]
SettingText = Annotated[str, Field(max_length=80)]
MappedPad = dict[SettingName, float | Annotated[tuple[float | SettingText, ...], Field(max_length=64)]]
MappedPads = Annotated[dict[Annotated[str, Field(max_length=120)], MappedPad], Field(max_length=10)]
Settings = Annotated[
    dict[SettingName, bool | float | SettingText | MappedPads], Field(max_length=MOST_SETTINGS)
]
"""The page defines and checks them; the server only bounds them."""


class KeptProfile(Message):
    """A profile of a person, and the name of its run."""

    run: Annotated[str, Field(min_length=1, max_length=200)]
    name: Annotated[str, Field(min_length=1, max_length=64)]


class PersonRecord(Message):
    """A person."""

    version: Literal[1] = VERSION
    id: PersonId
    name: Annotated[str, Field(min_length=1, max_length=MOST_CHARACTERS)]  # in any script
    added: Annotated[str, Field(max_length=40)]  # ISO 8601 in UTC
    settings: Settings = Field(default_factory=dict)
    profiles: Annotated[tuple[KeptProfile, ...], Field(max_length=1000)] = ()
    pin: PinHash | None = None  # None for none


@final
class People:
    """Everybody's records; `find` and `all` do not wait for the disk.

    Other methods raise `UserError` if there is no such person, or files cannot be written or deleted.
    """

    def __init__(self, folder: Path) -> None:
        self._folder = folder
        self._lock = threading.Lock()
        self._people: dict[str, PersonRecord] = {}
        self.problems: list[Notice] = []  # of records that cannot be read, one each
        for unfinished in folder.glob(f"{_STAGING}*"):
            shutil.rmtree(unfinished, ignore_errors=True)
        for path in sorted(folder.glob(f"*/{PERSON_NAME}")):
            try:
                person = read_record(PersonRecord, path)
                if path.parent.name != person.id:
                    raise UserError(f"{path} is the record of another person than its folder says.")
                self._people[person.id] = person
            except UserError as error:
                self.problems.append(unreadable(error))

    def all(self) -> list[PersonRecord]:
        """Everybody, by name."""
        return sorted(self._people.values(), key=lambda person: (person.name.casefold(), person.id))

    def find(self, person: str | None) -> PersonRecord | None:
        """The person with an id; None for nobody."""
        return None if person is None else self._people.get(person)

    def known(self, person: str) -> PersonRecord:
        found = self._people.get(person)
        if found is None:
            raise NoticeError("person_unknown")
        return found

    def folder_of(self, person: str) -> Path:
        return self._folder / person

    def add(self, name: str, settings: Settings | None = None) -> PersonRecord:
        """Add a person. Raises UserError if the name is invalid or taken, or there are too many people."""
        with self._lock:
            if len(self._people) >= MOST_PEOPLE:
                raise NoticeError("too_many_people", count=MOST_PEOPLE)
            person = PersonRecord(
                id=new_id(), name=self._free_name(name, None), added=stamp(), settings=settings or {}
            )
            return self._keep(person)

    def adopt(self, brought: PersonRecord, fill: Callable[[Path, str], None]) -> PersonRecord:
        """Add an imported person under a new id, whole or not at all; a name that is taken gets a number.

        ``fill`` writes the rest into a folder, for the new id.
        """
        with self._lock:
            if len(self._people) >= MOST_PEOPLE:
                raise NoticeError("too_many_people", count=MOST_PEOPLE)
            names = chain([brought.name], (f"{brought.name[:34]} ({number})" for number in count(2)))
            name = next(clean for clean in map(_clean, names) if not self._taken(clean))
            person = brought.model_copy(update={"id": new_id(), "name": name, "pin": None})
            staging = self._folder / f"{_STAGING}{person.id}"
            try:
                with disk_errors(staging, "written"):
                    write_record(person, staging / PERSON_NAME)
                    fill(staging, person.id)
                    staging.replace(self.folder_of(person.id))
            finally:
                shutil.rmtree(staging, ignore_errors=True)
            self._people[person.id] = person
            return person

    def rename(self, person: str, name: str) -> PersonRecord:
        with self._lock:
            known = self.known(person)
            return self._keep(known.model_copy(update={"name": self._free_name(name, person)}))

    def keep_settings(self, person: str, settings: Settings) -> PersonRecord:
        with self._lock:
            return self._keep(self.known(person).model_copy(update={"settings": settings}))

    def keep_pin(self, person: str, pin: str | None) -> PersonRecord:
        """Set or remove a person's PIN."""
        kept = None if pin is None else hash_of(pin)
        with self._lock:
            return self._keep(self.known(person).model_copy(update={"pin": kept}))

    def add_profile(self, person: str, run: str, name: str) -> PersonRecord:
        with self._lock:
            known = self.known(person)
            profiles = dict.fromkeys([*known.profiles, KeptProfile(run=run, name=name)])
            return self._keep(known.model_copy(update={"profiles": tuple(profiles)}))

    def remove(self, person: str) -> None:
        """Delete a person's folder, with everything in it."""
        with self._lock:
            self.known(person)
            folder = self.folder_of(person)
            with disk_errors(folder, "deleted"):
                shutil.rmtree(folder)
            del self._people[person]

    def _keep(self, person: PersonRecord) -> PersonRecord:
        write_record(person, self.folder_of(person.id) / PERSON_NAME)
        self._people[person.id] = person
        return person

    def _free_name(self, name: str, of: str | None) -> str:
        clean = _clean(name)
        if self._taken(clean, of):
            raise NoticeError("person_name_taken", name=clean)
        return clean

    def _taken(self, name: str, of: str | None = None) -> bool:
        return any(same_name(name, other.name) for other in self._people.values() if other.id != of)


def _clean(name: str) -> str:
    try:
        return clean_name(name)
    except UserError as error:
        raise NoticeError("person_name_invalid", count=MOST_CHARACTERS) from error
