"""Simulated people go through a study: a tiny one from end to end in physics, and all five at smoke sizes."""

import json
import re
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from latentarm.core.errors import UserError
from latentarm.core.untrusted.documents import read_object
from latentarm_research.studies.page import HTML, PDF
from latentarm_research.studies.study import ALWAYS_MADE, Request, run_study
from latentarm_research.user_studies import session
from latentarm_research.user_studies.catalogue import NAMES, load_definition
from latentarm_research.user_studies.definition import Definition
from latentarm_research.user_studies.drive_record import in_the_end, together
from latentarm_research.user_studies.record import read_trials
from latentarm_research.user_studies.recorded import read_recorded
from latentarm_research.user_studies.run import SESSIONS, study_of
from latentarm_research.user_studies.session import choices_of
from latentarm_research.user_studies.sizes import Sizes, sizes_of
from latentarm_research.user_studies.trace import read_traces

TINY = Sizes("tiny", simulated=2, trial_s=0.1, most_trials=1)
HARMONIC = load_definition("harmonic")
ASSISTED = ("No Assist", "High Assist")


def without_models(definition: Definition) -> Definition:
    """HARMONIC's own conditions, which need no training."""
    kept = tuple(one for one in definition.conditions if one.name in ASSISTED)
    return replace(definition, conditions=kept, hypotheses=(), printed=())


def request(out: Path, sizes: Sizes, definition: Definition, **changes: Any) -> Request[Sizes]:
    tasks = tuple(task.name for task in definition.tasks)
    return Request(out, sizes, tasks, **{"jobs": 1, "quiet": True, **changes})


def test_simulated_people_go_through_a_study_and_a_report_says_that_they_are(tmp_path: Path) -> None:
    definition, out = without_models(HARMONIC), tmp_path / "study"
    study = study_of(definition)
    run_study(study, request(out, TINY, definition))
    trials = read_trials(read_object(out / "trials.json"), out)
    assert [(one.person, one.order) for one in trials] == [(0, 0), (0, 1), (1, 0), (1, 1)]
    assert {one.condition for one in trials if one.person == 0} == set(ASSISTED)
    # The same person meets the same scene in every condition.
    traces = read_traces(read_object(out / "traces.json"), out)
    starts = {one.condition: one.position[0] for one in traces if one.person == 0}
    assert starts["No Assist"] == starts["High Assist"]
    made = {*study.documents, *ALWAYS_MADE, "measures.png", SESSIONS}
    assert {one.name for one in out.iterdir()} >= made - {PDF}
    page = (out / HTML).read_text(encoding="utf-8")
    captions = re.findall(r"<(?:fig)?caption>(.*?)</(?:fig)?caption>", page)
    assert len(captions) > 6
    assert all("simulated people" in caption for caption in captions)
    assert definition.digest in page
    config = json.loads((out / "config.json").read_text())
    assert (config["definition"], config["people_are"]) == (definition.digest, "simulated")


def test_a_stopped_study_goes_on_with_the_sessions_that_it_has(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    definition = without_models(HARMONIC)
    study, asked = study_of(definition), request(tmp_path, TINY, definition)
    run_study(study, asked)
    made = (*study.documents, "results.json", "measures.png")
    before = {name: (tmp_path / name).read_bytes() for name in made}
    sessions = sorted((tmp_path / SESSIONS).iterdir())
    assert len(sessions) == 4
    sessions[2].unlink()
    gone_through: list[int] = []
    measured = session.trial_of
    monkeypatch.setattr(session, "trial_of", lambda *given: gone_through.append(1) or measured(*given))
    run_study(study, asked)
    assert gone_through == [1]
    assert {name: (tmp_path / name).read_bytes() for name in made} == before
    sessions[0].write_bytes(sessions[2].read_bytes())
    with pytest.raises(UserError, match="holds another session"):
        run_study(study, asked)


def test_a_request_for_too_few_people_or_another_folder_is_refused(tmp_path: Path) -> None:
    with pytest.raises(UserError, match="2 people or more"):
        sizes_of("paper", 1)
    (tmp_path / "mine.txt").write_text("keep")
    with pytest.raises(UserError, match="choose another folder"):
        run_study(study_of(HARMONIC), request(tmp_path, TINY, HARMONIC))
    with pytest.raises(UserError, match="No study is in"):
        read_recorded(tmp_path)


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


@pytest.mark.slow
@pytest.mark.parametrize("name", NAMES)
def test_every_study_runs_at_smoke_sizes(name: str, tmp_path: Path) -> None:
    definition = load_definition(name)
    run_study(study_of(definition), request(tmp_path / name, sizes_of("smoke", 2), definition))
    recorded = read_recorded(tmp_path / name)
    assert recorded.definition == definition
    assert {one.condition for one in recorded.trials} == {one.name for one in definition.conditions}
    assert all(np.isfinite(list(one.measures.values())).all() for one in recorded.trials)


@pytest.mark.slow
@pytest.mark.parametrize("backend", ["ray", "dask"])
def test_every_backend_writes_the_same_bytes(backend: str, tmp_path: Path) -> None:
    written: list[dict[str, bytes]] = []
    study = study_of(HARMONIC)
    for place in ("joblib", backend):
        asked = request(tmp_path / place, sizes_of("smoke", 2), HARMONIC, jobs=2, backend=place)
        run_study(study, asked)
        written.append({name: (asked.out / name).read_bytes() for name in study.documents})
    assert written[0] == written[1]
