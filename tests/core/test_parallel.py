"""Cells here are of the standard library and NumPy: other processes must be able to import the function."""

import math
import os

import numpy as np
import pytest

from latentarm.core.errors import UserError
from latentarm.core.parallel import CellError, run_grid
from latentarm.runs.checks import check_seed

CELLS = [float(number) for number in range(7)]


def grid(function, cells, jobs=1, bars=False):
    return run_grid(function, cells, jobs=jobs, label=lambda cell: f"cell {cell}", bars=bars)


@pytest.mark.parametrize("jobs", [1, 2])
def test_results_come_in_the_order_of_the_cells(jobs):
    assert grid(math.sqrt, CELLS, jobs=jobs) == [math.sqrt(cell) for cell in CELLS]


@pytest.mark.parametrize("jobs", [1, 2])
def test_the_cell_that_fails_is_named(jobs):
    with pytest.raises(CellError, match=r"cell -1\.0 failed[\s\S]*ValueError: math domain error"):
        grid(math.sqrt, [4.0, -1.0, 9.0], jobs=jobs)


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
