"""Loading a run in a child process first, so that a broken one harms neither the arm nor the server.

Libraries in C read the files that a run names (Parquet, meshes). A malicious file could crash them or keep
them busy for ever. Only a run that the child has loaded in time is loaded by the server and the arm's
process.
"""

import asyncio
import time
from typing import Final

from latentarm.core.errors import UserError
from latentarm.core.untrusted.memory import bounded_memory
from latentarm.core.untrusted.terminal import one_line
from latentarm.web.arm_process.drive_setup import Spec, load_setup
from latentarm.web.jobs.job import Job, Wire
from latentarm.web.protocol.notice import Message, Notice, NoticeError
from latentarm.web.server.loaded_run import LoadedRun

WITHIN_S: Final = 60.0  # a run that takes longer to load is refused, s
_LOOK_S: Final = 0.05
_SIZE: Final = 64 << 20
"""Bytes that a run is assumed to have: those that its copy of a robot may have, see `bounded_memory`.

Each file has its own bound too. The meshes of an SO-101, 16 MB, take 1.7 GB for a moment while MuJoCo
reads them."""


async def why_not_drivable(spec: Spec, name: str) -> Notice | None:
    """Load a spec's run, called ``name`` on pages, in a child process; None if it can be driven."""
    job = Job(try_to_load, (spec, name), Message, "loading a run")
    until_s = time.monotonic() + WITHIN_S
    try:
        while job.alive:
            if time.monotonic() > until_s:
                return Notice(code="run_too_slow", parameters={"name": name, "seconds": round(WITHIN_S)})
            await asyncio.sleep(_LOOK_S)
        return job.failure
    finally:
        asyncio.get_running_loop().run_in_executor(None, job.end)


def try_to_load(wire: Wire, spec: Spec, name: str) -> None:
    """The child's work: load all that the other processes will load. Raises UserError as `load_setup`."""
    try:
        with bounded_memory(f"The run {name}", _SIZE):
            LoadedRun(load_setup(spec), name)
    except UserError:
        raise
    except Exception as error:
        raise NoticeError("not_loaded", text=one_line(repr(error))) from error
