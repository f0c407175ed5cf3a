"""A study with a scripted participant over HTTP and WebSocket, in real processes that are killed."""

import json
import os
import time
from contextlib import suppress
from pathlib import Path

import numpy as np
import pytest

from latentarm.cli import main
from latentarm.demonstrations.dataset import read_dataset
from latentarm_research.user_studies.drive_record import devices_of
from latentarm_research.user_studies.recorded import read_recorded
from study_participant import CONTACT, LATENT, MODES, definition, next_link, participant, serving


@pytest.mark.slow
def test_a_participant_goes_through_a_study_with_a_learned_model_and_is_reported_as_a_person(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    study, out = tmp_path / "two_ways.json", tmp_path / "people"
    study.write_text(json.dumps(definition(MODES, LATENT)))
    with (
        serving(str(study), "--out", str(out), "--completion-code", "C0DE") as (link, _),
        participant(link, link) as person,
    ):
        assert person.part == "consent"
        # Nothing is driven before they consent.
        assert person.post("begin").json()["to"] == "/study"
        person.consent()
        person.ready()
        # A trial whose end they do not see, because the tab is closed, does not count.
        with suppress(InterruptedError), person.driving():
            raise InterruptedError
        time.sleep(1.5)
        person.take_part()
        assert "C0DE" in person.page
        with participant(link, next_link(out)) as other:
            other.take_part()
            key = other.client.cookies["latentarm_study"]
            other.post("withdraw")
            assert other.part == "unknown"
    recorded = read_recorded(out)
    assert (recorded.people_are, len(recorded.met)) == ("real", 1)
    assert [one.order for one in recorded.trials] == [0, 1]
    assert {one.condition for one in recorded.trials} == {"Modes", "Latent"}
    for trial in recorded.trials:
        assert trial.measures["time_s"] == pytest.approx(1.0, abs=0.05)
        assert trial.measures["path_length"] > 0.01
    for drive in recorded.participants[0].drives:
        found = drive.measures
        # It is the integral of ‖u‖, and they push one axis fully or not at all.
        assert found["input_magnitude"] == pytest.approx(found["time_s"] - found["idle_s"])
        assert found["input_magnitude"] > 0.2
    assert devices_of(recorded.participants[0].drives) == ("pointer mouse",)
    assert len(recorded.answers) == 8
    # Of the person who has left no byte remains, and nobody's address was kept.
    content = b"".join(path.read_bytes() for path in out.rglob("*") if path.is_file())
    assert key.encode() not in content
    assert content.count(b'"people_are":"real"') == 2
    assert b"127.0.0.1" not in (out / "study.sqlite").read_bytes()
    os.chdir(tmp_path)
    assert main(["study", "analyse", str(out), "--out", str(tmp_path / "report")]) == 0
    assert main(["study", "replay", str(out)]) == 0
    assert "Drives that come out the same: 2 of 2." in capsys.readouterr().out
    assert main(["study", "export", str(out), "--out", str(tmp_path / "dataset")]) == 0
    exported = read_dataset(next((tmp_path / "dataset" / "drives").iterdir())).episodes
    assert {one.provenance and one.provenance.controller for one in exported} == {"Modes", "Latent"}
    for episode in exported:
        assert episode.timestamp[-1] == pytest.approx(1.0, abs=0.05)
        assert np.ptp(episode.state, axis=0).max() > 0.01
    page = (tmp_path / "report" / "report.html").read_text()
    assert "1 real person (preset smoke)" in page
    assert "simulated" not in page


def test_a_condition_that_the_page_lacks_is_refused(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["study", "serve", "apple_pie", "--port", "0", "--contact", CONTACT]) == 2
    assert "two sticks" in capsys.readouterr().err
