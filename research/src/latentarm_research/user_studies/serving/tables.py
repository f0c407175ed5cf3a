"""The tables of a study's database.

Neither addresses nor names of people are in it: a person is a random key, and a code of ours or the id that a
recruiting site gives them.
"""

from typing import Any

from sqlalchemy import JSON, ForeignKey
from sqlalchemy.orm import DeclarativeBase, Mapped, mapped_column


class Table(DeclarativeBase):
    """Base of all tables."""


class Study(Table):
    """The study whose database it is: one row."""

    __tablename__ = "study"

    key: Mapped[str] = mapped_column(primary_key=True)  # random; the study's folder has it too
    name: Mapped[str]


class Person(Table):
    """Somebody who has opened their link."""

    __tablename__ = "people"

    key: Mapped[str] = mapped_column(primary_key=True)  # random; a cookie of their browser has it
    link: Mapped[str] = mapped_column(unique=True)  # a code of ours, or the id of a recruiting site
    visit: Mapped[str]  # the latest at the recruiting site, by its name there; "" with a code of ours
    seen_s: Mapped[float]  # when they last opened a page of the study, s since 1970
    number: Mapped[int | None]  # of their place, also after it was given to somebody else; None before
    consent: Mapped[str | None]  # SHA-256 of the text; None before
    consented: Mapped[str | None]  # when, ISO 8601
    practised: Mapped[int] = mapped_column(default=0)  # conditions that they have practised
    completion: Mapped[str | None]  # code that they get once everything is saved; None before


class Server(Table):
    """A server of the study that runs."""

    __tablename__ = "servers"

    place: Mapped[str] = mapped_column(primary_key=True)  # its machine and folder
    address: Mapped[str]  # that people's browsers open
    seen_s: Mapped[float]  # when it last said that it runs, s since 1970
    arms: Mapped[int]  # how many people may drive there at the same time


class Stay(Table):
    """The server at which a person takes part."""

    __tablename__ = "stays"

    person: Mapped[str] = mapped_column(ForeignKey("people.key", ondelete="CASCADE"), primary_key=True)
    place: Mapped[str]  # of the server


class Place(Table):
    """A place in the study's design; its number decides the order of conditions."""

    __tablename__ = "places"

    number: Mapped[int] = mapped_column(primary_key=True)
    code: Mapped[str] = mapped_column(unique=True)  # of a link of ours; it opens whichever place is free
    person: Mapped[str | None] = mapped_column(ForeignKey("people.key", ondelete="SET NULL"), unique=True)


class DeviceCheck(Table):
    """A check of a person's device, each time."""

    __tablename__ = "device_checks"

    person: Mapped[str] = mapped_column(ForeignKey("people.key", ondelete="CASCADE"), primary_key=True)
    attempt: Mapped[int] = mapped_column(primary_key=True)
    passed: Mapped[bool]
    found: Mapped[dict[str, Any]] = mapped_column(JSON)  # a `Device`


class Drive(Table):
    """A finished drive."""

    __tablename__ = "drives"

    person: Mapped[str] = mapped_column(ForeignKey("people.key", ondelete="CASCADE"), primary_key=True)
    order: Mapped[int] = mapped_column(primary_key=True)
    task: Mapped[str] = mapped_column(primary_key=True)
    trial: Mapped[int] = mapped_column(primary_key=True)
    choice: Mapped[int] = mapped_column(primary_key=True)
    attempt: Mapped[int] = mapped_column(primary_key=True)
    number: Mapped[int]  # counts the drives of everybody, in the order in which they were saved
    record: Mapped[str]  # a `DriveRecord`, JSON


class Comprehension(Table):
    """The answers to the questions about the information, each time."""

    __tablename__ = "comprehension"

    person: Mapped[str] = mapped_column(ForeignKey("people.key", ondelete="CASCADE"), primary_key=True)
    attempt: Mapped[int] = mapped_column(primary_key=True)
    right: Mapped[bool]  # all of them
    options: Mapped[dict[str, str]] = mapped_column(JSON)  # number of an option by question


class Answers(Table):
    """The answers to the questionnaire after one condition, or to the comparison of all."""

    __tablename__ = "answers"

    person: Mapped[str] = mapped_column(ForeignKey("people.key", ondelete="CASCADE"), primary_key=True)
    order: Mapped[int] = mapped_column(primary_key=True)
    condition: Mapped[str]  # "" for a comparison
    points: Mapped[dict[str, int | str]] = mapped_column(
        JSON
    )  # by item; words, or a condition, where it asks so
