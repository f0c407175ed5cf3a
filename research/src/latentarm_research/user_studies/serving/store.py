"""The study's database, in a file or on a server: people and what is kept of them.

Every change is one transaction.
"""

import secrets
from collections.abc import Generator, Iterator, Mapping, Sequence
from contextlib import closing, contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final, final

from sqlalchemy import URL, delete, func, or_, select, update
from sqlalchemy.orm import Session
from sqlalchemy.sql import ColumnElement

from latentarm.core.errors import UserError
from latentarm_research.user_studies.answers.items import Answer
from latentarm_research.user_studies.drive_record import DriveRecord
from latentarm_research.user_studies.serving.database import open_database, shown
from latentarm_research.user_studies.serving.owner import Owner
from latentarm_research.user_studies.serving.servers import Servers
from latentarm_research.user_studies.serving.tables import (
    Answers,
    Comprehension,
    DeviceCheck,
    Drive,
    Person,
    Place,
    Stay,
)

KEY_BYTES: Final = 16  # of random keys


@final
@dataclass(frozen=True)
class Standing:
    """A person, and how far they have come. Nothing else about a person is stored."""

    key: str  # random; their steps are kept under it
    number: int | None  # of their place; None where they have none, any more or yet
    seen_s: float  # when they last opened a page of the study, s since 1970
    lapsed: bool  # whether their place went to somebody else, because they were away for too long
    consent: str  # SHA-256 of the text that they consented to; "" before
    consented: str  # when, ISO 8601; "" before
    device: Mapping[str, Any]  # what the latest check of it found, a `Device`; empty before
    device_passed: bool  # that check
    comprehension: tuple[bool, ...]  # of each try at its questions, whether all answers were right
    practised: int  # conditions that they have practised
    drives: tuple[DriveRecord, ...]  # in their order
    answered: frozenset[int]  # places in the order of the conditions after which they have answered
    answers: tuple[Answer, ...]  # in the order of the conditions
    completion: str | None  # their code, once everything is saved

    @property
    def finished(self) -> bool:
        """True once everything is saved."""
        return self.completion is not None

    @property
    def conditions(self) -> tuple[str, ...]:
        """Those of their trials so far, in order."""
        in_order = sorted(self.drives, key=lambda drive: drive.order)
        return tuple(dict.fromkeys(drive.condition for drive in in_order))


@final
@dataclass(frozen=True)
class Deleted:
    """A person who was deleted."""

    key: str
    link: str  # code of their link, or their id at a recruiting site
    next_code: str  # of the link in place of theirs, where it was one of ours


@final
class Store:
    """The database of a study. Raises a `UserError` where it is something else, or cannot be reached."""

    def __init__(
        self,
        database: Path | URL,
        away_s: float = float("inf"),  # a person who does nothing for so long loses their place, s
    ) -> None:
        self._away_s = away_s
        self._engine = open_database(database)
        self.owner = Owner(self._engine, shown(database))

    def servers(self, place: str, address: str, arms: int) -> Servers:
        """The servers of the study, of which this is one; see `Servers`."""
        return Servers(self._engine, place, address, arms)

    def present(self) -> tuple[set[str], list[str]]:
        """The keys of everybody, and the codes of the links to the places, in order."""
        with self._change() as session:
            codes = session.scalars(select(Place.code).order_by(Place.number))
            return set(session.scalars(select(Person.key))), list(codes)

    def open_places(self, count: int) -> list[str]:
        """Have so many places, with the numbers from 0, and codes for links to them, which it returns."""
        with self._change() as session:
            there = session.scalar(select(func.count()).select_from(Place)) or 0
            session.add_all(Place(number=one, code=_random()) for one in range(there, count))
            session.flush()
            return list(session.scalars(select(Place.code).order_by(Place.number)))

    def unused(self) -> str | None:
        """The first link code that nobody has used yet; None if all are used."""
        used = select(Person.link)
        with self._change() as session:
            free = select(Place.code).where(Place.code.not_in(used)).order_by(Place.number)
            return session.scalar(free.limit(1))

    def close(self) -> None:
        """Close the file."""
        self._engine.dispose()

    def arrive(self, link: str, visit: str, now_s: float) -> str | None:
        """The key of the person with this link, new or known.

        ``visit`` is what a recruiting site calls their visit, "" for a code of ours. None for a code that is
        unknown.
        """
        with self._change() as session:
            if not visit and session.scalar(select(Place).where(Place.code == link)) is None:
                return None
            person = session.scalar(select(Person).where(Person.link == link))
            if person is None:
                person = Person(key=_random(), link=link, visit=visit, seen_s=now_s)
                session.add(person)
            person.visit = visit
            return person.key

    def consent(self, key: str, digest: str, when: str) -> None:
        """Note that a person consents to a text."""
        with self._change() as session:
            if (person := session.get(Person, key)) is not None and person.consent is None:
                person.consent, person.consented = digest, when

    def keep_device(self, key: str, found: Mapping[str, Any], *, passed: bool) -> None:
        """Keep a check of a person's device."""
        with self._change() as session:
            if session.get(Person, key) is not None:
                count = select(func.count()).select_from(DeviceCheck).where(DeviceCheck.person == key)
                attempt = session.scalar(count) or 0
                session.add(DeviceCheck(person=key, attempt=attempt, passed=passed, found=dict(found)))

    def keep_comprehension(self, key: str, options: Mapping[str, str], *, right: bool) -> None:
        """Keep the answers to the questions about the information, unless all were right before."""
        with self._change() as session:
            if session.get(Person, key) is None or True in (before := _comprehension(session, key)):
                return
            session.add(Comprehension(person=key, attempt=len(before), right=right, options=dict(options)))

    def place(self, key: str, now_s: float) -> int | None:
        """Give a person the first free place, unless they have one; None where none is left.

        Places of people who were away for too long are free. Someone who has begun takes up no other place
        than their own. All of this is one transaction, so no place is given twice.
        """
        with self._change() as session:
            person = session.get(Person, key)
            if person is None:
                return None
            held = session.scalar(select(Place).where(Place.person == key))
            if held is not None:
                person.seen_s = now_s
                return held.number
            for gone in session.scalars(
                select(Place)
                .join(Person, Place.person == Person.key)
                .where(Person.seen_s < now_s - self._away_s, Person.completion.is_(None))
            ):
                gone.person = None
            free = select(Place).where(Place.person.is_(None)).order_by(Place.number).limit(1)
            if person.number is not None:
                free = free.where(Place.number == person.number)
            found = session.scalar(free)
            if found is None:
                return None
            session.flush()
            found.person, person.number, person.seen_s = key, found.number, now_s
            return found.number

    def practised(self, key: str, conditions: int) -> None:
        """Note that a person has practised so many conditions."""
        with self._change() as session:
            if (person := session.get(Person, key)) is not None:
                person.practised = max(person.practised, conditions)

    def keep_drive(self, key: str, record: DriveRecord) -> bool:
        """Keep a drive, unless it is there already. False if the person has withdrawn."""
        where = (key, record.order, record.task, record.trial, record.choice, record.attempt)
        with self._change() as session:
            if session.get(Person, key) is None:
                return False
            if session.get(Drive, where) is None:
                number = session.scalar(select(func.coalesce(func.max(Drive.number), 0))) or 0
                names = ("person", "order", "task", "trial", "choice", "attempt")
                given: dict[str, Any] = dict(zip(names, where, strict=True))
                session.add(Drive(**given, number=number + 1, record=record.model_dump_json()))
            return True

    def keep_answers(self, key: str, order: int, condition: str, answers: Mapping[str, int | str]) -> None:
        """Keep the answers after a condition; the first ones count."""
        with self._change() as session:
            if session.get(Person, key) is None or session.get(Answers, (key, order)) is not None:
                return
            session.add(Answers(person=key, order=order, condition=condition, points=dict(answers)))

    def finish(self, key: str, code: str) -> str:
        """Give a person their completion code, and return it; the first one stays."""
        with self._change() as session:
            if (person := session.get(Person, key)) is None:
                return ""
            person.completion = code = person.completion or code
            return code

    def withdraw(self, key: str) -> list[Deleted]:
        """Delete a person with everything about them; their place is free again. See `_delete`."""
        return self._delete(Person.key == key)

    def withdraw_by_code(self, code: str) -> list[Deleted]:
        """Delete the person with this code in their link or at the end, or id at a recruiting site.

        Raises a `UserError` where several have it, as everybody may get the same code at the end.
        """
        with self._change() as session:
            theirs = or_(Person.link == code, Person.completion == code)
            keys = list(session.scalars(select(Person.key).where(theirs)))
        if len(keys) > 1:
            raise UserError(f"{len(keys)} people have the code {code}: name that of a person's own link.")
        return self._delete(Person.key.in_(keys))

    def withdraw_unseen_since(self, when_s: float) -> list[Deleted]:
        """Delete everybody who was last there before a time, s since 1970."""
        return self._delete(Person.seen_s < when_s)

    def _delete(self, who: ColumnElement[bool]) -> list[Deleted]:
        """Delete people, so that no byte of theirs stays in the file; their links open nothing any more."""
        with self._change() as session:
            people = session.execute(select(Person.key, Person.link).where(who)).all()
            gone = [Deleted(key, link, _random()) for key, link in people]
            for one in gone:
                session.execute(update(Place).where(Place.code == one.link).values(code=one.next_code))
            session.execute(delete(Person).where(who))
        if gone and self._engine.dialect.name == "sqlite":
            # VACUUM rewrites the file: deleted rows can remain in the slack of the old pages.
            with closing(self._engine.raw_connection()) as connection:
                connection.cursor().execute("VACUUM")
        return gone

    def standing(self, key: str) -> Standing | None:
        """How far a person has come; None for nobody who is known."""
        with self._change() as session:
            person = session.get(Person, key)
            return None if person is None else _standing(session, person)

    def everything(self, key: str) -> dict[str, list[dict[str, Any]]]:
        """All rows about a person, as JSON, by table."""
        with self._change() as session:
            of = {
                Person: Person.key,
                Place: Place.person,
                Stay: Stay.person,
                DeviceCheck: DeviceCheck.person,
                Comprehension: Comprehension.person,
                Drive: Drive.person,
                Answers: Answers.person,
            }
            return {
                table.__tablename__: [
                    {column.name: getattr(row, column.name) for column in table.__table__.columns}
                    for row in session.scalars(select(table).where(whose == key))
                ]
                for table, whose in of.items()
            }

    def people(self) -> list[Standing]:
        """Everybody, by key."""
        with self._change() as session:
            return [_standing(session, one) for one in session.scalars(select(Person).order_by(Person.key))]

    @contextmanager
    def _change(self) -> Generator[Session]:
        """A transaction, which is on disk when the block ends."""
        with Session(self._engine) as session, session.begin():
            yield session


def _random() -> str:
    # No dash: at the beginning it would make the code an option of a command, or a formula.
    return secrets.token_hex(KEY_BYTES)


def _comprehension(session: Session, key: str) -> tuple[bool, ...]:
    theirs = select(Comprehension.right).where(Comprehension.person == key)
    return tuple(session.scalars(theirs.order_by(Comprehension.attempt)))


def _given(kept: Answers, drives: Sequence[DriveRecord]) -> Iterator[tuple[str, str, int | str]]:
    """Condition, item and answer; a comparison gives one for each condition that the person met."""
    for item, answer in kept.points.items():
        if kept.condition:
            yield kept.condition, item, answer
            continue
        for condition in dict.fromkeys(one.condition for one in drives):
            yield condition, item, "1" if condition == answer else "2"


def _standing(session: Session, person: Person) -> Standing:
    held = session.scalar(select(Place.number).where(Place.person == person.key))
    kept = session.scalars(select(Drive.record).where(Drive.person == person.key).order_by(Drive.number))
    checks = select(DeviceCheck).where(DeviceCheck.person == person.key)
    device = session.scalar(checks.order_by(DeviceCheck.attempt.desc()).limit(1))
    answers = session.scalars(
        select(Answers).where(Answers.person == person.key).order_by(Answers.order)
    ).all()
    try:
        drives = tuple(DriveRecord.model_validate_json(one) for one in kept)
    except ValueError as error:
        raise UserError("The study's database holds a drive that is not one.") from error
    return Standing(
        key=person.key,
        number=held,
        seen_s=person.seen_s,
        lapsed=person.number is not None and held is None,
        consent=person.consent or "",
        consented=person.consented or "",
        device={} if device is None else device.found,
        device_passed=device is not None and device.passed,
        comprehension=_comprehension(session, person.key),
        practised=person.practised,
        drives=drives,
        answered=frozenset(one.order for one in answers),
        answers=tuple(
            Answer(-1 if held is None else held, *given) for one in answers for given in _given(one, drives)
        ),
        completion=person.completion,
    )
