"""What an arm was told on the page is kept, and gives the same commands again, to the bit."""

import gzip
import json
import os
import signal
import subprocess
import sys
from contextlib import contextmanager
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from latentarm import cli
from latentarm.control.step import Step
from latentarm.web.arm_process.drive import Drive
from latentarm.web.arm_process.incident import begin_incident
from latentarm.web.arm_process.replay import replay
from latentarm.web.arm_process.steering import Steering
from latentarm.web.protocol.orders import ChooseHelp, ChooseMode, Enable, PoseToGoTo, Return


@contextmanager
def kept(desk, setup=None):
    """The desk's drive, recorded; gives the file's folder."""
    setup = setup or desk.setup
    folder = desk.writer._folder
    setup = replace(setup, spec=replace(setup.spec, out=folder))
    calls = begin_incident(setup)
    desk.drive = Drive(
        setup,
        desk.arm,
        desk.channel,
        desk.clock,
        desk.writer,
        lambda: desk.orphaned,
        Steering(setup.modes[0]),
        observers=[desk._saw],
        calls=calls,
    )
    yield folder / "incidents"
    calls.close()


def only_file(folder):
    (file,) = folder.glob("*.incident.gz")
    return file


def drive_about(desk, seed, for_s):
    """Anything that a person and an arm can do, at random."""
    rng = np.random.default_rng(seed)
    u = [0.0, 0.0]

    def tick(now_s):
        nonlocal u
        if rng.random() < 0.03:
            u = [0.0, 0.0] if rng.random() < 0.5 else list(rng.uniform(-1.0, 1.0, 2))
        ask = rng.choice(["open", "close"]) if rng.random() < 0.02 else None
        if rng.random() > 0.01:
            desk.give(*u, gripper=ask)
        event = rng.random()
        if event < 0.05:
            desk.order(Enable(driver=1, stops=desk.channel.stop.version))
        elif event < 0.06:
            desk.order(ChooseMode(mode=str(rng.choice(desk.setup.modes)), axes=int(rng.integers(3))))
        elif event < 0.07:
            desk.order(ChooseHelp(level=str(rng.choice(["off", "low", "high"]))))
        elif event < 0.08:
            q = tuple((desk.setup.start + rng.uniform(-0.2, 0.2, len(desk.setup.start))).tolist())
            desk.order(Return(on=True, pose=PoseToGoTo(name="there", q=q)))
        elif event < 0.083:
            desk.channel.stop.write(b"{}")

    desk.each_tick = tick
    desk.run(for_s)


@pytest.mark.parametrize("seed", range(4))
def test_a_drive_gives_the_same_commands_again(desk, seed):
    with kept(desk) as folder:
        drive_about(desk, seed, 12.0)
    done = replay(only_file(folder))
    assert desk.speeds().any()
    assert done.first is None
    assert done.complete
    assert done.ticks == len(desk.records)
