"""Slow work in a child: it reports, hears, fails in a sentence, and never outlives its parent."""

import os
import signal
import subprocess
import sys
import time
from pathlib import Path
from typing import Literal

from pydantic import TypeAdapter

from latentarm.core.errors import UserError
from latentarm.web.jobs.job import Job, Wire
from latentarm.web.protocol.notice import Message


class Number(Message):
    type: Literal["number"] = "number"
    value: int


NUMBERS = TypeAdapter(Number)


def double(wire: Wire, how_many: int) -> None:
    for _ in range(how_many):
        wire.say(Number(value=2 * wire.hear(NUMBERS).value))


def refuse(wire: Wire) -> None:
    raise UserError("There is nothing to do: bring something.")


def need_torch(wire: Wire) -> None:
    raise ModuleNotFoundError("No module named 'torch'", name="torch")


def sleep_on(wire: Wire, left_behind: str) -> None:
    try:
        wire.say(Number(value=os.getpid()))  # it may be ended as soon as this is heard
        time.sleep(60.0)
    finally:
        Path(left_behind).write_text("tidied up")


def until(what, within_s: float = 20.0):
    deadline_s = time.monotonic() + within_s
    while not (found := what()):
        assert time.monotonic() < deadline_s
        time.sleep(0.01)
    return found


def finished(job: Job) -> None:
    until(lambda: not job.alive)


def test_a_job_hears_and_says_and_then_is_done():
    job = Job(double, (2,), Number, "Doubling")
    try:
        assert job.heard() == [] or job.alive
        assert job.say(Number(value=3))
        assert job.say(Number(value=4))
        finished(job)
        assert [number.value for number in job.heard()] == [6, 8]
        assert job.heard() == []
        assert job.failure is None
        assert not job.say(Number(value=5))
    finally:
        job.end()


def test_an_error_of_the_user_arrives_as_its_sentence():
    job = Job(refuse, (), Number, "Nothing")
    finished(job)
    assert job.failure.text == "There is nothing to do: bring something."
    job.end()


def test_a_job_names_the_extra_that_it_lacks():
    job = Job(need_torch, (), Number, "Learning")
    finished(job)
    assert job.failure.text == "This needs torch, which is not installed: pip install 'latentarm[train]'."
    job.end()


def test_a_job_that_is_killed_has_broken_off_and_one_that_is_ended_has_not(tmp_path):
    left_behind = tmp_path / "note"
    for end in (True, False):
        job = Job(sleep_on, (str(left_behind),), Number, "Sleeping")
        pid = until(job.heard)[0].value
        if end:
            job.end()
            assert job.failure is None
            assert left_behind.read_text() == "tidied up"
        else:
            os.kill(pid, signal.SIGKILL)
            finished(job)
            assert job.failure.code == "work_broke_off"
            job.end()


def test_a_job_dies_with_its_parent(tmp_path):
    code = (
        "import sys, time; sys.path.insert(0, sys.argv[1]);"
        "import test_jobs as t;"
        "from latentarm.web.jobs.job import Job;"
        "job = Job(t.sleep_on, (sys.argv[2],), t.Number, 'Sleeping');"
        "print(t.until(job.heard)[0].value, flush=True); time.sleep(60)"
    )
    arguments = [sys.executable, "-c", code, str(Path(__file__).parent), str(tmp_path / "note")]
    parent = subprocess.Popen(arguments, stdout=subprocess.PIPE, text=True)
    assert parent.stdout is not None
    pid = int(parent.stdout.readline())
    parent.kill()
    parent.wait()
    parent.stdout.close()
    until(lambda: not Path(f"/proc/{pid}").exists() or "Z" in Path(f"/proc/{pid}/stat").read_text())
    assert (tmp_path / "note").read_text() == "tidied up"


def test_a_job_is_polite():
    job = Job(say_niceness, (), Number, "Asking")
    finished(job)
    assert [number.value for number in job.heard()] == [min(os.nice(0) + 10, 19), 1]
    job.end()


def say_niceness(wire: Wire) -> None:
    wire.say(Number(value=os.nice(0)))
    wire.say(Number(value=int(os.environ["OMP_NUM_THREADS"])))
