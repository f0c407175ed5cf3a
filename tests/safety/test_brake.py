"""The stop: exact, straight, within limits, and never longer than the config was checked for."""

import numpy as np
from hypothesis import example, given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from latentarm.safety.brake import AT_REST_S, Brake

A = np.array([12.0, 6.0, 8.0])
J = np.array([6000.0, 3000.0, 80.0])

velocities = arrays(np.float64, 3, elements=st.floats(-0.5, 0.5))
accelerations = arrays(np.float64, 3, elements=st.floats(-6.0, 6.0))


@given(velocities, accelerations)
@example(np.zeros(3), np.array([0.0078125, 0.0, 0.0]))
def test_ends_at_rest_without_jumps(velocity, acceleration):
    brake = Brake(velocity, acceleration, A, J)
    times = np.linspace(0.0, brake.duration_s * 1.01, 400)
    path = np.array([brake.at(float(t))[0] for t in times])
    np.testing.assert_allclose(path[0], velocity, atol=AT_REST_S * A.max())
    assert not path[-1].any()
    step = times[1]
    # What is slower than a nanosecond of braking counts as rest.
    rest = 1e-9 * A + 1e-9
    assert (np.abs(np.diff(path, axis=0)) <= np.maximum(A, 6.0) * step + rest).all()
    assert (np.abs(np.diff(path, n=2, axis=0)) <= J * step**2 + rest).all()


@given(velocities, accelerations)
@example(
    np.zeros(3), np.array([0.296875, 0.0, 0.0])
)  # hardly moves: a ramp of a few hundredths of a millisecond
def test_brakes_in_proportion_on_a_straight_line_and_covers_half_its_time(velocity, acceleration):
    brake = Brake(velocity, acceleration, A, J)
    times = brake.settle_s + (np.arange(2000) + 0.5) * brake.ramp_s / 2000
    path = np.array([brake.at(float(t))[0] for t in times])
    way = path.sum(axis=0) * brake.ramp_s / 2000
    np.testing.assert_allclose(way, 0.5 * brake.ramp_s * brake.settled, atol=1e-6)
    # Every velocity is the settled one times a number that only falls.
    size = brake.settled @ brake.settled
    if size > 1e-12:
        share = path @ brake.settled / size
        np.testing.assert_allclose(path, share[:, None] * brake.settled, atol=1e-9)
        assert (np.diff(share) <= 1e-12).all()
        assert share.max() <= 1.0 + 1e-12
        # The line that the proof of link speeds uses.
        bound = np.minimum(1.0, 1.0 - brake.rate * (times - brake.settle_s - brake.onset_s))
        assert (share <= bound + 1e-9).all()


@given(velocities, accelerations)
def test_commands_sampled_from_it_never_pass_its_end(velocity, acceleration):
    brake = Brake(velocity, acceleration, A, J)
    for dt in (0.005, 0.01, 0.02):
        way, since = np.zeros(3), 0.0
        while since < brake.duration_s:
            since += dt
            way = way + brake.at(since)[0] * dt
        allowed = np.abs(brake.settled) * 0.5 * brake.ramp_s + np.abs(brake.kink) * (brake.settle_s + dt)
        assert (
            np.abs(way)
            <= allowed + np.maximum(np.abs(velocity), np.abs(brake.settled)) * brake.settle_s + 1e-12
        ).all()


def test_rest_needs_no_brake():
    brake = Brake(np.zeros(3), np.zeros(3), A, J)
    assert brake.duration_s == 0.0
    velocity, acceleration = brake.at(0.0)
    assert not velocity.any()
    assert not acceleration.any()
