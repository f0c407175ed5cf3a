"""What every study does alike, on a study that takes no time; the folder is tested in `test_studies`."""

import json
from dataclasses import dataclass, replace
from pathlib import Path

import pytest

from latentarm.core.errors import UserError
from latentarm.core.figure_style import new_figure
from latentarm.core.parallel import CellError
from latentarm.core.types import Row
from latentarm_research.studies import page as printing
from latentarm_research.studies.page import HTML, PDF, print_page
from latentarm_research.studies.results_folder import CONFIG
from latentarm_research.studies.study import ALWAYS_MADE, Report, Request, Study, again, run_study
from latentarm_research.studies.tables import plain
from result_rows import rows_in

PAGE = (
    """# Tides & moons

Heights:

| sea | lake |
| --- | ---: |
| 1 | """
    + plain("<script> | a_b")
    + """ |

![tides, simulated](tides.png)
"""
)


@dataclass(frozen=True)
class Sizes:
    name: str
    heights: tuple[float, ...] = (1.0, 2.0)


def square(height):
    return height**2


def broken(height):
    raise ZeroDivisionError("no way")


def refused(height):
    raise UserError("There is no tide.")


def report(request, squares):
    rows = [Row("tides", "error", "1", value, None, 1, task=request.tasks[0]) for value in squares]
    return Report(rows, PAGE, {"tides": new_figure(40.0)}, documents={"seeds.json": squares})


def study_of(function=square):
    return Study(
        name="tides",
        command="reproduce tides",
        presets={"paper": Sizes("paper")},
        tasks=("sea", "lake"),
        simulated=("moons",),
        measure=lambda request, grid: grid.run(
            "Heights", function, request.preset.heights, lambda height: f"height {height:g}"
        ),
        report=report,
        figures=("tides", "ebb"),
        documents=("seeds.json",),
    )


STUDY = study_of()


def request(out: Path, **changes) -> Request:
    return replace(Request(out, Sizes("paper"), jobs=1, quiet=True), **changes)


def test_everything_is_written_and_says_what_it_depends_on(tmp_path):
    out = tmp_path / "new"
    done = run_study(STUDY, request(out))
    assert {path.name for path in out.iterdir()} == {CONFIG, *ALWAYS_MADE, "seeds.json", "tides.png"} - {PDF}
    assert rows_in(out / "results.json") == done.rows
    assert [row.mean for row in done.rows] == [1.0, 4.0]
    assert (out / "results.md").read_text() == PAGE
    page = (out / HTML).read_text()
    assert "<title>Tides &amp; moons</title>" in page
    assert "<caption>Heights:</caption>" in page
    assert "<figcaption>tides, simulated</figcaption>" in page
    assert "<script" not in page
    about = json.loads((out / "results.json").read_text())["about"]
    assert about == {
        "study": "tides",
        "preset": {"name": "paper", "heights": [1.0, 2.0]},
        "tasks": ["sea", "lake"],
        "seed": 0,
        "moons": "simulated",
    }
    assert {"backend", "jobs", "grid_s"} <= json.loads((out / "timings.json").read_text()).keys()


def test_a_page_is_printed_by_a_browser_or_says_why_not(tmp_path, monkeypatch):
    assert "no Chromium" in print_page(tmp_path / HTML, tmp_path / PDF)
    browser = tmp_path / "browser"
    browser.write_text(
        '#!/bin/sh\nfor one in "$@"; do case $one in --print-to-pdf=*) echo PDF > "${one#*=}";; esac; done\n'
    )
    browser.chmod(0o755)
    monkeypatch.setattr(printing, "find_browser", lambda: str(browser))
    assert print_page(tmp_path / HTML, tmp_path / PDF) == ""
    assert (tmp_path / PDF).read_text() == "PDF\n"
    browser.write_text("#!/bin/sh\nexit 1\n")
    assert "could not print" in print_page(tmp_path / HTML, tmp_path / PDF)


def test_the_command_does_the_same_again(tmp_path):
    one = request(tmp_path, tasks=("lake",), seed=3)
    assert again(STUDY, one) == "latentarm reproduce tides --preset paper --task lake --seed 3"


def test_an_earlier_run_makes_room_and_another_study_stays(tmp_path):
    run_study(STUDY, request(tmp_path))
    (tmp_path / "ebb.png").write_text("of the earlier run")
    (tmp_path / "notes.txt").write_text("mine")
    with pytest.raises(CellError, match=r"height 1[\s\S]*no way"):
        run_study(study_of(broken), request(tmp_path))
    assert {path.name for path in tmp_path.iterdir()} == {CONFIG, "notes.txt"}
    with pytest.raises(UserError, match=r"height 1: There is no tide\."):
        run_study(study_of(refused), request(tmp_path))
    with pytest.raises(UserError, match="not an earlier run of this command"):
        run_study(replace(STUDY, name="winds"), request(tmp_path))


@pytest.mark.parametrize("content", ["{}", "[]", "no JSON", '{"study": "another"}'])
def test_a_folder_of_something_else_is_left_alone(tmp_path, content):
    (tmp_path / CONFIG).write_text(content)
    with pytest.raises(UserError, match="not an earlier run of this command"):
        run_study(STUDY, request(tmp_path))
    assert [path.name for path in tmp_path.iterdir()] == [CONFIG]
    assert (tmp_path / CONFIG).read_text() == content


def test_a_file_is_no_folder(tmp_path):
    (tmp_path / "file").write_text("mine")
    for out in (tmp_path / "file", tmp_path / "file" / "under"):
        with pytest.raises(UserError, match="file"):
            run_study(STUDY, request(out))
    assert (tmp_path / "file").read_text() == "mine"


def test_a_disk_that_cannot_be_written_is_said_before_any_work(tmp_path, monkeypatch):
    def full(*_, **__):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr("latentarm.core.files.tempfile.mkstemp", full)
    with pytest.raises(UserError, match="No space left"):
        run_study(study_of(broken), request(tmp_path))


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        ({"tasks": ("sea", "pond")}, "pond.*sea, lake"),
        ({"tasks": ("sea", "sea")}, "twice"),
        ({"seed": -1}, "seed"),
        ({"jobs": 0}, "jobs"),
        ({"backend": "slurm"}, "slurm"),
    ],
)
def test_refused_before_anything_is_written(tmp_path, changes, said):
    with pytest.raises(UserError, match=said):
        run_study(STUDY, request(tmp_path / "run", **changes))
    assert not (tmp_path / "run").exists()
