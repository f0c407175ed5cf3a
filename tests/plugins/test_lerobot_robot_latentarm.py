"""LeRobot's tools with an arm of ours: what comes of actions, and the whole way there and back."""

import json
import socket
import subprocess
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

from latentarm.arms.helper_process import MessagePort
from latentarm.robots.catalogue import load_robot
from lerobot_environment import ROOT, lerobot_python, plugin_environment


@pytest.fixture
def ports() -> Iterator[tuple[MessagePort, MessagePort]]:
    ours, theirs = socket.socketpair(socket.AF_UNIX, socket.SOCK_SEQPACKET)
    yield MessagePort(ours), MessagePort(theirs)
    ours.close()
    theirs.close()


@pytest.fixture
def inputs(monkeypatch: pytest.MonkeyPatch) -> type:
    monkeypatch.syspath_prepend(str(ROOT / "plugins/lerobot_robot_latentarm/src"))
    from latentarm_process.inputs import PortInputs

    return PortInputs


def test_messages_are_whole_and_nobody_waits(ports: tuple[MessagePort, MessagePort]) -> None:
    ours, theirs = ports
    assert theirs.receive() is None
    sent = 0
    while ours.send({"number": sent, "text": "x" * 1000}):  # until the other end no longer takes any
        sent += 1
    assert [theirs.receive()["number"] for _ in range(sent)] == list(range(sent))
    ours.close()
    with pytest.raises(EOFError):
        theirs.receive(wait_s=1.0)
    assert not theirs.send({})


def test_an_action_counts_from_when_it_was_sent(ports: tuple[MessagePort, MessagePort], inputs: type) -> None:
    ours, theirs = ports
    gone: list[bool] = []
    source = inputs(theirs, 2, lambda message: None, lambda: gone.append(True))
    given, age_s = source.latest(10.0)
    assert age_s == 0.0
    assert not given.u.any()
    ours.send({"u": [0.5, 0.0], "gripper": "close", "sent_s": 10.0})
    ours.send({"u": [1.0, 0.0], "gripper": None, "sent_s": 10.03})
    given, age_s = source.latest(10.05)
    assert given.u.tolist() == [1.0, 0.0]
    assert given.gripper == "close"
    assert age_s == pytest.approx(0.02)
    assert source.latest(10.06)[0].gripper is None
    assert source.latest(10.5)[1] == pytest.approx(0.47)
    ours.send({"u": [1.0, 0.0], "gripper": None, "sent_s": 99.0})  # the clock has gone back
    assert source.latest(11.0)[1] == np.inf
    ours.close()
    source.latest(11.1)
    assert gone


def test_only_fresh_neutral_actions_for_half_a_second_count_as_letting_go(
    ports: tuple[MessagePort, MessagePort], inputs: type
) -> None:
    ours, theirs = ports
    source = inputs(theirs, 1, lambda message: None, lambda: None)

    def let_go(push: float, seconds: float, from_s: float) -> bool:
        for tick in range(round(100 * seconds)):
            now_s = from_s + 0.01 * tick
            ours.send({"u": [push], "gripper": None, "sent_s": now_s})
            source.latest(now_s)
            done = source.let_go(now_s, 0.02, 0.05)
        return done

    assert not source.let_go(0.0, 0.02, 0.05)
    assert not let_go(0.5, 1.0, from_s=10.0)
    assert not let_go(0.0, 0.4, from_s=20.0)
    assert not let_go(0.5, 0.1, from_s=20.4)
    assert let_go(0.0, 0.6, from_s=20.5)
    source.latest(30.0)
    assert not source.let_go(30.0, 0.02, 0.05)


def _so101(folder: Path) -> Path:
    """A model with the joints of an SO-101 and shapes of simple bodies."""
    axes = {"shoulder_pan": "0 0 1", "shoulder_lift": "0 1 0", "elbow_flex": "0 1 0", "wrist_flex": "0 1 0"}
    bodies = "".join(
        f'<body pos="0 0 0.12"><joint name="{name}" axis="{axis}" range="-1.7 1.7" actuatorfrcrange="-3 3"/>'
        '<geom type="capsule" size="0.015" fromto="0 0 0.02 0 0 0.09" mass="0.1"/>'
        for name, axis in {**axes, "wrist_roll": "0 0 1"}.items()
    )
    jaw = (
        '<site name="tool" pos="0 0 0.1"/><body pos="0.02 0 0.02"><joint name="gripper" axis="0 1 0"'
        ' range="-0.17 1.75"/><geom type="capsule" size="0.005" fromto="0 0 0 0 0 0.05" mass="0.03"/></body>'
    )
    path = folder / "so101.xml"
    path.write_text(
        f'<mujoco model="so101"><compiler angle="radian"/><worldbody>{bodies}{jaw}{"</body>" * 5}</worldbody>'
        "</mujoco>"
    )
    return path


@pytest.mark.slow
def test_from_an_so101_dataset_to_driving_and_back_through_lerobots_tools(tmp_path: Path) -> None:
    python = lerobot_python()
    wheel = tmp_path / "wheel"
    wheel.mkdir()
    model = _so101(tmp_path)
    assert load_robot(str(model)).dof == 5
    done = subprocess.run(
        [python, str(Path(__file__).with_name("lerobot_round_trip.py")), str(tmp_path / "out"), str(model)],
        env=plugin_environment(wheel),
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr[-3000:]
    figures = json.loads((tmp_path / "out/figures.json").read_text())
    assert "--units deg" in figures["refused without a unit"]
    assert figures["replay"]["frames"] > 50
    assert figures["replay"]["joints moved, rad"] > 0.05
    assert figures["replay"]["apart, most, rad"] < 0.1
    assert figures["lerobot-dataset-viz, bytes"] > 1000
    assert figures["episodes imported"] == 3
    assert max(figures["recording by servos"]["joints moved, rad"]) > 0.05
    for way in ("driven from the SO-101 dataset", "driven from what was recorded"):
        assert figures[way]
