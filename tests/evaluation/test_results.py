import json

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from latentarm.core.types import Row
from latentarm.evaluation.results import as_document
from latentarm.evaluation.summary import Subject, summarise
from latentarm.runs.results_folder import write_json

number = st.none() | st.floats(allow_nan=False, allow_infinity=False)
text = st.none() | st.text(max_size=8)
row = st.builds(
    Row,
    study=st.text(max_size=8),
    measure=st.text(max_size=8),
    unit=st.text(max_size=4),
    mean=number,
    sd=number,
    n=st.integers(0, 1000),
    task=text,
    model=text,
    condition=text,
    paper_mean=number,
    paper_sd=number,
)


@given(rows=st.lists(row, max_size=5))
def test_what_is_written_is_read_again(rows, tmp_path_factory):
    path = tmp_path_factory.mktemp("results") / "metrics.json"
    write_json(path, as_document(rows, about={"seed": 1}))
    assert [Row(**entry) for entry in json.loads(path.read_text())["rows"]] == rows


def test_a_row_has_all_the_fields_that_machines_read():
    (entry,) = as_document([summarise(Subject("evaluate"), "drift", [0.1, 0.3])])["rows"]
    names = "study task model condition measure unit mean sd n paper_mean paper_sd"
    assert sorted(entry) == sorted(names.split())
    assert entry["model"] is None


def test_runs_without_a_figure_are_not_counted():
    some = summarise(Subject("s"), "disentanglement_deg", [80.0, np.nan, 84.0])
    assert (some.mean, some.n) == (82.0, 2)
    one = summarise(Subject("s"), "r2_axis_0", [0.9])
    assert (one.mean, one.sd, one.unit) == (0.9, None, "1")
    none = summarise(Subject("s"), "drift", [np.nan])
    assert (none.mean, none.sd, none.n) == (None, None, 0)


def test_a_figure_that_is_no_number_leaves_no_file(tmp_path):
    with pytest.raises(ValueError):
        write_json(tmp_path / "metrics.json", as_document([Row("s", "drift", "1", float("nan"), None, 1)]))
    assert list(tmp_path.iterdir()) == []
