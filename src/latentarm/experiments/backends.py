"""Where the cells of a grid run: processes of this machine, or a cluster of machines.

joblib is the one interface; Ray and Dask are joblib's own backends. Each of the context managers here
makes its backend the active one and ends what it has started, and nothing else.
"""

import logging
import os
from collections.abc import Callable, Generator
from contextlib import AbstractContextManager, ExitStack, contextmanager
from typing import Any, Final, Literal, cast

import joblib

from latentarm.errors import UserError

BackendName = Literal["joblib", "ray", "dask"]

EXTRA: Final = "pip install 'latentarm[cluster]'"


@contextmanager
def _processes(jobs: int) -> Generator[int]:
    """Processes of this machine."""
    with joblib.parallel_config("loky"):
        yield _available(jobs)


@contextmanager
def _ray(jobs: int) -> Generator[int]:
    """A Ray cluster: that of ``RAY_ADDRESS``, one that runs on this machine, or a new one on it."""
    os.environ.setdefault("RAY_USAGE_STATS_ENABLED", "0")  # Ray would tell its makers that it was used
    try:
        import ray
        from ray.util.joblib import register_ray
    except ImportError as error:
        raise UserError(f"Ray is not installed here: {EXTRA}.") from error
    started = not ray.is_initialized()
    try:
        if started:
            _start_ray()
        register_ray()
        with joblib.parallel_config("ray"):
            # Ray's pool refuses to have more processes than the cluster has cores.
            yield _at_most(jobs, _available(-1))
    finally:
        if started:
            ray.shutdown()


def _start_ray() -> None:
    """Join the cluster that the environment names, or start one.

    Raises:
        UserError: the cluster does not answer.
    """
    import ray

    try:
        ray.init(include_dashboard=False, log_to_driver=False, logging_level=logging.ERROR)
    except ConnectionError as error:
        address = os.environ.get("RAY_ADDRESS", "this machine")
        raise UserError(f"No Ray cluster answers at {address}: see RAY_ADDRESS.") from error


@contextmanager
def _dask(jobs: int) -> Generator[int]:
    """A Dask cluster: that of ``DASK_SCHEDULER_ADDRESS``, or a new one of processes on this machine."""
    try:
        import dask.config
        from dask.distributed import Client, LocalCluster
    except ImportError as error:
        raise UserError(f"Dask is not installed here: {EXTRA}.") from error
    address: str | None = dask.config.get("scheduler-address", None)
    with ExitStack() as stack:
        if address is None:
            settings: dict[str, Any] = {
                "threads_per_worker": 1,
                "dashboard_address": None,
                "memory_limit": None,
            }
            cluster = LocalCluster(n_workers=None if jobs == -1 else jobs, **settings)
            client = stack.enter_context(Client(stack.enter_context(cluster)))
        else:
            try:
                client = stack.enter_context(Client(address))
            except (OSError, ValueError) as error:
                raise UserError(
                    f"No Dask scheduler answers at {address}: see DASK_SCHEDULER_ADDRESS."
                ) from error
        stack.enter_context(joblib.parallel_config("dask", client=client))
        yield _at_most(jobs, _available(-1))


def _available(jobs: int) -> int:
    """How many processes the active backend has for so many jobs."""
    return cast(int, joblib.effective_n_jobs(jobs))


def _at_most(jobs: int, cores: int) -> int:
    return cores if jobs == -1 else min(jobs, cores)


BACKENDS: Final[dict[str, Callable[[int], AbstractContextManager[int]]]] = {
    "joblib": _processes,
    "ray": _ray,
    "dask": _dask,
}
"""Each takes the processes wanted (-1: one per core) and yields how many there will be."""
