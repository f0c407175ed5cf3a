"""What an arm is told on the page is kept, and gives the same commands again, to the bit."""

import base64
import hashlib
import json
import math
import zlib
from contextlib import contextmanager, suppress
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from latentarm import cli
from latentarm.assistance.controllers.contract import Controller
from latentarm.assistance.controllers.end_effector import EndEffectorController
from latentarm.assistance.controllers.joined import JoinedController
from latentarm.control.step import Step
from latentarm.core.call_log import CallLog, read_calls
from latentarm.core.errors import UserError
from latentarm.core.exact_json import of_json, to_json
from latentarm.core.journal_limits import JournalLimits
from latentarm.core.types import GripperReading, Input, Reading, Stop
from latentarm.demonstrations.dataset import write_dataset
from latentarm.robots.kinematics.obstacles import Box, Sphere
from latentarm.runs.options import TrainOptions
from latentarm.runs.training import train_run
from latentarm.safety.yielding import YIELDING
from latentarm.safety.zones import Zone
from latentarm.tasks.table_top import TableTop
from latentarm.web.arm_process import incident
from latentarm.web.arm_process.drive import Drive
from latentarm.web.arm_process.drive_setup import Spec, load_setup
from latentarm.web.arm_process.incident import begin_incident
from latentarm.web.arm_process.initial_state import RobotOptions
from latentarm.web.arm_process.replay import Replay, replay
from latentarm.web.arm_process.steering import Steering
from latentarm.web.protocol.notice import Notice
from latentarm.web.protocol.orders import (
    ChooseHelp,
    ChooseMode,
    ChooseProfile,
    Enable,
    PoseToGoTo,
    Return,
)

READ_ONLY = {"context"}
"""Public methods of `Step` that change nothing."""


@contextmanager
def recorded(desk, folder):
    """The desk's drive with an incident file in a folder; gives its calls."""
    desk.setup = replace(desk.setup, spec=replace(desk.setup.spec, out=folder))
    calls = begin_incident(desk.setup)
    on = (desk.arm, desk.channel, desk.clock, desk.writer, lambda: False, Steering(desk.setup.modes[0]))
    desk.drive = Drive(desk.setup, *on, observers=[desk._saw], calls=calls)
    yield calls
    calls.close()


def newest(folder):
    return max((folder / "incidents").iterdir())


def drive_about(desk, seed, for_s):
    """Whatever a person and an arm may do, at random."""
    rng = np.random.default_rng(seed)
    u = [0.0, 0.0]

    def tick(now_s):
        nonlocal u
        if rng.random() < 0.05:
            u = [0.0, 0.0] if rng.random() < 0.5 else rng.uniform(-1.0, 1.0, 2).tolist()
        if rng.random() > 0.01:
            desk.give(*u, gripper=str(rng.choice(["open", "close"])) if rng.random() < 0.02 else None)
        match rng.integers(200):
            case 0 | 1 | 2 | 3 | 4 | 5:
                desk.order(Enable(driver=1, stops=desk.channel.stop.version))
            case 6 | 7:
                desk.order(ChooseMode(mode=str(rng.choice(desk.setup.modes)), axes=int(rng.integers(3))))
            case 8:
                desk.order(ChooseHelp(level=str(rng.choice(["off", "low", "high"]))))
            case 9 | 10 | 11:
                q = desk.setup.start + rng.uniform(-0.2, 0.2, len(desk.setup.start))
                desk.order(Return(on=True, pose=PoseToGoTo(name="there", q=tuple(q.tolist()))))
            case 12:
                desk.channel.stop.write(Notice(code="stop_pressed").model_dump_json().encode())
            case 13:
                desk.arm.freeze()
            case 14:
                desk.arm.silence()
            case 15:
                desk.arm.press_emergency_stop()
            case 16 | 17 | 18 | 19:
                desk.arm.repair()
                desk.arm.release_emergency_stop()
            case _:
                pass

    desk.each_tick = tick
    desk.run(for_s)


def drive_straight(desk, for_s=1.0):
    """Enabled, pushed, let go."""

    def tick(now_s):
        if abs(now_s - 0.1) < 0.005:
            desk.order(Enable(driver=1, stops=desk.channel.stop.version))
        desk.give(0.7 if 0.3 < now_s < 0.7 else 0.0, 0.0)

    desk.each_tick = tick
    desk.run(for_s)


def rewritten(file, to, change):
    """A file whose lines are other ones, all digests right."""
    lines, digest, packing = list(read_calls(file)), "", zlib.compressobj(wbits=31)
    change(lines)
    with to.open("wb") as out:
        for line in lines:
            text = json.dumps(line)
            digest = hashlib.sha256(f"{digest}{text}".encode()).hexdigest()[:16]
            out.write(packing.compress(f"{digest} {text}\n".encode()))
        out.write(packing.flush(zlib.Z_SYNC_FLUSH))
    return to


@pytest.fixture
def file(desk, tmp_path):
    """A file of one second's drive."""
    with recorded(desk, tmp_path / "out"):
        drive_straight(desk)
    return newest(tmp_path / "out")


@settings(max_examples=4, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(seed=st.integers(0, 2**32))
def test_whatever_happens_on_the_page_gives_the_same_commands_again(desk_of, setup, tmp_path, seed):
    with desk_of(setup) as desk:
        with recorded(desk, tmp_path / "out"):
            drive_about(desk, seed, 3.0)
        found = replay(newest(tmp_path / "out"))
    assert found["first"] is None
    assert found["complete"]
    assert found["ticks"] == found["agreed"] == len(desk.records)
    assert found["same"]


def test_what_happened_can_be_read(file, capsys):
    assert cli.main(["replay", str(file)]) == 0
    said = capsys.readouterr().out
    assert said.index("The arm is not enabled yet.") < said.index("s  enabled") < said.index("has ended")
    assert "mode: latent" in said
    assert "gave the same command, to the bit" in said


def test_the_file_is_all_that_is_needed(desk, file, trained, tmp_path, capsys):
    """On another computer there is no run."""
    hidden = trained.rename(trained.with_name("hidden"))
    try:
        assert cli.main(["replay", str(file), "--json"]) == 0
    finally:
        hidden.rename(trained)
    (found,) = json.loads(capsys.readouterr().out).values()
    assert found["ticks"] == found["agreed"] == len(desk.records)


def test_the_first_command_that_differs_is_named(file, tmp_path, capsys):
    def push_harder(lines):
        call = [line for line in lines if line.get("call") == "__call__"][49]
        call["given"][0]["fields"]["u"] = to_json(np.array([0.8, 0.0]))

    other = rewritten(file, tmp_path / "other", push_harder)
    found = replay(other)
    assert found["first"]["tick"] == 49
    assert 1e-4 < found["largest_rad_s"] < 0.1
    assert cli.main(["replay", str(other)]) == 1
    assert "__call__ differs at 0.490 s, tick 49" in capsys.readouterr().out


def test_on_another_computer_the_last_bits_may_differ(file, tmp_path, monkeypatch, capsys):
    def change(by):
        def last_bit(lines):
            calls = [line for line in lines if line.get("call") == "__call__"]
            answer = calls[50]["answer"]
            answer["velocity"] = to_json(of_json(answer["velocity"]) + by)

        return last_bit

    near = rewritten(file, tmp_path / "near", change(1e-12))
    assert cli.main(["replay", str(near)]) == 1
    monkeypatch.setattr(incident, "computer", lambda: "another")
    assert cli.main(["replay", str(near)]) == 0
    assert "Here: another. Up to 1e-09 rad/s may differ" in capsys.readouterr().out
    assert cli.main(["replay", str(rewritten(file, tmp_path / "far", change(1e-6)))]) == 1


@settings(max_examples=40, deadline=None)
@given(data=st.data())
def test_a_changed_byte_is_refused_or_changes_nothing(data, shared_file, tmp_path_factory):
    content = bytearray(shared_file.read_bytes())
    at = data.draw(st.integers(0, len(content) - 1))
    content[at] ^= data.draw(st.integers(1, 255))
    damaged = tmp_path_factory.mktemp("damaged") / "file"
    damaged.write_bytes(content)
    whole = list(read_calls(shared_file))
    read = []
    with suppress(UserError):
        read.extend(read_calls(damaged))
        # Damage at the very end looks as if the file were cut off, which is said.
        assert len(read) >= len(whole) - 1
    assert read == whole[: len(read)]


@pytest.fixture(scope="module")
def shared_file(tmp_path_factory):
    """A file of a few calls."""
    path = tmp_path_factory.mktemp("shared") / "file"
    log = CallLog(path, JournalLimits(), [{"incident": 1}])
    for number in range(40):
        log.call("sent", (number * 0.1,), lambda: None)
        log.flush()
    log.close()
    return path


@pytest.mark.parametrize("length", [0.6, 0.8, 0.97])
def test_a_file_that_was_cut_off_replays_up_to_there(file, tmp_path, length):
    content = file.read_bytes()
    cut = tmp_path / "cut"
    cut.write_bytes(content[: round(length * len(content))])
    found = replay(cut)
    assert found["same"]
    assert not found["complete"]
    assert 0 < found["agreed"] == found["ticks"] < 100


def test_another_model_is_refused(file, tmp_path, capsys):
    write_dataset(TableTop().demonstrate(12, np.random.default_rng(1)), tmp_path / "table")
    train_run(TrainOptions((tmp_path / "table",), "pca", out=tmp_path / "run", seeds=1))

    def other_model(lines):
        for line in lines:
            if "file" in line:
                content = (tmp_path / line["file"]).read_bytes()
                line["data"] = base64.b64encode(content).decode()

    other = rewritten(file, tmp_path / "other", other_model)
    assert cli.main(["replay", str(other)]) == 2
    assert "model" in capsys.readouterr().err


@pytest.mark.parametrize("part", ["robot", "goals", "safety limits", "model"])
def test_what_differs_here_is_named(file, tmp_path, part):
    other = rewritten(file, tmp_path / "other", lambda lines: lines[0]["parts"].update({part: "0"}))
    with pytest.raises(UserError, match=f"its {part} would be"):
        replay(other)


@pytest.mark.parametrize("name", ["/evil", "../evil", "run/../../evil"])
def test_a_file_writes_nothing_elsewhere(file, tmp_path, name):
    other = rewritten(file, tmp_path / "other", lambda lines: lines[1].update({"file": name}))
    with pytest.raises(UserError, match="no file of a run"):
        replay(other)


@pytest.mark.parametrize(
    ("change", "said"),
    [
        (lambda lines: lines[0].update({"incident": 1}), "another version"),
        (lambda lines: lines[0].update({"spec": None}), "does not say what was driven"),
        (lambda lines: lines[-5].update({"call": "_record"}), None),
        (lambda lines: lines[-5].update({"given": [1, 2, 3, 4, 5, 6]}), "is damaged"),
        (lambda lines: lines[-5].update({"given": [{"record": "Path", "fields": {}}]}), "is damaged"),
    ],
)
def test_a_file_that_is_none_of_ours(file, tmp_path, capsys, change, said):
    other = rewritten(file, tmp_path / "other", change)
    code = cli.main(["replay", str(other)])
    assert code == (2 if said else 1)  # a method that is not public is not called, and so does not answer
    assert said is None or said in capsys.readouterr().err


def test_files_that_are_no_incident_files(tmp_path, capsys):
    for name, content in (("empty", b""), ("text", b"incident\n"), ("gzip", zlib.compress(b"x\n", wbits=31))):
        (tmp_path / name).write_bytes(content)
        assert cli.main(["replay", str(tmp_path / name)]) == 2
    assert cli.main(["replay", str(tmp_path / "missing")]) == 2
    assert "is not an incident file" in capsys.readouterr().err


def test_every_call_that_changes_a_step_is_recorded():
    """A new method of `Step` is decorated with `logged`, or listed above because it changes nothing."""
    methods = {name: one for name, one in vars(Step).items() if callable(one)}
    public = {name for name in methods if not name.startswith("_")} | {"__call__"}
    assert {name for name in public if not hasattr(methods[name], "__wrapped__")} == READ_ONLY


class Looking(Controller):
    """Moves as the first of the table's things stands."""

    modes = ("looking",)
    input_dim = 2

    def __init__(self, goal):
        self._objects = (goal.name,)

    @property
    def objects(self):
        return self._objects

    def latent(self, u, context, mode):
        return u

    def action(self, z, context, mode):
        return z[..., :1] * np.resize(context.objects[0, :3], context.state.shape[-1])


def test_what_a_controller_sees_of_things_is_in_the_file(tmp_path, desk_of, setup):
    robot = setup.task.robot
    parts = [Looking(setup.task.goals[0]), EndEffectorController(robot)]
    looking = replace(setup, controller=JoinedController(parts))
    with desk_of(looking) as desk, recorded(desk, tmp_path / "out"):
        drive_straight(desk)
    again = Replay(looking)
    for line in read_calls(newest(tmp_path / "out")):
        if "call" in line:
            told = of_json(line["given"], Input, Reading, GripperReading, Stop)
            again.make(line["call"], told, of_json(line["seen"]), line.get("answer"))
    assert desk.speeds().any()
    assert again.first is None
    assert again.agreed == len(desk.records)


def test_zones_obstacles_held_things_and_limits_come_along(tmp_path, desk_of, monkeypatch):
    zone = Zone(Sphere("face", np.array([0.4, 0.0, 0.5]), 0.15), 0.05)
    wall = Box("wall", np.array([0.9, 0.0, 0.5]), np.eye(3), np.array([0.1, 1.0, 1.0]))
    limits = tmp_path / "limits.toml"
    limits.write_text("tool_speed_m_per_s = 0.5\n")
    named = RobotOptions("panda", limits=limits)
    mug = Box("mug", np.zeros(3), np.eye(3), np.full(3, 0.05))
    spec = Spec(task="reach", zones=(zone,), keep_out=(wall,), gripped=(mug,), robot=named)
    with desk_of(load_setup(spec)) as desk:
        read, holds = desk.arm.read, GripperReading(0.05, holding=True)
        monkeypatch.setattr(desk.arm, "read", lambda: replace(read(), gripper=holds))
        with recorded(desk, tmp_path / "out"):
            drive_straight(desk)
    assert desk.reports[-1].held == ("mug",)
    limits.unlink()
    assert any(line.get("call") == "hold" for line in read_calls(newest(tmp_path / "out")))
    found = replay(newest(tmp_path / "out"))
    assert found["agreed"] == found["ticks"] > 0


def test_a_stop_by_a_force_and_the_way_back_come_again(tmp_path, desk_of, setup):
    with desk_of(setup) as desk:
        read = desk.arm.read

        def pressing():
            reading = read()
            if not desk.records or desk.records[-1].command.stop is not None or reading.time_s < 0.5:
                return reading
            return replace(reading, external_torque=-1e3 * desk.records[-1].command.velocity)

        desk.arm.read = pressing
        with recorded(desk, tmp_path / "out"):
            drive_straight(desk)
    assert "force_high" in {one.command.stop.code for one in desk.records if one.command.stop is not None}
    assert any(YIELDING in one.command.limited_by for one in desk.records)
    found = replay(newest(tmp_path / "out"))
    assert found["agreed"] == found["ticks"] > 0


def test_it_can_be_switched_off(setup, tmp_path):
    assert begin_incident(replace(setup, spec=replace(setup.spec, out=tmp_path, incidents=False))) is None
    assert not list(tmp_path.iterdir())


def test_the_oldest_files_go(setup, tmp_path, monkeypatch):
    monkeypatch.setattr(incident, "KEPT_BYTES", incident.MOST_FILE_BYTES + 250)
    folder = tmp_path / "incidents"
    folder.mkdir()
    for number in range(5):
        (folder / f"2020010{number}.incident.gz").write_bytes(bytes(100))
    begin_incident(replace(setup, spec=replace(setup.spec, out=tmp_path))).close()
    left = sorted(file.name for file in folder.iterdir())
    assert left[:2] == ["20200103.incident.gz", "20200104.incident.gz"]
    assert len(left) == 3


def test_a_long_file_is_followed_by_another_one_when_the_arm_is_not_enabled(desk, tmp_path, monkeypatch):
    monkeypatch.setattr(incident, "MOST_FILE_BYTES", 4 * 50_000)  # the first quarter of which is large
    with recorded(desk, tmp_path / "out"):
        desk.run(60.0)
    assert isinstance(desk.drive.change, ChooseProfile)
    assert desk.drive.change.name == desk.setup.spec.profile
    assert newest(tmp_path / "out").stat().st_size > 50_000
    assert desk.times()[-1] < 59.0


def test_a_file_that_cannot_be_written_stops_no_arm(desk, tmp_path, capfd):
    with recorded(desk, tmp_path / "out"):
        newest(tmp_path / "out").unlink()
        drive_straight(desk)
    assert desk.speeds().any()
    assert capfd.readouterr().err.count("ends here") == 1


def test_a_folder_that_cannot_be_written_is_said(setup, tmp_path, capfd):
    (tmp_path / "out").write_text("a file")
    assert begin_incident(replace(setup, spec=replace(setup.spec, out=tmp_path / "out"))) is None
    assert "no incident file is written" in capfd.readouterr().err


ANY = st.one_of(
    st.none(),
    st.booleans(),
    st.integers(-(2**62) + 1, 2**62 - 1),
    st.floats(allow_nan=False),
    st.text(max_size=20).filter(lambda text: text.isprintable()),
)


@given(value=st.recursive(ANY, lambda inner: st.lists(inner, max_size=4).map(tuple), max_leaves=10))
def test_values_come_back_to_the_bit(value):
    assert repr(of_json(json.loads(json.dumps(to_json(value))))) == repr(value)


@given(values=st.lists(st.floats(width=64), max_size=8))
def test_arrays_come_back_to_the_bit(values):
    array = np.array(values, dtype=np.float64)
    again = of_json(json.loads(json.dumps(to_json(array))))
    assert again.tobytes() == array.tobytes()
    assert again.shape == array.shape


def test_records_come_back():
    told = Reading(np.array([math.nan, -0.0]), np.zeros(2), math.inf, 3, None, np.array([0.1, -3.0]))
    again = of_json(json.loads(json.dumps(to_json(told))), Reading)
    assert again.external_torque.tobytes() == told.external_torque.tobytes()
    assert again.q.tobytes() == told.q.tobytes()
    assert (again.time_s, again.sequence, again.gripper) == (math.inf, 3, None)
    stop = Stop("Why.", code="arm_off", parameters={"text": "off"})
    assert of_json(to_json(stop), Stop).parameters == {"text": "off"}


class Unreadable:
    @property
    def __dict__(self):
        raise RuntimeError("no")


def test_what_no_step_can_use_is_recorded_as_nothing(tmp_path):
    log = CallLog(tmp_path / "file", JournalLimits(), [])
    endless: list[object] = []
    endless.append(endless)
    for given_ in (Unreadable(), endless, object(), 10**100, Input(np.array([None, {}]))):
        log.call("sent", (given_,), lambda: None)
    log.close()
    lines = list(read_calls(tmp_path / "file"))
    assert [line["given"] for line in lines[:4]] == [[None]] * 4
