"""What the servos of a LeRobot arm are told, and what its address must say."""

import json
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from latentarm.arms.address import parse_address
from latentarm.arms.lerobot.jaw import Jaw
from latentarm.arms.lerobot.options import Options
from latentarm.arms.lerobot.targets import LEAD_RAD, LONGEST_STEP_S, STOP_LEAD_RAD, Targets
from latentarm.core.errors import UserError

LOWER, UPPER, SPEED = np.array([-1.0, -0.5]), np.array([1.0, 0.5]), np.array([1.0, 2.0])

spans = st.floats(0.0, 0.5)
rates = st.tuples(st.floats(-10.0, 10.0), st.floats(-10.0, 10.0))
places = st.tuples(st.floats(-1.5, 1.5), st.floats(-1.5, 1.5))
rounds = st.lists(st.tuples(spans, rates, spans, places), min_size=1, max_size=20)


@given(places, rounds)
def test_targets_move_only_under_a_command_within_speed_and_limits(start, rounds) -> None:
    targets = Targets(LOWER, UPPER, SPEED)
    targets.begin(np.array(start))
    now_s, until_s = 100.0, -np.inf
    before = np.array(start)
    for pause_s, velocity, duration_s, q in rounds:
        targets.command(np.array(velocity), now_s, now_s + duration_s)
        until_s = now_s + duration_s
        sent_s = now_s
        now_s += pause_s
        after = targets.advance(now_s, np.array(q))
        most_s = min(max(min(now_s, until_s) - sent_s, 0.0) + pause_s, LONGEST_STEP_S)
        assert (np.abs(after - before) <= SPEED * most_s + 1e-12).all()
        leaves = (after > np.maximum(UPPER, before)) | (after < np.minimum(LOWER, before))
        assert not leaves.any()
        ahead = np.abs(after - q) > LEAD_RAD + 1e-12
        assert (np.abs(after - q)[ahead] <= np.abs(before - q)[ahead] + 1e-12).all()
        before = after
    still = targets.advance(until_s + 1.0, before)
    np.testing.assert_array_equal(targets.advance(until_s + 2.0, before), still)


def test_a_stream_of_commands_leads_where_its_velocities_do() -> None:
    targets = Targets(LOWER, UPPER, SPEED)
    targets.begin(np.zeros(2))
    rng = np.random.default_rng(0)
    at, now_s = np.zeros(2), 0.0
    for tick in range(1, 101):
        targets.command(np.array([0.5, -0.2]), now_s, now_s + 0.05)
        now_s = 0.01 * tick + rng.uniform(0.0, 0.009)
        at = targets.advance(now_s, at)
    np.testing.assert_allclose(at, np.array([0.5, -0.2]) * now_s, atol=1e-9)


@given(places, places)
def test_a_stop_presses_no_farther_than_a_little(start, q) -> None:
    targets = Targets(LOWER, UPPER, SPEED)
    targets.begin(np.array(start))
    targets.command(np.ones(2), 0.0, 10.0)
    targets.halt(np.array(q))
    assert (np.abs(targets.advance(1.0, np.array(q)) - q) <= STOP_LEAD_RAD + 1e-12).all()


def test_a_jaw_opens_at_its_speed_and_says_when_it_holds_something() -> None:
    jaw = Jaw(width_m=0.1)
    jaw.begin(100.0)
    jaw.command(width_m=0.0, speed_m_s=0.05)
    at = 100.0
    for _ in range(100):
        at = jaw.advance(0.01, at)
    assert jaw.measured() == (pytest.approx(0.05, abs=0.001), False)
    for _ in range(200):
        at = max(jaw.advance(0.01, at), 40.0)  # something is between
    assert jaw.measured() == (pytest.approx(0.04), True)
    pressing = jaw.advance(0.01, at)
    assert 20.0 <= pressing < 40.0
    jaw.halt()
    assert jaw.advance(0.01, at) == pressing
    assert jaw.measured()[1]


@pytest.mark.parametrize(
    ("address", "says"),
    [
        ("lerobot://so101_follower", "serial port"),
        ("lerobot://so101_follower?port=/dev/ttyACM0", "calibration"),
        ("lerobot://so101_follower?port=/dev/ttyACM0&id=a&calibration=b.json", "calibration"),
        ("lerobot://so101_follower?port=/dev/ttyACM0&calibration=missing.json", "missing.json"),
        ("lerobot://so101_follower:80?port=/dev/ttyACM0&id=a", "network port"),
        ("lerobot://so101_follower?port=/dev/ttyACM0&id=a&baud=9600", "baud"),
    ],
)
def test_an_address_that_lacks_something_gets_one_sentence(address: str, says: str) -> None:
    with pytest.raises(UserError, match=says):
        Options.of(parse_address(address))


def test_a_calibration_file_is_named_by_its_path(tmp_path: Path) -> None:
    file = tmp_path / "black.json"
    file.write_text(json.dumps({}))
    options = Options.of(parse_address(f"lerobot://so101_follower?port=/dev/ttyACM0&calibration={file}"))
    assert (options.name, options.folder) == ("black", str(tmp_path))
