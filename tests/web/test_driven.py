"""What a page asks for and the arm cannot do: said in a sentence, while the arm goes on as it is."""

import json
import shutil
from multiprocessing import Pipe

import numpy as np
import pytest
from wooden_server import wooden_server

from latentarm.arms.address import is_address
from latentarm.arms.kinematic import KinematicArm
from latentarm.control.clock import MonotonicClock, SimulatedClock
from latentarm.robots.panda import panda
from latentarm.web.arm_process.arm_lifecycle import first_arm
from latentarm.web.arm_process.drive import Drive
from latentarm.web.arm_process.drive_setup import Spec, load_setup
from latentarm.web.arm_process.driven import Driven, drive_in_turn
from latentarm.web.arm_process.episode_writer import EpisodeWriter
from latentarm.web.arm_process.initial_state import RobotOptions
from latentarm.web.arm_process.steering import Steering
from latentarm.web.protocol.channel import Channel
from latentarm.web.protocol.orders import BeginTask, ChooseProfile, ChooseRun, Reset
from latentarm.web.protocol.report import Report


def test_what_fails_before_it_was_enabled_gives_way_to_what_was_driven_before(trained):
    """A random walk over changes: some cannot be loaded, some fail as soon as they are driven."""
    rng = np.random.default_rng(0)
    clock = SimulatedClock()
    setup = load_setup(Spec(trained))
    closed, notes, good = [], [], []

    class Counted(KinematicArm):
        def close(self):
            closed.append(self)

    def drive(driven, note):
        notes.append(note)
        if len(notes) > 16:
            return None
        assert driven.arm not in closed, "an arm that was let go of is driven"
        failed = note is not None and "this fails" in note.text
        assert not failed or driven.setup is good[-1]
        if good and driven.setup is not good[-1] and rng.random() < 0.5:
            raise RuntimeError("this fails")
        good.append(driven.setup)
        orders = [Reset(), BeginTask(choice=int(rng.integers(5)), anew=True), ChooseProfile(name="nobody")]
        orders += [ChooseRun(run=run, own_task=True) for run in (str(trained), "/no/such")]
        return orders[rng.integers(len(orders))]

    first = Driven(setup, Counted(setup.task.robot, setup.start, clock.now_s), Steering("latent"))
    drive_in_turn(first, drive, clock)
    for text in ("this fails", "/no/such", "nobody"):
        assert any(note is not None and text in note.text for note in notes)


def test_a_failure_of_what_was_enabled_ends_the_arms_process(trained):
    clock = SimulatedClock()
    setup = load_setup(Spec(trained))

    def drive(driven, note):
        if driven.setup is setup:
            return Reset()
        driven.steering.enabled = True
        raise RuntimeError("in motion")

    with pytest.raises(RuntimeError, match="in motion"):
        drive_in_turn(Driven(setup, first_arm(setup, clock), Steering("latent")), drive, clock)


@pytest.fixture(
    scope="module", params=[pytest.param("kinematic", marks=pytest.mark.slow), "mujoco", "wooden"]
)
def arm(request):
    """An address or a name of each kind of arm that starts without hardware."""
    if request.param != "wooden":
        yield request.param
        return
    with wooden_server(panda()) as server:
        yield server.address


def run_for(trained, folder, **changes):
    path = shutil.copytree(trained, folder) / "config.json"
    path.write_text(json.dumps(json.loads(path.read_text()) | changes))
    return ChooseRun(run=str(folder), own_task=True)


def test_no_order_ends_an_arms_process(arm, trained, tmp_path):
    asked = [BeginTask(choice=choice, anew=True) for choice in (0, 9)]
    asked += [run_for(trained, tmp_path / task, task=task) for task in ("marshmallows", "held_out")]
    asked += [run_for(trained, tmp_path / "robot", robot="planar_arm"), ChooseProfile(name="nobody"), Reset()]
    clock, writer, orders = MonotonicClock(), EpisodeWriter(tmp_path), iter(asked)
    reading, _ = Pipe(duplex=False)
    channel = Channel(reading)
    reports = []

    def drive(driven, note):
        # Long enough for all that is done now and then.
        given = (driven.setup, driven.arm, channel, clock, writer, lambda: False, driven.steering, note)
        Drive(*given).run(30)
        reports.append(Report.parse(channel.report.read()[1]))
        return next(orders, None)

    # A real arm is driven only as a robot that is named.
    setup = load_setup(Spec(arm=arm, robot=RobotOptions("panda" if is_address(arm) else None), out=tmp_path))
    drive_in_turn(Driven(setup, first_arm(setup, clock), Steering("end_effector")), drive, clock)
    assert len(reports) == len(asked) + 1
    assert {report.phase for report in reports} == {"disengaged"}
    assert any(report.note is not None for report in reports), "what cannot be done is said"
