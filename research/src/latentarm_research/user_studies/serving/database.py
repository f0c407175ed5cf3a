"""Locate and open a study's database: SQLite in a file, or PostgreSQL on a server."""

from pathlib import Path
from typing import Any, Final

from sqlalchemy import URL, Connection, Engine, create_engine, event, make_url
from sqlalchemy.exc import ArgumentError, DatabaseError

from latentarm.core.errors import UserError
from latentarm.core.untrusted.opening import check_file, is_missing
from latentarm_research.user_studies.serving.tables import Table

MOST_BYTES: Final = 1 << 32  # of a file

_LOCK: Final = 43  # number of the lock that transactions in PostgreSQL wait for


def database_of(path: Path, url: str | None) -> Path | URL:
    """The database of a study: its file, or the one at a URL of PostgreSQL."""
    return path if url is None else postgresql(url)


def postgresql(url: str) -> URL:
    """The database at a URL of PostgreSQL."""
    try:
        given = make_url(url)
    except (ArgumentError, ValueError) as error:
        # Not the URL: it may have a password.
        raise UserError("--database must be postgresql://USER@HOST:PORT/NAME.") from error
    if given.get_backend_name() != "postgresql":
        raise UserError(f"--database must begin with postgresql://, not {given.drivername}://.")
    return given.set(drivername="postgresql+psycopg")


def shown(database: Path | URL) -> str:
    """A database in words, without its password."""
    if isinstance(database, Path):
        return str(database)
    public = database.set(drivername="postgresql").difference_update_query(["password"])
    return public._replace(password=None).render_as_string()


def open_database(database: Path | URL) -> Engine:
    """Open a database, with all tables. Every transaction waits for the one before it."""
    engine = _at_url(database) if isinstance(database, URL) else _in_file(database)
    try:
        Table.metadata.create_all(engine)
    except DatabaseError as error:
        engine.dispose()
        named, reason = shown(database), _reason(error)
        if isinstance(database, Path):
            raise UserError(
                f"{named} is not the database of a study, or cannot be written: {reason}."
            ) from error
        raise UserError(
            f"{named} cannot be opened: {reason}. Check that the server runs and has this database, its"
            " address and port, and the password in ~/.pgpass or PGPASSWORD."
        ) from error
    return engine


def _reason(error: DatabaseError) -> str:
    """The driver's own reason; libpq gives one line for each address that it tries, with some before it."""
    lines = str(error.orig).strip().splitlines()
    line = next((one for one in reversed(lines) if "failed: " in one), lines[0])
    return line.rpartition("failed: ")[2].removeprefix("FATAL:").strip().rstrip(".")


def _in_file(path: Path) -> Engine:
    """SQLite."""
    if not is_missing(path):
        check_file(path, MOST_BYTES)
    engine = create_engine(f"sqlite:///{path}")
    event.listen(engine, "connect", _connected)
    event.listen(engine, "begin", _begins)
    return engine


def _at_url(url: URL) -> Engine:
    """PostgreSQL."""
    try:
        engine = create_engine(url)
    except ImportError as error:
        raise UserError('PostgreSQL needs psycopg: pip install "latentarm-research[postgresql]".') from error
    event.listen(engine, "begin", _waits_its_turn)
    return engine


def _waits_its_turn(connection: Connection) -> None:
    """Let one transaction run after the other, as SQLite does."""
    connection.exec_driver_sql(f"SELECT pg_advisory_xact_lock({_LOCK})")


def _begins(connection: Connection) -> None:
    connection.exec_driver_sql("BEGIN IMMEDIATE")


def _connected(connection: Any, _: object) -> None:
    """SQLAlchemy begins the transactions; what is deleted is overwritten on disk."""
    connection.isolation_level = None
    for pragma in ("foreign_keys=ON", "secure_delete=ON", "synchronous=FULL", "busy_timeout=10000"):
        connection.execute(f"PRAGMA {pragma}")
