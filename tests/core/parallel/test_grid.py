"""Cells here are of the standard library and NumPy: other processes must be able to import the function."""

import math
import os
import socket
import sys

import dask.config
import numpy as np
import pytest

from latentarm.core.errors import UserError
from latentarm.core.parallel import backends
from latentarm.core.parallel.backends import BACKENDS
from latentarm.core.parallel.grid import CellError, run_grid
from latentarm.runs.checks import check_seed

CELLS = [float(number) for number in range(7)]
ROOTS = [math.sqrt(cell) for cell in CELLS]
EVERYWHERE = [
    ("joblib", 1),
    ("joblib", 2),
    *(pytest.param(name, 2, marks=pytest.mark.slow) for name in ("dask", "ray")),
]


def grid(function, cells, backend="joblib", jobs=1, bars=False):
    return run_grid(function, cells, jobs=jobs, backend=backend, label=lambda cell: f"cell {cell}", bars=bars)


def free_port() -> int:
    with socket.socket() as one:
        one.bind(("127.0.0.1", 0))
        return one.getsockname()[1]


@pytest.mark.parametrize("jobs", [1, 2])
def test_results_come_in_the_order_of_the_cells(jobs):
    assert grid(math.sqrt, CELLS, jobs=jobs) == ROOTS


@pytest.mark.parametrize(("backend", "jobs"), EVERYWHERE)
def test_the_cell_that_fails_is_named(backend, jobs):
    with pytest.raises(CellError, match=r"cell -1\.0 failed[\s\S]*ValueError: math domain error"):
        grid(math.sqrt, [4.0, -1.0, 9.0], backend, jobs)


@pytest.mark.parametrize("jobs", [1, 2])
def test_what_the_user_can_mend_stays_so_and_names_the_cell(jobs):
    with pytest.raises(UserError, match=r"^cell -3: The seed is -3"):
        grid(check_seed, [1, -3], jobs=jobs)


@pytest.mark.parametrize("jobs", [1, 2])
def test_warnings_are_given_again_with_the_cell(jobs):
    with pytest.warns(RuntimeWarning, match=r"^cell -1\.0: invalid value") as caught:
        first, second = grid(np.log, [np.float64(1.0), np.float64(-1.0)], jobs=jobs)
    assert len(caught) == 1
    assert first == 0.0
    assert np.isnan(second)


def test_a_killed_process_is_said():
    with pytest.raises(UserError, match=r"killed.*--jobs"):
        grid(os._exit, [3], jobs=2)


def test_no_cells():
    assert grid(math.sqrt, [], jobs=2) == []


def test_all_cores():
    assert grid(math.sqrt, [4.0], jobs=-1) == [2.0]


def test_the_bar_stays_off_standard_output(capsys):
    grid(math.sqrt, [4.0, 9.0], bars=True)
    assert capsys.readouterr().out == ""


@pytest.mark.parametrize("jobs", [0, -2])
def test_no_such_number_of_jobs(jobs):
    with pytest.raises(UserError, match=f"jobs is {jobs}"):
        grid(math.sqrt, [4.0], jobs=jobs)


def test_no_such_backend():
    with pytest.raises(UserError, match="no backend 'slurm': choose from joblib, ray, dask"):
        grid(math.sqrt, [4.0], "slurm")


@pytest.mark.parametrize("backend", ["ray", "dask"])
def test_a_missing_extra_is_named(backend, monkeypatch):
    monkeypatch.setitem(sys.modules, backend, None)
    monkeypatch.delitem(sys.modules, f"{backend}.config", raising=False)
    with pytest.raises(UserError, match=r"pip install 'latentarm\[cluster\]'"):
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
