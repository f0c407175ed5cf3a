"""Cells here are of the standard library and NumPy: other processes must be able to import the function."""

import math
import socket
import sys

import dask.config
import pytest

from latentarm.core.errors import UserError
from latentarm.core.parallel import CellError, run_grid
from latentarm_research.studies import backends
from latentarm_research.studies.backends import BACKENDS, check_backend

CELLS = [float(number) for number in range(7)]
ROOTS = [math.sqrt(cell) for cell in CELLS]


def grid(function, cells, backend, jobs=1):
    where = BACKENDS[backend]
    return run_grid(function, cells, jobs=jobs, backend=where, label=lambda cell: f"cell {cell}", bars=False)


def free_port() -> int:
    with socket.socket() as one:
        one.bind(("127.0.0.1", 0))
        return one.getsockname()[1]


@pytest.mark.slow
@pytest.mark.parametrize("backend", ["dask", "ray"])
def test_the_cell_that_fails_is_named(backend):
    with pytest.raises(CellError, match=r"cell -1\.0 failed[\s\S]*ValueError: math domain error"):
        grid(math.sqrt, [4.0, -1.0, 9.0], backend, 2)


def test_no_such_backend():
    with pytest.raises(UserError, match="no backend 'slurm': choose from joblib, ray, dask"):
        check_backend("slurm")


@pytest.mark.parametrize("backend", ["ray", "dask"])
def test_a_missing_extra_is_named(backend, monkeypatch):
    monkeypatch.setitem(sys.modules, backend, None)
    monkeypatch.delitem(sys.modules, f"{backend}.config", raising=False)
    with pytest.raises(UserError, match=r"pip install 'latentarm-research\[cluster\]'"):
        grid(math.sqrt, [4.0], backend)


def test_a_ray_cluster_that_does_not_answer(monkeypatch):
    address = f"127.0.0.1:{free_port()}"
    monkeypatch.setenv("RAY_ADDRESS", address)
    with pytest.raises(UserError, match=rf"{address}.*RAY_ADDRESS"):
        grid(math.sqrt, [4.0], "ray")


def test_a_ray_address_of_another_kind(monkeypatch):
    monkeypatch.setenv("RAY_ADDRESS", "ray://head:10001")
    with pytest.raises(UserError, match="host:port"):
        grid(math.sqrt, [4.0], "ray")


def test_a_dask_cluster_that_does_not_answer(monkeypatch):
    monkeypatch.setattr(backends, "ANSWER_S", 0.5)
    address = f"tcp://127.0.0.1:{free_port()}"
    with dask.config.set({"scheduler-address": address}), pytest.raises(UserError, match=address):
        grid(math.sqrt, [4.0], "dask")


def test_a_dask_cluster_that_is_there_already_is_joined_and_left_alone():
    from dask.distributed import LocalCluster

    # Workers in this process: in processes of their own they would take seconds to start.
    how = {"n_workers": 2, "threads_per_worker": 1, "processes": False, "protocol": "tcp"}
    with (
        LocalCluster(**how, dashboard_address=None) as cluster,
        dask.config.set({"scheduler-address": cluster.scheduler_address}),
    ):
        assert grid(math.sqrt, [4.0, 9.0], "dask", jobs=1) == [2.0, 3.0]
        assert grid(math.sqrt, [4.0, 9.0], "dask", jobs=-1) == [2.0, 3.0]
        with pytest.raises(CellError, match=r"cell -1\.0 failed[\s\S]*ValueError: math domain error"):
            grid(math.sqrt, [4.0, -1.0, 9.0], "dask", jobs=2)


def test_a_dask_cluster_without_workers(monkeypatch):
    from dask.distributed import LocalCluster

    monkeypatch.setattr(backends, "ANSWER_S", 0.5)
    with (
        LocalCluster(n_workers=0, dashboard_address=None) as cluster,
        dask.config.set({"scheduler-address": cluster.scheduler_address}),
        pytest.raises(UserError, match="no workers"),
    ):
        grid(math.sqrt, [4.0], "dask")


@pytest.mark.parametrize(
    "backend",
    [pytest.param(name, marks=pytest.mark.slow) if name == "ray" else name for name in BACKENDS],
)
def test_a_backend_keeps_the_order_and_leaves_nothing_running(backend):
    import ray
    from dask.distributed import get_client

    assert grid(math.sqrt, CELLS, backend, jobs=2) == ROOTS
    assert not ray.is_initialized()
    with pytest.raises(ValueError, match="client"):
        get_client()
