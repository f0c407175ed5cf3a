"""The setup that is driven with its arm, and the change to another one."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path
from typing import final

from latentarm.arms.contract import Arm
from latentarm.control.clock import Clock
from latentarm.runs.folder import read_run
from latentarm.web.arm_process.arm_lifecycle import next_arm
from latentarm.web.arm_process.drive_setup import SEEDS, DriveSetup, Spec, load_setup, with_profile
from latentarm.web.arm_process.steering import Steering
from latentarm.web.protocol.notice import Notice, notice_of
from latentarm.web.protocol.orders import BeginTask, Change, ChooseProfile, ChooseRun, Reconnect, Reset


@final
@dataclass(frozen=True, eq=False)
class Driven:
    """A setup, its arm, and how the arm is steered."""

    setup: DriveSetup
    arm: Arm
    steering: Steering

    def let_go(self, newer: "Driven") -> None:
        """Close the arm, unless the newer one is driven with it."""
        if self.arm is not newer.arm:
            self.arm.close()


def drive_in_turn(
    driven: Driven, drive: Callable[[Driven, Notice | None], Change | None], clock: Clock
) -> None:
    """Drive one thing after another, until ``drive`` returns None instead of an order; then close the arm.

    An order that cannot be carried out leaves the arm as it is, with a note that says why. A setup that fails
    before its arm was ever enabled gives way to the one before it.
    """
    before: Driven | None = None
    note: Notice | None = None
    try:
        while True:
            try:
                change = drive(driven, note)
            except Exception as error:
                if before is None or driven.steering.enabled:
                    raise
                before.steering.tick = driven.steering.tick
                driven.let_go(before)
                driven, before, note = before, None, notice_of(error)
                continue
            if change is None:
                return
            try:
                after, note = _changed(driven, change, clock), None
            except Exception as error:  # noqa: BLE001 - whatever a file does, the arm's process goes on
                note = notice_of(error)
                continue
            if after is driven:
                note = Notice(code="reconnected")
                continue
            if before is not None:
                before.let_go(driven)
            before, driven = driven, after
    finally:
        if before is not None:
            before.let_go(driven)
        driven.arm.close()


def _changed(driven: Driven, change: Change, clock: Clock) -> Driven:
    """Carry out an order that changes what is driven; what was driven stays as it is."""
    setup, steering = driven.setup, replace(driven.steering, enabled=False)
    spec = setup.spec
    match change:
        case Reconnect():
            driven.arm.close()
            driven.arm.connect()
            return driven
        case ChooseProfile(name=name, seat=seat):
            other = with_profile(setup, name, spec.seated(seat))
            other.step()
            return Driven(other, driven.arm, steering)
        case ChooseRun(run=run, own_task=own):
            other = spec.with_run(Path(run), own)
            if other.task_for(read_run(run)) == setup.todo.task:
                other = replace(other, choice=spec.choice)
            after = _begun(driven, other, clock)
            after.steering.mode, after.steering.axes = after.setup.first_mode(steering.help), 0
            return after
        case Reset():
            return _begun(driven, spec, clock)
        case BeginTask(choice=choice, anew=anew):
            seed = (spec.seed + anew) % SEEDS
            return _begun(
                driven, replace(spec, choice=spec.choice if choice is None else choice, seed=seed), clock
            )


def _begun(driven: Driven, spec: Spec, clock: Clock) -> Driven:
    """Begin a spec from its start, after what is driven."""
    setup = load_setup(spec)
    if setup.real:
        setup = replace(setup, start=driven.setup.start)
    arm = next_arm(setup, driven.setup, driven.arm, clock)
    # About a real arm nothing is put anywhere else.
    things = driven.steering.things if setup.real else None
    return Driven(setup, arm, replace(driven.steering, run=None, things=things, enabled=False))
