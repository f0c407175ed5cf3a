"""The study that a database belongs to."""

from typing import final

from sqlalchemy import Engine, select
from sqlalchemy.orm import Session

from latentarm.core.errors import UserError
from latentarm_research.user_studies.serving.tables import Study


@final
class Owner:
    """The owner of a database; ``named`` is the database in messages."""

    def __init__(self, engine: Engine, named: str) -> None:
        self._engine = engine
        self._named = named

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
