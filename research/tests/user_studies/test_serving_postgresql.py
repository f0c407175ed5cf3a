"""A study in PostgreSQL: one study in a database, and refusals that say why."""

import sys
from collections.abc import Iterator
from pathlib import Path
from uuid import uuid4

import pytest
from sqlalchemy import make_url

from latentarm.cli import main
from latentarm.core.errors import UserError
from latentarm_research.user_studies.serving.database import postgresql
from latentarm_research.user_studies.serving.models import Models
from latentarm_research.user_studies.serving.store import Store
from postgres import postgres
from study_participant import CONTACT
from study_start import Starts

SECRET = "s3cret"  # noqa: S105 - nobody's


@pytest.fixture(scope="module")
def server() -> Iterator[str]:
    with postgres() as url:
        yield url


@pytest.fixture
def url(server: str) -> str:
    """An empty database of a test's own."""
    import psycopg
    from psycopg.sql import SQL, Identifier

    name = f"study{uuid4().hex}"
    with psycopg.connect(server, autocommit=True) as connection:
        connection.execute(SQL("CREATE DATABASE {}").format(Identifier(name)))
    return server.rpartition("/")[0] + f"/{name}"


@pytest.fixture
def start(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> Starts:
    return Starts(tmp_path, monkeypatch, capsys)


def test_a_start_without_the_database_goes_on_in_it(start: Starts, url: str) -> None:
    secret = make_url(url).set(password=SECRET).render_as_string(hide_password=False)
    assert start("--database", secret) == 0
    assert f"latentarm study analyse {start.out} --database {url}" in start.output
    sent = start.codes
    assert start() == 0
    assert f"As at the first start: with --contact {CONTACT}, with --database {url}." in start.output
    assert start.codes == sent
    assert not (start.out / "study.sqlite").exists()
    assert all(SECRET.encode() not in path.read_bytes() for path in start.out.rglob("*") if path.is_file())
    assert start("--database", f"{url}2") == 2
    assert f"began with --database {url}, and this start is with --database {url}2" in start.output


@pytest.mark.parametrize("command", ["analyse", "export", "replay", "delete"])
def test_commands_ask_for_the_database(start: Starts, url: str, command: str) -> None:
    assert start("--database", url) == 0
    options = ["--code", "x"] if command == "delete" else []
    assert main(["study", command, str(start.out), *options]) == 2
    assert f"This study is in PostgreSQL: name it with --database, such as {url}." in start.output


def test_a_database_serves_one_folder(start: Starts, url: str) -> None:
    assert start("--database", url) == 0
    start.out = start.folder / "others"
    assert start("--database", url) == 2
    assert "holds the study two_ways of another folder" in start.output
    assert not (start.out / "config.json").exists()
    # Nor do the commands for another study read it.
    assert start() == 0
    assert main(["study", "delete", str(start.out), "--code", "x", "--database", url]) == 2
    assert "of another folder" in start.output


def test_a_database_that_cannot_be_opened_says_why_before_models_are_trained(
    start: Starts, url: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(Models, "missing", lambda _: pytest.fail("models before the database"))
    right = make_url(url).set(password=SECRET)
    for wrong, why in (
        (right.set(database="none"), 'database "none" does not exist'),
        (right.set(username="nobody"), 'role "nobody" does not exist'),
        (right.set(port=1), "Connection refused"),
    ):
        assert start("--database", wrong.render_as_string(hide_password=False)) == 2
        refused = start.output
        assert f"cannot be opened: {why}. Check" in refused
        assert SECRET not in refused
        assert "PGPASSWORD" in refused
        assert not (start.out / "config.json").exists()


def test_a_missing_driver_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "psycopg", None)
    with pytest.raises(UserError, match="pip install"):
        Store(postgresql("postgresql://me@127.0.0.1/study"))


def test_a_wrong_url_is_refused_without_its_password() -> None:
    with pytest.raises(UserError, match="--database must be postgresql://") as refused:
        postgresql(f"postgresql://me:{SECRET}@host:port/study")
    assert SECRET not in str(refused.value)
