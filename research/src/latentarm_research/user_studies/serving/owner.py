"""The study that a database belongs to, and the one server that may use it."""

from collections.abc import Generator
from contextlib import contextmanager
from typing import Final, final

from sqlalchemy import Engine, func, select
from sqlalchemy.orm import Session

from latentarm.core.errors import UserError
from latentarm_research.user_studies.serving.tables import Study

_LOCK: Final = 44  # number of the lock in PostgreSQL that a server holds as long as it runs


@final
class Owner:
    """The owner of a database; ``named`` is the database in messages."""

    def __init__(self, engine: Engine, named: str) -> None:
        self._engine = engine
        self._named = named

    @contextmanager
    def alone(self) -> Generator[None]:
        """Keep other servers off the database; the lock of its folder does so for a file."""
        if self._engine.dialect.name == "sqlite":
            yield
            return
        with self._engine.connect() as connection:
            # A machine that is cut off keeps the lock for half a minute, not for two hours.
            connection.exec_driver_sql(
                "SET tcp_keepalives_idle = 15; SET tcp_keepalives_interval = 5; SET tcp_keepalives_count = 3"
            )
            free = connection.scalar(select(func.pg_try_advisory_lock(_LOCK)))
            connection.commit()  # the lock lasts as long as the connection
            if not free:
                raise UserError(
                    f"{self._named} is being served by another program: end that with Ctrl-C, or name"
                    " another database with --database."
                )
            yield

    def check(self, key: str) -> None:
        """Raise a `UserError` where the database belongs to another study than the one with this key."""
        with Session(self._engine) as session:
            owner = session.scalar(select(Study))
        if owner is not None and owner.key != key:
            raise UserError(
                f"{self._named} holds the study {owner.name} of another folder: name that folder, or another"
                " database with --database."
            )

    def note(self, key: str, name: str) -> None:
        """Note the study that the database belongs to."""
        with Session(self._engine) as session, session.begin():
            session.merge(Study(key=key, name=name))
