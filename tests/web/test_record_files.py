"""Names in any script, drives logged from reports, and files of records that are broken or a stranger's."""

import asyncio
import io
import json
import shutil
import zipfile
from dataclasses import replace
from datetime import UTC, datetime
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from latentarm.core.errors import UserError
from latentarm.core.untrusted.names import MOST_CHARACTERS, clean_name, file_words
from latentarm.web.arm_process.drive_setup import Spec, load_setup
from latentarm.web.protocol.notice import Notice
from latentarm.web.protocol.report import Report, TaskState
from latentarm.web.protocol.scene import drawable
from latentarm.web.records.drive_log import LATE, MOST_VALUES, About, DriveLog
from latentarm.web.records.drive_record import DriveRecord, checked_trace, packed
from latentarm.web.records.drives import Drives, Wanted
from latentarm.web.records.people import People
from latentarm.web.records.poses import read_poses, with_pose, write_poses
from latentarm.web.records.record_files import parse_record
from latentarm.web.records.records import FOLDER, Records
from latentarm.web.server.history import History

HOURLY = [HealthCheck.function_scoped_fixture]
LETTERS = st.characters(categories=("L", "N", "M", "S", "P", "Zs"))


@pytest.fixture
def records(tmp_path):
    return Records(tmp_path, dict, lambda: None)


@pytest.fixture(scope="module")
def about():
    setup = load_setup(Spec())
    return About(None, setup, None, drawable(setup.task, (), None))


@given(name=st.text(LETTERS, min_size=1, max_size=40))
@settings(max_examples=25, deadline=None, suppress_health_check=HOURLY)
def test_any_name_is_kept_or_refused_in_a_sentence(tmp_path, name):
    folder = tmp_path / "people"
    shutil.rmtree(folder, ignore_errors=True)
    try:
        person = People(folder).add(name)
    except UserError:
        with pytest.raises(UserError, match="name"):
            clean_name(name)
        return
    assert clean_name(person.name) == person.name
    assert len(person.name) <= MOST_CHARACTERS
    (path,) = folder.iterdir()
    assert path.name == person.id
    assert People(folder).find(person.id) == person


@pytest.mark.parametrize("name", ["Zoë Müller", "李雷", "محمد", "नेहा", "O’Brien-Łukasz", "👩‍🦽", "佐藤 花子"])
def test_names_of_people_are_names(name):
    assert clean_name(f"  {name} ") == clean_name(name)


@pytest.mark.parametrize(
    ("name", "words"),
    [("Zoë Müller", "Zoë-Müller"), ("../../etc", "etc"), ("a/b\\c:d", "a-b-c-d"), ("👩‍🦽", "person")],
)
def test_a_name_becomes_part_of_the_name_of_a_file(name, words):
    assert file_words(name) == words


BEGUN = TaskState(
    choice=0, done=0, outcome=None, why=None, time_s=0.0, to_go=None, lost=None, fills=(), short=False
)


def report(tick, phase, tool, code=None, **changes):
    return Report(
        reading_age_s=0.0,
        nonce="", tick=tick, time_s=100.0 + 0.01 * tick, driver=1, phase=phase, note=None,
        reason=None if code is None else Notice(code=code), held_back=None, zone=None,
        mode="assisted", axes=0, run=None, own_task=False,
        returning=False, bound_for=None, at_start=False, guiding=None, lost=False, let_go_first=False,
        idle_left_s=None, help="medium",
        seed=0,
        task=BEGUN,
        profile=None, loading=False,
        q=(0.0, *[0.1 * tool] * 6), tool=(tool, 0.0, 0.0), gripper=None,
        things=None, held=(), ghosts=None, belief=(), alpha=0.5, recording=None, journal=None, late_share=0.0,
        **changes,
    )  # fmt: skip


def logged(about, reports):
    log = DriveLog()
    for one in reports:
        if log.begins(one):
            log.begin(one, about)
        else:
            log.take(one)
    return log.end("reset")


def drive(about):
    """Enabled for 1 s, moving for 2 s by 0.2 m, late, disengaged for 1 s, enabled and moving for 1 s."""
    moving = [report(100 + k, "moving", 0.001 * k) for k in range(200)]
    stopped = [report(300 + k, "disengaged", 0.199, LATE) for k in range(100)]
    again = [report(400 + k, "moving", 0.199) for k in range(101)]
    ready = [report(k, "ready", 0.0) for k in range(100)]
    return logged(about, [report(-1, "disengaged", 0.0), *ready, *moving, *stopped, *again])


def test_the_figures_of_a_drive_are_those_of_its_reports(about):
    record = drive(about).record
    assert record.time_s == pytest.approx(5.0, abs=0.03)
    assert record.moving_s == pytest.approx(3.0, abs=0.03)
    assert record.way_m == pytest.approx(0.199, abs=1e-3)
    assert (record.stops, record.late_stops, record.reasons) == (1, 1, {LATE: 1})
    assert record.help == 0.5
    assert (record.ended, record.outcome, record.steps_done) == ("reset", None, 0)


def test_each_input_is_timed_as_long_as_it_is_pushed_while_the_arm_is_enabled(about):
    log = DriveLog()
    log.begin(report(0, "ready", 0.0), about)
    for first, last, u, source in (
        (1, 100, (1.0, 0.0), "keyboard"),
        (100, 200, (0.0, 0.0), "keyboard"),
        (200, 500, (0.0, 0.5), "switch"),
        (500, 600, (1.0, 0.0), "keyboard"),
    ):
        log.given(u, source, gripper=False)
        for tick in range(first, last):
            log.take(report(tick, "moving", 0.0))
    log.take(report(600, "disengaged", 0.0, "stop_pressed_by"))
    log.take(report(900, "disengaged", 0.0, "stop_pressed_by"))
    record = log.end("next").record
    assert record.inputs == ("keyboard", "switch")
    assert record.input_s == {
        "keyboard": pytest.approx(2.0, abs=0.05),
        "switch": pytest.approx(3.0, abs=0.05),
    }


def test_a_record_says_who_stopped_the_arm_and_an_old_one_that_no_input_was_timed(about):
    reasons = {
        "stop_pressed_by": 2,
        "handed_over": 1,
        LATE: 3,
        "page_stopped": 1,
        "joint_astray": 1,
        "arm_stopped": 1,
    }
    record = drive(about).record.model_copy(update={"reasons": reasons, "stops": 9})
    assert record.stops_by == {"person": 3, "page": 4, "arm": 2}
    old = record.model_dump_json(exclude={"input_s"})
    assert parse_record(DriveRecord, old.encode(), "it").input_s is None


def test_records_are_dated_in_utc(about, records):
    began = datetime.now(UTC).replace(microsecond=0)
    done = logged(about, [report(k, "ready", 0.0) for k in range(3)])
    for dated in (done.record.started, records.people.add("Ada").added):
        assert dated.endswith("+00:00")
        assert began <= datetime.fromisoformat(dated) <= datetime.now(UTC)


def test_nothing_is_counted_after_the_task_has_ended_but_all_of_it_is_shown_again(about):
    end = BEGUN.model_copy(update={"done": 2, "outcome": "success", "time_s": 1.0})
    before = [report(k, "moving", 0.001 * k) for k in range(100)]
    after = [report(k, "moving", 0.001 * k).model_copy(update={"task": end}) for k in range(100, 300)]
    stopped = report(300, "disengaged", 0.3, "stop_pressed").model_copy(update={"task": end})
    log = DriveLog()
    log.begin(before[0], about)
    log.given((1.0, 0.0), "keyboard", gripper=False)
    for one in [*before[1:], *after, stopped]:
        log.take(one)
    log.given((0.0, 0.0), "keyboard", gripper=False)
    log.given((1.0, 0.0), "keyboard", gripper=False)
    done = log.end("next")
    record = done.record
    assert (record.time_s, record.moving_s, record.way_m) == pytest.approx((1.0, 1.0, 0.1), abs=0.02)
    assert (record.outcome, record.stops, record.presses) == ("success", 0, 1)
    assert done.trace().t[-1] == pytest.approx(3.0, abs=0.02)


def test_a_task_that_is_done_is_on_disk_before_its_drive_ends(about, records, tmp_path):
    """So a server that is killed a moment later loses none of it."""
    loaded = SimpleNamespace(
        spec=SimpleNamespace(shadow=False), setup=about.setup, name=about.run, scene=about.scene
    )
    states = SimpleNamespace(heard=[], loaded=loaded)

    async def heard():
        history = History(states, SimpleNamespace(driver=None), records)
        (hear,) = states.heard
        for one in [report(0, "ready", 0.0), report(1, "moving", 0.0), done]:
            hear(one)
        await history.settled()

    end = BEGUN.model_copy(update={"done": 2, "outcome": "success", "time_s": 1.0})
    done = report(2, "moving", 0.1).model_copy(update={"task": end})
    asyncio.run(heard())
    (kept,) = Records(tmp_path, dict, lambda: None).drives.wanted(Wanted())
    assert (kept.outcome, kept.steps_done, kept.ended) == ("success", 2, "broken_off")


def test_a_trace_is_thin_and_comes_back(about):
    trace = drive(about).trace()
    assert 20 <= len(trace.t) <= 24
    assert np.diff(trace.t).min() >= 0.1 - 1e-9
    assert [mark.code for mark in trace.marks] == ["enabled", LATE, "enabled"]
    assert checked_trace(packed(trace), "it") == trace


def test_a_long_drive_keeps_fewer_moments_of_all_of_it(about):
    end = 10 * 60 * 15
    trace = logged(about, [later(k, 0.1 * (k % 7)) for k in range(end)]).trace()
    assert len(trace.t) * 64 <= 1.1 * MOST_VALUES
    assert trace.t[-1] == pytest.approx(0.1 * (end - 1), abs=trace.period_s)
    assert max(np.diff(trace.t)) < 4 * trace.period_s


def later(k, tool):
    return report(0, "moving", tool).model_copy(update={"time_s": 0.1 * k})


def kept(records, about):
    person = records.people.add("Ada")
    done = drive(replace(about, person=person.id))
    records.drives.keep(done.record, done.trace())
    return person, done.record


def test_what_was_kept_is_there_for_the_next_server(records, about, tmp_path):
    person, record = kept(records, about)
    again = Records(tmp_path, dict, lambda: None)
    assert again.drives.wanted(Wanted(person=person.id)) == [record]
    assert again.people.problems + again.drives.problems == []


def test_records_that_an_earlier_program_wrote_are_read_and_exported(tmp_path):
    """Those that commit 44babad3 of 24 November 2026 wrote."""
    shutil.copytree(Path(__file__).with_name("earlier_records"), tmp_path / FOLDER)
    records = Records(tmp_path, dict, lambda: None)
    (person,) = records.people.all()
    (record,) = records.drives.wanted(Wanted(person=person.id))
    assert records.people.problems + records.drives.problems == []
    assert (person.name, record.choice, record.ended, record.time_s) == ("Ada", "carrot", "reset", 5.0)
    assert [pose.name for pose in read_poses(records.people.folder_of(person.id))] == ["Drink"]
    assert records.drives.trace(record.id)  # checked
    with zipfile.ZipFile(records.export(person.id)) as packed_up:
        assert any(record.id in name for name in packed_up.namelist())


def test_a_scene_stays_as_long_as_a_drive_is_left_that_is_shown_with_it(records, about, tmp_path):
    scenes = tmp_path / FOLDER / "scenes"
    people = [records.people.add(name) for name in ("Ada", "Bea")]
    other = replace(about, scene=replace(about.scene, description={**about.scene.description, "things": []}))
    for person, of in ((people[0], about), (people[1], about), (people[1], other)):
        records.keep(drive(replace(of, person=person.id)))
    of_ada, *_ = records.drives.wanted(Wanted(person=people[0].id))
    records.erase(people[1].id)
    assert [path.stem for path in scenes.glob("*.json")] == [of_ada.scene]
    records.drives.delete(of_ada.id)
    records.purge()
    assert records.scenes.description(of_ada.scene)
    records.drives.restore(of_ada.id)
    records.erase(people[0].id)
    assert [path for path in (tmp_path / FOLDER).rglob("*") if path.is_file()] == []


def test_a_deletion_can_be_undone_until_its_time_is_over(records, about, tmp_path):
    now = [0.0]
    _, record = kept(records, about)
    folder = tmp_path / FOLDER
    drives = Drives(folder, folder / "people", lambda: now[0])
    drives.delete(record.id)
    drives.restore(record.id)
    drives.trace(record.id)
    drives.delete(record.id)
    now[0] = 601.0
    drives.purge()
    with pytest.raises(UserError):
        drives.restore(record.id)
    assert [path for path in folder.rglob("*") if record.id in path.name] == []


@pytest.mark.parametrize(
    "damage", [b"", b"{", b'{"version": 2}', b'{"id": "../../x"}', b"\xff", b"[" * 100_000]
)
def test_a_damaged_record_is_named_and_the_rest_is_there(records, about, tmp_path, damage):
    _, record = kept(records, about)
    bea = records.people.add("Bea")
    path = tmp_path / FOLDER / "people" / bea.id / "person.json"
    path.write_bytes(damage)
    again = Records(tmp_path, dict, lambda: None)
    assert [person.name for person in again.people.all()] == ["Ada"]
    assert again.drives.find(record.id) == record
    assert str(path) in again.people.problems[0].text


def test_saved_poses_go_into_the_export_and_come_back(records):
    ada = records.people.add("Ada")
    poses = with_pose((), "panda", "Drink", (0.1, 0.2))
    write_poses(records.people.folder_of(ada.id), poses)
    path = records.export(ada.id)
    brought = records.bring(path.read_bytes())
    path.unlink()
    assert read_poses(records.people.folder_of(brought["person"])) == poses
    records.erase(brought["person"])
    assert not records.people.folder_of(brought["person"]).exists()


@given(at=st.integers(0, 10**6), byte=st.integers(0, 255))
@settings(max_examples=15, deadline=None, suppress_health_check=HOURLY)
def test_a_damaged_export_adds_a_person_or_nothing(records, about, at, byte):
    if not records.people.all():
        kept(records, about)
    person = records.people.all()[0]
    path = records.export(person.id)
    content = bytearray(path.read_bytes())
    path.unlink()
    content[at % len(content)] = byte
    before = len(records.people.all())
    try:
        brought = records.bring(bytes(content))
    except UserError:
        assert len(records.people.all()) == before
        return
    records.erase(brought["person"])
    assert len(records.people.all()) == before


@pytest.mark.parametrize(
    "names",
    [
        {"../../evil.json": b"{}", "drives/../../x.json": b"{}"},
        {"drives/0123456789abcdef.json": b'{"version": 1}'},
        {"drives/0123456789abcdef.json": b" " * (1 << 18)},
    ],
)
def test_an_export_of_a_stranger_writes_nowhere_else(records, tmp_path, names):
    ada = {"version": 1, "id": "0123456789abcdef", "name": "Ada", "added": ""}
    archive = io.BytesIO()
    with zipfile.ZipFile(archive, "w") as zipped:
        zipped.writestr("person.json", json.dumps(ada))
        for name, content in names.items():
            zipped.writestr(name, content)
    if "../../evil.json" in names:
        assert records.bring(archive.getvalue())["drives"] == 0
    else:
        with pytest.raises(UserError):
            records.bring(archive.getvalue())
    assert [path.name for path in tmp_path.iterdir()] in ([], [FOLDER])
    found = {path.name for path in tmp_path.rglob("*") if path.is_file()}
    assert found <= {"person.json"}


@pytest.mark.parametrize(
    ("name", "title"), [("An", "Soup with An"), ("李雷", "李雷的汤"), ("Zoë", "zoë's soup")]
)
def test_titles_that_name_a_person_go_with_them_and_no_others(records, tmp_path, name, title):
    person = records.people.add(name)
    for file, text in (("one.sqlite", title), ("two.sqlite", "Banana soup")):
        (tmp_path / file).touch()
        records.recordings.entitle(file, text)
    records.erase(person.id)
    assert {one.name: one.title for one in records.recordings.all()} == {
        "one.sqlite": "",
        "two.sqlite": "Banana soup",
    }
