"""The servers that share a study's database, and the server of each person."""

from typing import Final, final

from sqlalchemy import Engine, delete, func, select
from sqlalchemy.orm import Session

from latentarm_research.user_studies.serving.tables import Person, Server, Stay

BEAT_S: Final = 2.0  # how often a server says that it runs, s
GONE_S: Final = 7.0  # one that has not said so for so long has gone, s
THERE_S: Final = 900.0  # people who have opened a page within this time count as present, s


@final
class Servers:
    """This server among all of the study.

    Args:
        engine: the study's database.
        place: the machine and the folder that this one serves from: it stays when the address changes.
        address: this server's own, which people's browsers open.
        arms: how many people may drive here at the same time.
    """

    def __init__(self, engine: Engine, place: str, address: str, arms: int) -> None:
        self._engine = engine
        self.address = address
        self._place, self._arms = place, arms

    def announce(self, now_s: float) -> None:
        """Record that this server is up, and remove those that are not."""
        with Session(self._engine) as session, session.begin():
            session.execute(delete(Server).where(Server.seen_s < now_s - GONE_S))
            session.merge(Server(place=self._place, address=self.address, seen_s=now_s, arms=self._arms))

    def leave(self) -> None:
        """Remove this server: its people go on at others."""
        with Session(self._engine) as session, session.begin():
            session.execute(delete(Server).where(Server.place == self._place))

    def elsewhere(self, key: str, now_s: float) -> str | None:
        """The address of a person's server; None for this one.

        A person stays at their server while it is up; otherwise they get the one with the most free arms.
        """
        with Session(self._engine) as session, session.begin():
            alive = select(Server).where(Server.seen_s >= now_s - GONE_S, Server.place != self._place)
            others = {one.place: one for one in session.scalars(alive)}
            stay = session.get(Stay, key)
            if stay is not None and stay.place == self._place:
                return None
            if stay is not None and stay.place in others:
                return others[stay.place].address
            there = (
                select(Stay.place, func.count())
                .join(Person, Stay.person == Person.key)
                .where(Person.seen_s > now_s - THERE_S, Person.completion.is_(None))
                .group_by(Stay.place)
            )
            people = {row[0]: row[1] for row in session.execute(there)}
            arms = {self._place: self._arms, **{place: one.arms for place, one in others.items()}}
            best = min(arms, key=lambda place: people.get(place, 0) / arms[place])  # itself among equals
            session.merge(Stay(person=key, place=best))
            return None if best == self._place else others[best].address
