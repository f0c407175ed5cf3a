"""No byte of a person stays when they leave, or when the experimenter deletes them."""

import json
import shutil
import sqlite3
from contextlib import closing
from pathlib import Path
from typing import Any

import pytest

from latentarm.cli import main
from latentarm_research.user_studies.drive_record import DriveRecord
from latentarm_research.user_studies.serving.store import Store
from latentarm_research.user_studies.serving.study_files import steps_of
from latentarm_research.user_studies.trace import Trace
from study_participant import MODES, TWIST, definition, next_link, participant, serving

SLICE = 32  # bytes of a person that must be nowhere


def traces_of(kept: list[bytes], of_another: list[bytes], content: bytes) -> list[bytes]:
    """Slices of what was kept of a person, and of nobody else, that stand in some content."""
    others = b"".join(of_another)
    slices = [one[at : at + SLICE] for one in kept for at in range(0, max(len(one) - SLICE, 0) + 1, SLICE)]
    return [one for one in slices if one in content and one not in others]


def content_of(*folders: Path) -> bytes:
    return b"\n".join(path.read_bytes() for folder in folders for path in folder.rglob("*") if path.is_file())


def a_drive(person: int, trial: int) -> DriveRecord:
    position = tuple((person + trial / 7, number / 3, 0.1) for number in range(60))
    trace = Trace(person, "A", "task", trial, 0, True, (), position, (), ())
    return DriveRecord(
        people_are="real", person=person, condition="A", order=0, task="task", trial=trial, choice=0,
        attempt=0, ending="done", measures={"time_s": 1.0}, trace=trace,
    )  # fmt: skip


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """A study of three people with drives and answers, who were last there on three days."""
    (tmp_path / "config.json").write_text('{"study": "study two_ways"}')
    (tmp_path / "drives").mkdir()
    store = Store(tmp_path / "study.sqlite")
    codes = store.open_places(3)
    (tmp_path / "links.csv").write_text("".join(f"http://study.example/study?code={one}\n" for one in codes))
    for number, code in enumerate(codes):
        key = store.arrive(code, "", 86400.0 * number)
        assert key is not None
        store.place(key, 86400.0 * number)
        for trial in range(5):
            store.keep_drive(key, a_drive(number, trial))
        (tmp_path / "drives" / key).mkdir()  # a killed server leaves it
        store.keep_answers(key, 0, "A", {"ease_1": 5})
        store.finish(key, f"COMPLETION{number}")
    store.close()
    return tmp_path


def kept_of(folder: Path, link: str) -> tuple[dict[str, list[dict[str, Any]]], list[bytes]]:
    """All data of the person with this link: as they download it, and as bytes to search for."""
    store = Store(folder / "study.sqlite")
    kept = store.everything(str(store.arrive(link, "", 0.0)))
    store.close()
    (person,) = kept["people"]
    records = [one["record"] for one in kept["drives"]]
    return kept, [text.encode() for text in (person["key"], person["link"], person["completion"], *records)]


@pytest.mark.parametrize("by", ["link", "completion code", "day"])
def test_no_byte_stays_of_people_whom_the_experimenter_deletes(folder: Path, by: str) -> None:
    links = [line.split("=")[1] for line in (folder / "links.csv").read_text().splitlines()]
    kept, looked_for = kept_of(folder, links[0])
    _, of_another = kept_of(folder, links[1])
    assert [len(kept[table]) for table in ("people", "places", "drives", "answers")] == [1, 1, 5, 1]
    assert len(traces_of(looked_for, of_another, content_of(folder))) > 50
    how = {"link": ["--code", links[0]], "completion code": ["--code", "COMPLETION0"]}
    assert main(["study", "delete", str(folder), *how.get(by, ["--before", "1970-01-02"])]) == 0
    shutil.copytree(folder, copy := folder / "copy")
    with (
        closing(sqlite3.connect(folder / "study.sqlite")) as database,
        closing(sqlite3.connect(copy / "backup.sqlite")) as backup,
    ):
        database.backup(backup)
    assert traces_of(looked_for, of_another, content_of(folder)) == []
    # Their link was replaced by a new one; everything of the others is there.
    after = [line.split("=")[1] for line in (folder / "links.csv").read_text().splitlines()]
    assert after[0] != links[0]
    assert after[1:] == links[1:]
    assert len(list((folder / "drives").iterdir())) == 2
    assert not (folder / "drives" / kept["people"][0]["key"]).exists()
    assert kept_of(folder, links[1])[1] == of_another


def test_a_code_that_nobody_has_is_refused(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["study", "delete", str(folder), "--code", "nobody"]) == 2
    assert main(["study", "delete", str(folder)]) == 2
    assert main(["study", "delete", str(folder), "--before", "tomorrow"]) == 2
    assert "Nobody" in capsys.readouterr().err
    store = Store(folder / "study.sqlite")
    for link in store.open_places(5)[3:]:
        store.finish(str(store.arrive(link, "", 0.0)), "SAME")
    assert main(["study", "delete", str(folder), "--code", "SAME"]) == 2
    assert "2 people have the code SAME" in capsys.readouterr().err
    assert len(store.people()) == 5
    store.close()


@pytest.mark.slow
def test_no_byte_stays_of_a_person_who_leaves(tmp_path: Path) -> None:
    study, out = tmp_path / "two_ways.json", tmp_path / "people"
    study.write_text(json.dumps(definition(MODES, TWIST)))
    with serving(str(study), "--out", str(out)) as (link, _):
        with participant(link, link) as person:
            person.take_part()
        with participant(link, left := next_link(out)) as other:
            other.take_part()
            copy = other.client.get("/study/data").json()
            (own,) = copy["people"]
            assert other.page.count(own["completion"]) == 1
            steps = [other.client.get(path).content for path in copy["steps"]]
            assert len(steps) == len(copy["drives"]) == 2
            assert all(len(one) > 10_000 for one in steps)
            # Nobody else gets them.
            with participant(link, link) as another:
                assert another.client.get(copy["steps"][0]).content != steps[0]
            records = [DriveRecord.model_validate(one["record"]) for one in copy["drives"]]
            looked_for = [*steps, *(one.model_dump_json().encode() for one in records)]
            looked_for += [text.encode() for text in (own["key"], own["completion"], left.split("=")[1])]
            assert len(traces_of(looked_for, kept_in(out), content_of(out))) > 100
            other.post("withdraw")
            assert other.client.get("/study/data").status_code == 403
        # Also while the server runs.
        assert traces_of(looked_for, kept_in(out), content_of(out)) == []
    assert main(["study", "export", str(out), "--out", str(tmp_path / "dataset")]) == 0
    assert main(["study", "analyse", str(out), "--out", str(tmp_path / "report")]) == 0
    shutil.copytree(out, tmp_path / "copy")
    assert traces_of(looked_for, kept_in(out), content_of(tmp_path)) == []


def kept_in(out: Path) -> list[bytes]:
    """Drives of the person who has not left, of which some slices are alike."""
    store = Store(out / "study.sqlite")
    person = next(one for one in store.people() if one.drives[0].person == 0)
    store.close()
    records = [drive.model_dump_json().encode() for drive in person.drives]
    return [*records, *(path.read_bytes() for path in steps_of(out, person.key))]
