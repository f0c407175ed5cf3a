"""`arms check` says what an arm can reach, how fast it is driven and what it learns, whatever its limits."""

import json
import re
from contextlib import nullcontext
from dataclasses import replace

import numpy as np
import pytest
from wooden_server import wooden_server

from latentarm.cli import main
from latentarm.core.errors import UserError
from latentarm.robots.panda import panda
from latentarm.safety.limits import Bounds
from latentarm.web.arm_process.drive_setup import PERIOD_S, safety_limits
from latentarm.web.arm_process.speed_limits import Speeds


@pytest.fixture(scope="module")
def server():
    with wooden_server(panda()) as server:
        yield server


def checked(server, capsys, limits, *words):
    code = main(
        ["arms", "check", server.address, "--robot", "panda", "--limits", str(limits), "--json", *words]
    )
    found = json.loads(capsys.readouterr().out)
    return code, {fact["name"]: fact["value"] for fact in found["facts"]}, found["refusals"]


def stated(tmp_path, **figures):
    path = tmp_path / "limits.toml"
    lines = [f"{name} = {value}" for name, value in figures.items()]
    path.write_text("".join("\n".join([f"[joints.joint{i + 1}]", *lines, ""]) for i in range(7)))
    return path


def test_limits_that_suit_say_so(server, capsys, tmp_path):
    code, facts, refusals = checked(server, capsys, stated(tmp_path, velocity_rad_per_s=2.0))
    assert (code, refusals) == (0, [])
    assert "0.5 rad/s and 0.25 m/s; commands end within" in facts["driven at up to"]
    assert "m from the base" in facts["reach"]
    assert "7 joints" in facts["learns from"]


@pytest.mark.parametrize(
    "figures", [{"jerk_rad_per_s3": 400.0}, {"acceleration_rad_per_s2": 6.0}, {"velocity_rad_per_s": 0.3}]
)
def test_limits_that_do_not_suit_are_refused_with_speeds_that_work(server, capsys, tmp_path, figures):
    limits = stated(tmp_path, **figures)
    code, facts, (refusal,) = checked(server, capsys, limits)
    assert code == 2
    assert {"reach", "learns from", "firmware"} <= set(facts)
    words = refusal.split("; ")[-1].removesuffix(" works.").split()
    assert words[0] == "--joint-speed"
    assert checked(server, capsys, limits, *words)[0] == 0
    # It is the fastest, but for a step.
    faster = f"{float(words[1]) + 0.03:g}"
    assert checked(server, capsys, limits, "--joint-speed", faster)[0] == 2


def test_where_no_speed_works_it_says_how_much_quicker_the_joints_must_be(server, capsys, tmp_path):
    code, facts, (refusal,) = checked(server, capsys, stated(tmp_path, jerk_rad_per_s3=5.0))
    assert code == 2
    said = facts["driven at up to"]
    assert refusal.endswith(f"; {said}.")
    quicker, times = (float(one) for one in re.findall(r"([\d.]+) times", said))
    limits = panda().limits
    for jerk, enough in ((times, True), (times / 2.0, False)):
        changed = replace(limits, acceleration=quicker * limits.acceleration, jerk=np.full(7, 5.0 * jerk))
        with nullcontext() if enough else pytest.raises(UserError):
            Bounds(safety_limits(Speeds(0.1, 0.05)), replace(panda(), limits=changed), PERIOD_S)
