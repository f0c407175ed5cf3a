"""`arms check --guided`: the model is compared with the arm at poses that a person moves it to."""

import json
from io import StringIO

import numpy as np
import pytest
from rosbridge_server import RosbridgeServer, Setup
from wooden_server import wooden_server

from latentarm.cli import main
from latentarm.commands import arms as commands
from latentarm.robots.panda import panda


@pytest.mark.clock
def test_a_person_guides_the_arm_to_three_poses_where_one_cannot_tell_joints_apart(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    with RosbridgeServer(panda(), Setup(describes=False)) as server:
        server.arm.q[:] = [0.0, 0.0, 0.0, -1.5, 0.0, 1.5, 0.0]
        words = ["arms", "check", server.address, "--robot", "panda", "--json"]
        assert main(words) == 0
        told = capsys.readouterr()
        assert "does not tell apart joint1 and joint2" in told.out
        asked: list[str] = []

        by = np.array([0.2, 0.3, 0.4, 0.25, 0.35, 0.45, 0.5])

        def move(what: str) -> None:
            asked.append(what)
            server.arm.q[:] += by

        monkeypatch.setattr(commands, "_ask", move)
        assert main([*words, "--guided"]) == 0
        facts = {one["name"]: one["value"] for one in json.loads(capsys.readouterr().out)["facts"]}
        assert len(asked) == 3
        assert "the arm's own mode" in asked[0]
        assert "tell apart" not in facts["tool pose 3"]


@pytest.mark.clock
def test_an_arm_that_can_be_guided_is_let_go_only_while_the_person_is_asked(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    with wooden_server(panda()) as server:
        asked: list[bool] = []

        def move(what: str) -> None:
            asked.append(server.guiding and "hold it" in what)
            server.push(np.full(7, 0.1))

        monkeypatch.setattr(commands, "_ask", move)
        assert main(["arms", "check", server.address, "--robot", "panda", "--guided"]) == 0
        assert asked == [True] * 3
        assert not server.guiding
        assert {"enable", "send"}.isdisjoint(server.requests)
        held = server.positions()
        np.testing.assert_allclose(held, panda().home + 0.3, atol=1e-9)
    capsys.readouterr()


def test_guiding_needs_a_person(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    monkeypatch.setattr("sys.stdin", StringIO())
    with wooden_server(panda()) as server:
        assert main(["arms", "check", server.address, "--robot", "panda", "--guided"]) == 2
        assert not server.guiding
    assert "run it in a terminal" in capsys.readouterr().err
