"""Where the cells of a study run: processes of this machine, or a cluster of Ray or Dask, by joblib."""

import logging
import os
import socket
from collections.abc import Generator
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any, Final, cast

import joblib

from latentarm.core.errors import UserError
from latentarm.core.parallel import Backend, processes

if TYPE_CHECKING:
    from dask.distributed import Client

EXTRA: Final = "pip install 'latentarm-research[cluster]'"

ANSWER_S: Final = 10.0  # for a cluster to answer at its address


@contextmanager
def _ray(jobs: int) -> Generator[int]:
    """A Ray cluster at ``RAY_ADDRESS``, or a new one on this machine."""
    os.environ.setdefault("RAY_USAGE_STATS_ENABLED", "0")  # no usage statistics
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
            yield _at_most(jobs)
    finally:
        if started:
            ray.shutdown()


def _start_ray() -> None:
    """Join the cluster that the environment names, or else start one.

    Without an address Ray would look for a cluster on this machine, and wait for one that has ended.
    """
    import ray

    address = os.environ.get("RAY_ADDRESS", "local")
    if address.startswith("ray://"):
        raise UserError(
            f"RAY_ADDRESS is {address}: run on a machine of the cluster instead, with RAY_ADDRESS=host:port."
        )
    host, _, port = address.rpartition(":")
    try:
        if port.isdigit():  # and not "auto" or "local"
            # Ray itself would try for a quarter of an hour.
            socket.create_connection((host, int(port)), ANSWER_S).close()
        ray.init(address, include_dashboard=False, log_to_driver=False, logging_level=logging.ERROR)
    except OSError as error:
        raise UserError(
            f"The Ray cluster at {address} does not answer or does not let us in:"
            " see RAY_ADDRESS and RAY_AUTH_MODE."
        ) from error


@contextmanager
def _dask(jobs: int) -> Generator[int]:
    try:
        import dask.config
    except ImportError as error:
        raise UserError(f"Dask is not installed here: {EXTRA}.") from error
    address: str | None = dask.config.get("scheduler-address", None)
    processes = _dask_processes(jobs) if address is None else _dask_cluster(address)
    with processes as client, joblib.parallel_config("dask", client=client):
        yield _at_most(jobs)


@contextmanager
def _dask_processes(jobs: int) -> Generator["Client"]:
    from dask.distributed import Client, LocalCluster

    settings: dict[str, Any] = {"threads_per_worker": 1, "dashboard_address": None, "memory_limit": None}
    with (
        LocalCluster(n_workers=None if jobs == -1 else jobs, **settings) as cluster,
        Client(cluster) as client,
    ):
        yield client


@contextmanager
def _dask_cluster(address: str) -> Generator["Client"]:
    from dask.distributed import Client

    try:
        client = Client(address, timeout=ANSWER_S)
    except (OSError, ValueError) as error:
        raise UserError(f"No Dask scheduler answers at {address}: see DASK_SCHEDULER_ADDRESS.") from error
    with client:
        try:
            client.wait_for_workers(1, timeout=ANSWER_S)
        except TimeoutError as error:
            raise UserError(f"The Dask scheduler at {address} has no workers: start some.") from error
        yield client


def _at_most(jobs: int) -> int:
    cores = cast(int, joblib.effective_n_jobs(-1))
    return cores if jobs == -1 else min(jobs, cores)


BACKENDS: Final[dict[str, Backend]] = {"joblib": processes, "ray": _ray, "dask": _dask}


def check_backend(name: str) -> None:
    """Raise a UserError unless there is a backend of that name."""
    if name not in BACKENDS:
        raise UserError(f"There is no backend {name!r}: choose from {', '.join(BACKENDS)}.")
