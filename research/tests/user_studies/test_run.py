"""Simulated people go through a study: a tiny one from end to end in physics, and all five at smoke sizes."""

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from latentarm.core.errors import UserError
from latentarm_research.user_studies.catalogue import NAMES, load_definition
from latentarm_research.user_studies.definition import Definition
from latentarm_research.user_studies.folder import DOCUMENTS, claim, read_trials, write_documents
from latentarm_research.user_studies.report import report
from latentarm_research.user_studies.report.figures import figure_names
from latentarm_research.user_studies.report.report import PAGE, PDF, report_files, write_report
from latentarm_research.user_studies.run import Request, send_people
from latentarm_research.user_studies.session import choices_of, in_the_end, together
from latentarm_research.user_studies.sizes import PRESETS, Sizes

TINY = Sizes("tiny", trial_s=0.1, most_trials=1)
HARMONIC = load_definition("harmonic")
ASSISTED = ("No Assist", "High Assist")


def without_models(definition: Definition) -> Definition:
    """HARMONIC's own conditions, which need no training."""
    kept = tuple(one for one in definition.conditions if one.name in ASSISTED)
    return replace(definition, conditions=kept, hypotheses=(), printed=())


def test_simulated_people_go_through_a_study_and_a_report_says_that_they_are(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(report, "find_browser", lambda: None)
    definition, out = without_models(HARMONIC), tmp_path / "study"
    request = Request(definition, TINY, 2, out, jobs=1, quiet=True)
    claim(request, report_files(definition))
    ran = send_people(request)
    assert [(one.person, one.order) for one in ran.trials] == [(0, 0), (0, 1), (1, 0), (1, 1)]
    assert {one.condition for one in ran.trials if one.person == 0} == set(ASSISTED)
    # The same person meets the same scene in every condition.
    starts = {one.condition: one.position[0] for one in ran.traces if one.person == 0}
    assert starts["No Assist"] == starts["High Assist"]
    rows = write_documents(request, ran)
    assert "Chromium" in write_report(out, ran, rows, "latentarm study run harmonic")
    assert {one.name for one in out.iterdir()} >= {*DOCUMENTS, PAGE}
    assert not (out / PDF).exists()
    page = (out / PAGE).read_text(encoding="utf-8")
    captions = [line for line in page.splitlines() if "<caption>" in line or "<figcaption>" in line]
    assert len(captions) > 6
    assert all("simulated people" in line for line in captions)
    assert definition.digest in page
    analysis = json.loads((out / "analysis.json").read_text())
    assert (analysis["definition"], analysis["people_are"]) == (definition.digest, "simulated")


def test_a_request_for_too_few_people_or_another_folder_is_refused(tmp_path: Path) -> None:
    with pytest.raises(UserError, match="2 people or more"):
        Request(HARMONIC, TINY, 1, tmp_path)
    (tmp_path / "mine.txt").write_text("keep")
    with pytest.raises(UserError, match="choose another folder"):
        claim(Request(HARMONIC, TINY, 2, tmp_path), ())
    with pytest.raises(UserError, match=r"config\.json"):
        read_trials(tmp_path)


def test_people_begin_with_different_choices_and_a_whole_takes_all() -> None:
    (task,) = HARMONIC.tasks
    assert [choices_of(task, 1, number) for number in range(4)] == [(1,), (2,), (0,), (1,)]
    whole = load_definition("apple_pie").tasks[1]
    assert choices_of(whole, 5, 0) == (0, 1, 2)


def test_figures_of_several_drives_are_sums_and_means() -> None:
    drives = [
        {"time_s": 10.0, "success_rate": 1.0, "steps_done": 1.0, "preference_alignment": 1.0},
        {"time_s": 30.0, "success_rate": 0.0, "steps_done": 0.5, "preference_alignment": 0.0},
    ]
    assert together(drives) == {
        "time_s": 40.0,
        "success_rate": 0.0,
        "steps_done": 0.75,
        "preference_alignment": 0.25,
    }


def test_figures_of_attempts_are_what_was_reached_in_the_end_and_what_it_took() -> None:
    attempts = [
        {"time_s": 30.0, "success_rate": 0.0, "steps_done": 0.5, "path_length": 2.0},
        {"time_s": 10.0, "success_rate": 1.0, "steps_done": 1.0, "path_length": 1.0},
    ]
    assert in_the_end(attempts) == {
        "attempts": 2.0,
        "time_s": 40.0,
        "success_rate": 1.0,
        "steps_done": 1.0,
        "path_length": 3.0,
    }


def test_names_of_figures_are_files_that_a_run_may_replace() -> None:
    for name in NAMES:
        definition = load_definition(name)
        assert {f"{one}.png" for one in figure_names(definition)} < set(report_files(definition))


@pytest.mark.slow
@pytest.mark.parametrize("name", NAMES)
def test_every_study_runs_at_smoke_sizes(name: str, tmp_path: Path) -> None:
    definition = load_definition(name)
    request = Request(definition, PRESETS["smoke"], 2, tmp_path / name, jobs=1, quiet=True)
    claim(request, report_files(definition))
    ran = send_people(request)
    write_report(request.out, ran, write_documents(request, ran), f"latentarm study run {name}")
    assert {one.condition for one in ran.trials} == {one.name for one in definition.conditions}
    assert all(np.isfinite(list(one.measures.values())).all() for one in ran.trials)
    found, trials = read_trials(request.out)
    assert found == definition
    assert trials == list(ran.trials)


@pytest.mark.slow
@pytest.mark.parametrize("backend", ["ray", "dask"])
def test_every_backend_writes_the_same_bytes(backend: str, tmp_path: Path) -> None:
    definition = load_definition("harmonic")
    written: list[dict[str, bytes]] = []
    for place in ("joblib", backend):
        request = Request(
            definition, PRESETS["smoke"], 2, tmp_path / place, jobs=2, backend=place, quiet=True
        )
        claim(request, ())
        write_documents(request, send_people(request))
        written.append({name: (request.out / name).read_bytes() for name in DOCUMENTS})
    assert written[0] == written[1]
