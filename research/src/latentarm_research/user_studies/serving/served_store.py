"""Open the database of a study that was served from a folder."""

from collections.abc import Generator
from contextlib import contextmanager
from pathlib import Path

from latentarm.core.errors import UserError
from latentarm_research.user_studies.recorded import DATABASE, read_config
from latentarm_research.user_studies.serving.database import database_of
from latentarm_research.user_studies.serving.kept_options import read_kept
from latentarm_research.user_studies.serving.store import Store


@contextmanager
def served_store(folder: Path, database: str | None) -> Generator[Store]:
    """The database of the study in a folder; ``database`` is its URL, None for a file in the folder.

    Raises a `UserError` where no study was served from the folder, or the database is another study's.
    """
    read_config(folder)
    kept = read_kept(folder)
    if database is None:
        if kept is not None and kept.database is not None:
            raise UserError(f"This study is in PostgreSQL: name it with --database, such as {kept.database}.")
        if not (folder / DATABASE).exists():
            raise UserError(f"{folder} holds no study that was served.")
    store = Store(database_of(folder / DATABASE, database))
    try:
        if kept is not None:
            store.owner.check(kept.key)
        yield store
    finally:
        store.close()
