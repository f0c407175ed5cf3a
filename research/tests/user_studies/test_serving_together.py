"""Many simulated participants go through a study at once, far away; each drive measures the same again."""

import json
import os
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import pytest

from latentarm.arms.contract import SIMULATED_INPUT_BUDGET_S
from latentarm.cli import main
from latentarm_research.user_studies.recorded import DATABASE, read_recorded
from latentarm_research.user_studies.serving.store import Store
from latentarm_research.user_studies.serving.study_files import STEPS
from study_participant import next_link, participant, serving

PEOPLE = int(os.environ.get("LATENTARM_STUDY_PEOPLE", "3"))
"""Number of participants; those for whom there is no arm wait in the queue."""

AT_ONCE = "2"

EACH_WAY_S = 0.1  # a round trip of 200 ms


@pytest.mark.slow
def test_participants_far_away_take_part_at_once(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    out = tmp_path / "people"
    with serving("eating", "--out", str(out), "--at-once", AT_ONCE) as (link, _):

        def takes_part(number: int) -> None:
            with participant(link, next_link(out, number), EACH_WAY_S) as person:
                person.take_part()

        with ThreadPoolExecutor(PEOPLE) as people:
            list(people.map(takes_part, range(PEOPLE)))
    recorded = read_recorded(out)
    assert sorted(recorded.met) == list(range(PEOPLE))
    assert len(recorded.trials) == 8 * PEOPLE
    driven = [one for one in recorded.trials if one.measures["input_magnitude"] > 0.0]
    assert driven
    store = Store(out / DATABASE)
    delays_s = [one.measures["input_delay_s"] for person in store.people() for one in person.drives]
    store.close()
    assert len(delays_s) == 8 * PEOPLE
    assert all(2.0 * EACH_WAY_S <= delay_s < SIMULATED_INPUT_BUDGET_S for delay_s in delays_s)
    assert len(list((out / STEPS).rglob("*.safetensors"))) == 8 * PEOPLE
    capsys.readouterr()
    assert main(["study", "replay", str(out), "--json"]) == 0
    assert json.loads(capsys.readouterr().out) == {"drives": 8 * PEOPLE, "differ": 0}
    assert main(["study", "analyse", str(out), "--out", str(tmp_path / "report")]) == 0
    assert f"{PEOPLE} real people (preset smoke)" in (tmp_path / "report" / "report.html").read_text()
