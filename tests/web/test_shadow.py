"""Shadow mode: a person drives on a real arm's readings, and the arm is told nothing."""

import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from rosbridge_server import RosbridgeServer
from wooden_server import wooden_server

from arms.xarm_rig import HERE
from arms.xarm_server import serving
from latentarm.cli import main
from latentarm.control.clock import MonotonicClock
from latentarm.control.input_port import InputSource
from latentarm.control.loop import ControlLoop
from latentarm.core.errors import UserError
from latentarm.core.types import FloatArray, Input, StepRecord
from latentarm.demonstrations.dataset import read_dataset, write_dataset
from latentarm.recordings.dataset_export import demonstrations_of
from latentarm.recordings.journal_reader import read_journal
from latentarm.robots.panda import panda
from latentarm.web.arm_process.arm_lifecycle import first_arm
from latentarm.web.arm_process.drive_setup import DriveSetup, Spec, load_setup
from latentarm.web.arm_process.initial_state import RobotOptions
from latentarm.web.arm_process.speed_limits import Speeds

pytestmark = pytest.mark.clock

XARM7 = RobotOptions(str(HERE / "xarm7.xml"), limits=HERE / "xarm7.toml")
SLOW = Speeds(joint=0.3)
XARM_HOME = [0.0, -0.4, 0.0, 0.9, 0.0, 1.3, 0.0]
XARM_READS = {1, 13, 15, 42, 44, 124}
"""Registers that change nothing: version, state, errors, joints, forward kinematics, the tool's bus."""


class Real:
    """A stand-in: its address, where it is, what it was told that was no question, and a push by hand."""

    def __init__(
        self,
        address: str,
        robot: RobotOptions,
        positions: Callable[[], FloatArray],
        orders: Callable[[], list[Any]],
    ) -> None:
        self.spec = Spec(arm=address, robot=robot, speeds=SLOW, shadow=True, found=(("firmware", "2.1"),))
        self.positions, self.orders = positions, orders


@contextmanager
def wooden() -> Iterator[Real]:
    with wooden_server(panda()) as server:
        yield Real(
            server.address,
            RobotOptions("panda"),
            server.positions,
            lambda: [one for one in server.requests if one not in ("hello", "read")],
        )


@contextmanager
def xarm() -> Iterator[Real]:
    with serving(q=XARM_HOME) as server:
        yield Real(
            server.address(),
            XARM7,
            lambda: np.array(server.do("state")["q"]),
            lambda: [one for one in server.do("requests") if one not in XARM_READS],
        )


@contextmanager
def ros2() -> Iterator[Real]:
    with RosbridgeServer(panda()) as server:
        yield Real(
            server.address,
            RobotOptions("panda"),
            server.positions,
            lambda: [one for one in server.told if not one.endswith("list_controllers")],
        )


@pytest.mark.parametrize("stand_in", [wooden, xarm, ros2])
def test_a_drive_is_computed_and_recorded_and_not_one_command_is_sent(
    serve: Any, stand_in: Callable[[], Any], tmp_path: Path
) -> None:

    with stand_in() as arm:
        stood = arm.positions()
        with serve(replace(arm.spec, out=tmp_path)) as site, site.page() as page:
            assert page.welcome["real"]["shadow"]
            assert page.state["guiding"] is None
            page.enable()
            page.send(type="record", on=True, task="push")
            page.wait(lambda state: state["recording"] and state["recording"]["on"])
            page.u = [1.0, 0.0]
            page.wait(lambda state: state["phase"] == "moving")
            begun_s = time.monotonic()
            while time.monotonic() - begun_s < 3.0:
                # A busy computer may stop the drive, as any.
                if page.state["phase"] not in ("moving", "ready"):
                    assert page.state["reason"]["code"] in ("loop_late", "input_late", "reading_old")
                    page.enable()
                    page.u = [1.0, 0.0]
                time.sleep(0.02)
            page.u = [0.0, 0.0]
            page.wait(lambda state: state["phase"] != "moving")
            page.send(type="record", on=False)
            page.wait(lambda state: not state["recording"]["on"])
            page.send(type="return", on=True)
            page.wait(lambda state: state["note"] and state["note"]["code"] == "shadow_stays")
            page.send(type="stop")
            page.wait(lambda state: state["phase"] == "disengaged")
        assert arm.orders() == []
        np.testing.assert_allclose(arm.positions(), stood, atol=1e-9)
    assert not list((tmp_path / "records" / "guests").glob("*.json"))  # nobody has driven an arm
    (journal,) = tmp_path.glob("*.sqlite")
    (episode,) = read_journal(journal)
    assert episode.header.provenance.shadow
    assert max(float(np.abs(one.command.velocity).max()) for one in episode.records) > 0.02
    write_dataset(demonstrations_of(read_journal(journal), source="drive"), tmp_path / "dataset")
    exported = read_dataset(tmp_path / "dataset")
    assert exported.episodes[0].provenance is not None
    assert exported.episodes[0].provenance.shadow
    assert exported.warnings == [
        "1 of 1 episodes are from shadow mode: the arm did not follow their actions."
    ]
    assert demonstrations_of([episode], source="journal").warnings == exported.warnings


class Push(InputSource):
    """A person who lets go for a moment, and then pushes."""

    def __init__(self) -> None:
        self.since_s: float | None = None

    def latest(self, now_s: float) -> tuple[Input, float]:
        self.since_s = now_s if self.since_s is None else self.since_s
        push = [1.0, 0.0] if now_s - self.since_s > 0.2 else [0.0, 0.0]
        return Input(np.array(push)), 0.0


def driven(setup: DriveSetup, each: Callable[[StepRecord], None]) -> list[StepRecord]:
    """Half a second of a push, from the loop itself."""
    records: list[StepRecord] = []
    arm = first_arm(setup, MonotonicClock())
    loop = ControlLoop(setup.step(), arm, Push(), MonotonicClock(), [records.append, each])
    try:
        loop.enable()
        loop.run(120)
    finally:
        arm.close()
    return records


def test_a_shadow_goes_on_while_the_arm_stands_and_while_somebody_else_moves_it() -> None:
    with wooden_server(panda()) as server:
        setup = load_setup(Spec(arm=server.address, robot=RobotOptions("panda"), shadow=True))
        server.guiding = True  # by a mode of the arm's own
        by = np.linspace(0.002, 0.004, 7)

        def moved(record: StepRecord) -> None:
            if len(seen) > 60:
                server.guiding = True
                server.push(by)
            seen.append(record)

        seen: list[StepRecord] = []
        records = driven(setup, moved)
        assert np.abs(records[-10].state - records[0].state).max() > 0.1
        stops = {record.command.stop.code for record in records[30:-20] if record.command.stop is not None}
        assert stops <= {"loop_late"}
        assert max(float(np.abs(record.command.velocity).max()) for record in records) > 0.02


def test_an_arm_that_follows_is_never_driven_without_the_check_that_it_does() -> None:
    with wooden_server(panda()) as server:
        shadow = load_setup(Spec(arm=server.address, robot=RobotOptions("panda"), shadow=True))
        real = load_setup(Spec(arm=server.address, robot=RobotOptions("panda")))
        arm = first_arm(real, MonotonicClock())
        try:
            with pytest.raises(ValueError, match="follows its commands"):
                ControlLoop(shadow.step(), arm, Push(), MonotonicClock())
        finally:
            arm.close()


def test_an_emergency_stop_and_a_fault_stop_the_shadow_and_are_not_cleared_by_it() -> None:
    with serving(q=XARM_HOME) as server:
        setup = load_setup(Spec(arm=server.address(), robot=XARM7, speeds=SLOW, shadow=True))
        arm = first_arm(setup, MonotonicClock())
        try:
            arm.enable()
            assert arm.status().takes_commands
            server.do("press")
            end_s = time.monotonic() + 5.0
            while arm.status().phase != "emergency_stop":
                assert time.monotonic() < end_s
                time.sleep(0.01)
            time.sleep(0.8)
            arm.recover()
            arm.enable()
            assert not arm.status().takes_commands
            time.sleep(0.2)
        finally:
            arm.close()
        assert set(server.do("requests")) <= XARM_READS


def test_a_shadow_needs_a_real_arm(capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(UserError, match="--shadow watches a real arm"):
        Spec(shadow=True)
    assert main(["teleop", "--shadow"]) == 2
    assert "name its address with --arm" in capsys.readouterr().err
