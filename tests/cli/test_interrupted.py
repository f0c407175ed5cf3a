"""Ctrl-C, which a terminal sends to every process of a command, at moments from its first import on."""

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

LOADING = [sys.executable, "-X", "importtime", "-m", "latentarm"]  # says on standard error what is imported

CHILD = """
import os, signal, sys, time
from pathlib import Path
from latentarm.core.child_processes import HANG_UPS, start_child

def work(path):
    Path(path).write_text("done")

if __name__ == "__main__":
    child = start_child(work, (sys.argv[1],), "work")
    for number in HANG_UPS:
        signal.signal(number, signal.SIG_IGN)
        os.killpg(0, number)
    try:
        os.killpg(0, signal.SIGINT)
        time.sleep(60.0)
    except KeyboardInterrupt:
        child.join()
        sys.exit(child.exitcode)
"""


def started(words, folder, heeded):
    """A process of its own terminal, for which Ctrl-C is ``heeded``, whatever it is for the tests."""

    def begin():
        signal.signal(signal.SIGINT, heeded)

    return subprocess.Popen(
        words,
        cwd=folder,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        start_new_session=True,
        preexec_fn=begin,
    )


@pytest.mark.parametrize(
    ("words", "module"),
    [
        ("arms list", "typing_extensions"),
        ("arms list", "docstring_parser"),
        ("arms list", "numpy"),
        ("arms check franka://10.0.0.2 --robot fr3", "mujoco._structs"),
        ("teleop --port 0", "uvicorn.server"),
    ],
)
def test_an_interrupted_import_ends_the_command_with_one_line(words, module, tmp_path):
    with started([*LOADING, *words.split()], tmp_path, signal.SIG_DFL) as process:
        for line in process.stderr:
            if line.split("|")[-1].strip() == module:
                break
        process.send_signal(signal.SIGINT)
        said = [line for line in process.stderr if not line.startswith("import time:")]
    # Python ends itself by the signal where it came in an exec() of a library: a shell calls both 130.
    assert process.returncode in (130, -signal.SIGINT)
    assert said == ["latentarm: interrupted.\n"]


def test_a_command_that_a_script_runs_in_the_background_ignores_it(tmp_path):
    with started([*LOADING, "arms", "list"], tmp_path, signal.SIG_IGN) as process:
        process.stderr.readline()
        process.send_signal(signal.SIGINT)
        said, _ = process.communicate(timeout=60)
    assert process.returncode == 0
    assert "franka" in said


def test_a_child_that_still_imports_is_left_to_its_parent(tmp_path):
    script = tmp_path / "parent.py"
    script.write_text(CHILD)
    with started([sys.executable, str(script), str(tmp_path / "file")], tmp_path, signal.SIG_DFL) as parent:
        said = parent.communicate(timeout=60)
    assert (parent.returncode, said) == (0, ("", ""))
    assert (tmp_path / "file").read_text() == "done"


def test_interrupting_while_the_process_of_the_arm_starts_leaves_no_process(tmp_path):
    words = [sys.executable, "-m", "latentarm", "teleop", "--port", "0"]
    with started(words, tmp_path, signal.SIG_DFL) as server:
        while not (children := _spawned_by(server.pid)):
            assert server.poll() is None
            time.sleep(0.01)
        os.killpg(server.pid, signal.SIGINT)
        said, errors = server.communicate(timeout=60)
    assert errors == "latentarm: interrupted.\n" or said.endswith("The page is closed.\n")
    assert "Traceback" not in errors
    assert not any(child.exists() for child in children)


def _spawned_by(parent: int) -> list[Path]:
    """Folders in /proc of children that are not multiprocessing's own."""
    numbers = Path(f"/proc/{parent}/task/{parent}/children").read_text().split()
    children = [Path("/proc") / number for number in numbers]
    return [child for child in children if b"spawn_main" in (child / "cmdline").read_bytes()]
