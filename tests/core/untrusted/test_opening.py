"""Only regular files of bounded size are opened, and nothing waits for the rest."""

import os
import socket
import tempfile
from pathlib import Path

import pytest

from latentarm.core.errors import UserError
from latentarm.core.untrusted.opening import check_file, is_missing, opened, read_bytes


def test_reads_a_file(tmp_path: Path) -> None:
    (tmp_path / "file").write_bytes(b"abc")
    (tmp_path / "link").symlink_to("file")
    assert read_bytes(tmp_path / "file", 3) == read_bytes(tmp_path / "link", 3) == b"abc"


def test_refuses_what_is_no_file(tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "pipe")
    (tmp_path / "endless").symlink_to("/dev/zero")
    (tmp_path / "loop").symlink_to("loop")
    with tempfile.TemporaryDirectory() as short, socket.socket(socket.AF_UNIX) as listening:
        listening.bind(f"{short}/socket")
        for path, what in {
            tmp_path: "a folder",
            tmp_path / "pipe": "a named pipe",
            tmp_path / "endless": "a device",
            tmp_path / "loop": "Too many levels",
            tmp_path / "nowhere": "No such file",
            Path(short, "socket"): "a socket",
            tmp_path / "nul\0": "not a path",
            tmp_path / ("x" * 5000): "too long",
        }.items():
            with pytest.raises(UserError, match=what):
                read_bytes(path, 100)
            with pytest.raises(UserError, match=what):
                check_file(path, 100)


def test_refuses_a_pipe_that_takes_the_place_of_a_file(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "file").write_bytes(b"")
    os.mkfifo(tmp_path / "pipe")
    before = (tmp_path / "file").stat()
    monkeypatch.setattr(Path, "stat", lambda path: before)
    with pytest.raises(UserError, match="a named pipe"):
        read_bytes(tmp_path / "pipe", 100)


def test_bounds_the_size(tmp_path: Path) -> None:
    path = tmp_path / "file"
    path.write_bytes(b"12345")
    with pytest.raises(UserError, match="it has 5 bytes, and at most 4 bytes are read"):
        read_bytes(path, 4)
    with opened(path, 5) as stream:
        assert stream.read() == b"12345"


@pytest.mark.skipif(not Path("/proc/self/maps").exists(), reason="needs files that do not know their size")
def test_bounds_a_file_that_is_larger_than_it_says() -> None:
    with pytest.raises(UserError, match="too large"):
        read_bytes(Path("/proc/self/maps"), 10)


def test_errors_within_name_the_file(tmp_path: Path) -> None:
    (tmp_path / "file").write_bytes(b"")
    with pytest.raises(UserError, match="file cannot be read"), opened(tmp_path / "file", 5) as stream:
        stream.seek(-1)


def test_what_is_missing_is_told_from_what_cannot_be_read(tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "pipe")
    (tmp_path / "file").write_bytes(b"")
    assert is_missing(tmp_path / "nowhere")
    assert is_missing(tmp_path / "file" / "below")
    for name in ("pipe", "file", "x" * 5000, "nul\0"):
        assert not is_missing(tmp_path / name)
