"""A PostgreSQL server of a test's own."""

import os
import shutil
import socket
import subprocess
import tempfile
import time
from collections.abc import Generator
from contextlib import contextmanager
from pathlib import Path

import pytest


def _binaries() -> Path:
    """The folder of the newest server that Debian has installed, or that of the one on the path."""
    found = sorted(Path("/usr/lib/postgresql").glob("*/bin"), key=lambda path: int(path.parent.name))
    on_path = shutil.which("initdb")
    if not found and on_path is None:
        pytest.skip("postgres is not installed")
    return found[-1] if found else Path(str(on_path)).parent


@contextmanager
def postgres() -> Generator[str]:
    """The URL of an empty database on the loopback."""
    pytest.importorskip("psycopg", reason="psycopg is not installed")
    binaries = _binaries()
    # It does not run as root.
    other = ["runuser", "-u", "postgres", "--"] if os.getuid() == 0 else []
    folder = Path(tempfile.mkdtemp(prefix="postgres"))
    try:
        if other:
            shutil.chown(folder, "postgres")
        data = folder / "data"
        initialise = [binaries / "initdb", "-D", data, "-U", "postgres", "-A", "trust", "--no-sync"]
        subprocess.run([*other, *map(str, initialise)], check=True, capture_output=True, cwd=folder)
        with socket.create_server(("127.0.0.1", 0)) as free:
            port = free.getsockname()[1]
        serve = [binaries / "postgres", "-D", data, "-k", folder, "-p", port, "-h", "127.0.0.1"]
        with (folder.parent / f"{folder.name}.log").open("wb") as log:
            server = subprocess.Popen([*other, *map(str, serve)], cwd=folder, stdout=log, stderr=log)
        try:
            ready = [str(binaries / "pg_isready"), "-q", "-h", "127.0.0.1", "-p", str(port)]
            end_s = time.monotonic() + 30.0
            while subprocess.run(ready, check=False).returncode:
                assert time.monotonic() < end_s, "PostgreSQL does not answer"
                time.sleep(0.05)
            yield f"postgresql://postgres@127.0.0.1:{port}/postgres"
        finally:
            stop = [binaries / "pg_ctl", "stop", "-D", data, "-m", "immediate"]
            subprocess.run([*other, *map(str, stop)], check=False, capture_output=True, cwd=folder)
            server.wait(30)
    finally:
        shutil.rmtree(folder)
        (folder.parent / f"{folder.name}.log").unlink(missing_ok=True)
