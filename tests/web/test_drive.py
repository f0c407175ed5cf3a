"""What the control process does with inputs and orders, in simulated time."""

from dataclasses import replace

import numpy as np
import pytest

from latentarm.core.types import Context
from latentarm.recordings.journal_reader import read_journal
from latentarm.web.arm_process.drive import Drive
from latentarm.web.arm_process.drive_setup import with_profile
from latentarm.web.arm_process.page_inputs import LATCH_MAX_S
from latentarm.web.arm_process.steering import Steering
from latentarm.web.protocol.notice import Notice
from latentarm.web.protocol.orders import ChooseMode, ChooseProfile, ChooseRun, Enable, Record, Reset

ADA = Notice(code="stop_pressed_by", parameters={"name": "Ada"})


def enabled_at(desk, now_s, at_s=0.1):
    """Ask to be enabled, once."""
    if abs(now_s - at_s) < 0.005:
        desk.order(Enable(driver=1, stops=desk.channel.stop.version))


def test_nothing_moves_before_enable(desk):
    desk.each_tick = lambda now_s: desk.give(1.0, 0.0)
    desk.run(1.0)
    assert not desk.speeds().any()
    assert desk.reports[-1].phase == "neutral_needed"
    assert desk.reports[-1].reason.code == "not_enabled"


def test_a_pressed_stick_cannot_be_enabled(desk):
    def tick(now_s):
        desk.give(1.0, 0.0)
        enabled_at(desk, now_s)

    desk.each_tick = tick
    desk.run(1.0)
    assert not desk.speeds().any()


def test_it_drives_and_stops_in_time_when_inputs_cease(desk):
    def tick(now_s):
        enabled_at(desk, now_s)
        if now_s < 1.5:
            desk.give(0.0 if now_s < 0.5 else 1.0, 0.0)

    desk.each_tick = tick
    desk.run(2.5)
    moving = desk.times()[desk.speeds() > 0.0]
    assert 0.5 <= moving[0] <= 0.52
    assert moving[-1] - 1.5 < 0.15
    assert desk.reports[-1].phase == "disengaged"


@pytest.mark.parametrize("stale", ["old nonce", "no nonce", "same number"])
def test_stale_inputs_do_not_count(desk, stale):
    def tick(now_s):
        enabled_at(desk, now_s)
        u = 0.0 if now_s < 0.5 else 1.0
        if now_s < 1.0:
            desk.give(u, 0.0)
            return
        if stale == "same number":
            desk.sequence = 10
        nonce = {"old nonce": desk.reports[0].nonce, "no nonce": "0" * 32}.get(stale)
        desk.give(u, 0.0, nonce=nonce)

    desk.each_tick = tick
    desk.run(2.0)
    assert desk.speeds()[(desk.times() > 0.9) & (desk.times() < 1.0)].min() > 0.0
    assert not desk.speeds()[desk.times() > 1.0 + 0.15].any()


def test_stop_works_while_the_pipe_of_orders_is_full(desk):
    def tick(now_s):
        enabled_at(desk, now_s)
        desk.give(0.0 if now_s < 0.5 else 1.0, 0.0)
        for _ in range(6):  # more than are read in a tick
            desk.order(ChooseMode(mode="latent", axes=None))
        if abs(now_s - 1.0) < 0.005:
            desk.channel.stop.write(ADA.model_dump_json().encode())

    desk.each_tick = tick
    desk.run(1.5)
    stopped = desk.times()[desk.speeds() > 0.0].max()
    assert 1.0 < stopped < 1.15
    assert desk.reports[-1].reason == ADA


def test_after_a_stop_the_stick_must_be_let_go_and_enable_pressed(desk):
    def tick(now_s):
        for at_s in (0.1, 1.2, 2.0):
            enabled_at(desk, now_s, at_s)
        desk.give(1.0 if 0.5 < now_s < 1.6 or now_s > 2.3 else 0.0, 0.0)
        if abs(now_s - 1.0) < 0.005:
            desk.channel.stop.write(b"Stop.")

    desk.each_tick = tick
    desk.run(3.0)
    moving = desk.times()[desk.speeds() > 0.0]
    assert not ((moving > 1.15) & (moving < 2.3)).any()
    assert (moving > 2.4).any()


def test_an_enable_that_was_pressed_before_stop_counts_for_nothing(desk):
    def tick(now_s):
        desk.give(0.0, 0.0)
        if abs(now_s - 0.5) < 0.005:
            before = desk.channel.stop.version
            desk.channel.stop.write(b"Stop.")
            desk.order(Enable(driver=1, stops=before))

    desk.each_tick = tick
    desk.run(1.5)
    assert {report.phase for report in desk.reports} == {"disengaged"}


def test_a_stop_that_is_pressed_again_is_still_told_of_the_first(desk):
    """In words of every language, not in the sentence that was made of it."""
    bob = Notice(code="stop_pressed_by", parameters={"name": "Bob"})

    def tick(now_s):
        enabled_at(desk, now_s)
        desk.give(0.0, 0.0)
        for at_s, who in ((0.5, ADA), (0.6, bob)):
            if abs(now_s - at_s) < 0.005:
                desk.channel.stop.write(who.model_dump_json().encode())

    desk.each_tick = tick
    desk.run(0.8)
    assert desk.reports[-2].reason == ADA


def test_latched_motion_ends(desk):
    def tick(now_s):
        enabled_at(desk, now_s)
        desk.give(0.0 if now_s < 0.5 else 0.05, 0.0, latched=True)

    desk.each_tick = tick
    desk.run(LATCH_MAX_S + 1.5)
    moving = desk.times()[desk.speeds() > 0.0]
    assert LATCH_MAX_S - 0.05 < moving[-1] - moving[0] < LATCH_MAX_S + 0.15
    assert desk.reports[-1].reason.code == "latch_ended"


def test_a_drive_goes_on_in_the_mode_of_the_one_before(desk):
    """A run that is begun again, and another person's directions, leave the mode as pages show it."""
    steering = Steering("end_effector", axes=2)
    on = (desk.arm, desk.channel, desk.clock, desk.writer, lambda: False, steering)
    desk.drive = Drive(desk.setup, *on, observers=[desk._saw])
    desk.run(0.2)
    assert {(report.mode, report.axes) for report in desk.reports} == {("end_effector", 2)}
    assert {record.mode for record in desk.records} == {3}


def test_switching_modes_never_makes_the_arm_jump(desk):
    orders = {
        0.8: ChooseMode(mode="end_effector", axes=0),
        1.1: ChooseMode(mode="end_effector", axes=2),
        1.4: ChooseMode(mode="assisted", axes=None),
        1.7: ChooseMode(mode="latent", axes=None),
    }

    def tick(now_s):
        enabled_at(desk, now_s)
        # Let go for a moment after each change, as one must.
        pushed = now_s >= 0.5 and not any(0.02 < now_s - at_s < 0.06 for at_s in orders)
        desk.give(1.0 if pushed else 0.0, 0.0)
        for at_s, order in orders.items():
            if abs(now_s - at_s) < 0.005:
                desk.order(order)

    desk.each_tick = tick
    desk.run(2.0)
    commands = np.array([record.command.velocity for record in desk.records])
    driven = desk.times() < 2.0
    gained = np.abs(np.diff(commands[driven], axis=0))
    # Letting go is as hard as a stop.
    assert (gained <= 0.8 * desk.setup.task.robot.limits.acceleration * 0.01 + 1e-9).all()
    assert {record.mode for record in desk.records} == {0, 1, 3}
    assert desk.speeds()[(desk.times() > 1.9) & driven].min() > 0.0
    helped = [record.alpha > 0.0 for record in desk.records if 1.5 < record.time_s < 1.7]
    assert all(helped)
    assert not any(record.alpha for record in desk.records if record.time_s < 1.4)


@pytest.mark.parametrize("latched", [False, True])
@pytest.mark.parametrize(
    "order",
    [
        ChooseMode(mode="end_effector", axes=0),
        ChooseMode(mode="end_effector", axes=2),
        ChooseMode(mode="assisted", axes=None),
    ],
)
def test_a_new_mode_needs_a_stick_that_was_let_go(desk, order, latched):
    def tick(now_s):
        enabled_at(desk, now_s)
        pushed = 0.5 <= now_s < 1.5 or now_s > 1.7
        desk.give(1.0 if pushed else 0.0, 0.0, latched=latched)
        if abs(now_s - 1.0) < 0.005:
            desk.order(order)

    desk.each_tick = tick
    desk.run(2.2)
    times, speeds = desk.times(), desk.speeds()
    assert speeds[(times > 0.8) & (times < 1.0)].min() > 0.0
    assert not speeds[(times > 1.0 + 0.15) & (times < 1.7)].any()
    assert speeds[(times > 2.0) & (times < 2.2)].min() > 0.0
    waiting = [report.time_s for report in desk.reports if report.let_go_first]
    assert 1.0 <= waiting[0] < 1.03
    assert 1.48 < waiting[-1] < 1.53
    # The arm is enabled all the while.
    assert {report.reason for report in desk.reports if 0.3 < report.time_s < 2.1} == {None}


def test_the_mode_that_is_on_already_stops_nobody(desk):
    def tick(now_s):
        enabled_at(desk, now_s)
        desk.give(1.0 if now_s >= 0.5 else 0.0, 0.0)
        if abs(now_s - 1.0) < 0.005:
            desk.order(ChooseMode(mode="latent", axes=None))

    desk.each_tick = tick
    desk.run(1.5)
    assert desk.speeds()[(desk.times() > 0.8) & (desk.times() < 1.5)].min() > 0.0


def test_another_driver_finds_a_stopped_arm(desk):
    def tick(now_s):
        enabled_at(desk, now_s)
        desk.give(0.0 if now_s < 0.5 else 1.0, 0.0, driver=1 if now_s < 1.0 else 2)

    desk.each_tick = tick
    desk.run(2.0)
    assert not desk.speeds()[desk.times() > 1.15].any()
    assert desk.reports[-1].driver == 2


def test_an_orphan_brings_the_arm_to_rest_and_ends(desk):
    def tick(now_s):
        enabled_at(desk, now_s)
        desk.give(0.0 if now_s < 0.5 else 1.0, 0.0)
        desk.orphaned = now_s > 1.0

    desk.each_tick = tick
    desk.drive.run()
    assert desk.clock.now_s() < 1.2
    assert not desk.records[-1].command.velocity.any()
    assert desk.drive.change is None


@pytest.mark.parametrize("order", [Reset(), ChooseProfile(name="ada"), ChooseRun(run="other", own_task=True)])
def test_what_changes_the_setting_waits_for_a_stopped_arm(desk, order):
    def tick(now_s):
        enabled_at(desk, now_s)
        desk.give(0.0, 0.0)
        if abs(now_s - 0.5) < 0.005:
            desk.order(order)
        if abs(now_s - 0.7) < 0.005:
            desk.channel.stop.write(b"Stop.")
        if abs(now_s - 1.0) < 0.005:
            desk.order(order)

    desk.each_tick = tick
    desk.drive.run()
    assert 0.99 < desk.clock.now_s() < 1.05
    assert desk.drive.change == order
    assert "stop_first" in {report.note.code for report in desk.reports if report.note is not None}
    # Nothing more is said until it is there, and that is said.
    assert [report.loading for report in desk.reports[-2:]] == [False, True]


@pytest.mark.parametrize(("started", "seat"), [("facing", "facing"), ("behind", None), (None, "behind")])
def test_the_stick_stays_for_the_same_seat_and_where_it_is_never_turned(setup, desk_of, started, seat):
    with desk_of(replace(setup, spec=replace(setup.spec, seat=started))) as desk:

        def tick(now_s):
            enabled_at(desk, now_s)
            desk.give(0.0, 0.0)
            if abs(now_s - 0.5) < 0.005:
                desk.order(ChooseProfile(name=None, seat=seat))

        desk.each_tick = tick
        desk.run(1.0)
        assert desk.drive.change is None
        assert not any(report.note for report in desk.reports[-20:])


def test_another_seat_waits_for_a_stopped_arm(setup, desk_of):
    order = ChooseProfile(name=None, seat="behind")
    with desk_of(replace(setup, spec=replace(setup.spec, seat="facing"))) as desk:

        def tick(now_s):
            enabled_at(desk, now_s)
            desk.give(0.0, 0.0)
            if min(abs(now_s - 0.5), abs(now_s - 1.0)) < 0.005:
                desk.order(order)
            if abs(now_s - 0.7) < 0.005:
                desk.channel.stop.write(b"Stop.")

        desk.each_tick = tick
        desk.drive.run()
        assert desk.clock.now_s() > 0.99
        assert desk.drive.change == order


def test_another_seat_turns_the_stick(setup):
    u, here = np.array([1.0, 0.0]), Context(setup.start, np.empty(0))
    facing, behind = (
        with_profile(setup, None, seat).controller.latent(u, here, 0) for seat in ("facing", "behind")
    )
    assert np.abs(facing - behind).max() > 0.5


def test_an_episode_ends_before_the_arm_is_put_back(desk):
    def tick(now_s):
        enabled_at(desk, now_s)
        desk.give(1.0 if 0.5 <= now_s < 1.0 else 0.0, 0.0)
        if abs(now_s - 0.3) < 0.005:
            desk.order(Record(on=True, task=""))
        if abs(now_s - 1.5) < 0.005:
            desk.channel.stop.write(ADA.model_dump_json().encode())
        if abs(now_s - 2.0) < 0.005:
            desk.order(Reset())

    desk.each_tick = tick
    desk.drive.run()
    desk.writer.close()
    assert desk.drive.change == Reset()
    assert desk.writer.status.episodes == 1
    assert not desk.writer.status.on


@pytest.mark.parametrize("u", [(1.0, 0.0), (0.0, 1.0), (-1.0, -1.0)])
def test_whoever_lets_go_finds_the_arm_at_rest(desk, u):
    def tick(now_s):
        enabled_at(desk, now_s)
        desk.give(*(u if 0.5 <= now_s < 1.4 else (0.0, 0.0)))

    desk.each_tick = tick
    desk.run(2.0)
    moving = desk.times()[desk.speeds() > 0.0]
    assert moving[-1] - 1.4 < 0.15
    # Enabled all the while: only the end of the loop has stopped it.
    assert all(record.command.stop is None for record in desk.records if 0.6 < record.time_s < 1.9)


def test_an_episode_is_in_the_journal(desk, tmp_path):
    def tick(now_s):
        enabled_at(desk, now_s)
        desk.give(1.0 if 0.5 <= now_s < 1.4 else 0.0, 0.0)
        if abs(now_s - 0.3) < 0.005:
            desk.order(Record(on=True, task="stab the carrot", person="Ada"))
        if abs(now_s - 1.3) < 0.005:
            desk.order(Record(on=False, task=""))

    desk.each_tick = tick
    desk.run(2.0)
    desk.writer.close()
    (path,) = (tmp_path / "teleop").glob("*.sqlite")
    (episode,) = read_journal(path)
    assert episode.complete
    assert episode.header.task == "stab the carrot"
    by = episode.header.provenance
    assert (by.person, by.device, by.controller) == ("Ada", "keyboard", "latent")
    assert not episode.records[-1].command.velocity.any()
    assert len(episode.records) == desk.reports[-1].recording.samples == pytest.approx(115, abs=10)
    assert desk.writer.status.episodes == 1


def test_a_disk_that_cannot_be_written_ends_the_recording_and_not_the_drive(desk, tmp_path):
    (tmp_path / "teleop").write_text("no folder")

    def tick(now_s):
        enabled_at(desk, now_s)
        desk.give(0.0 if now_s < 0.5 else 1.0, 0.0)
        if abs(now_s - 0.3) < 0.005:
            desk.order(Record(on=True, task=""))

    desk.each_tick = tick
    desk.run(2.0)
    desk.writer.close()
    assert "cannot be written" in desk.writer.status.problem.text
    assert not desk.writer.status.on
    assert desk.speeds()[desk.times() > 1.0].max() > 0.0
