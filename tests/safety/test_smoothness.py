"""Acceleration and jerk of what is commanded, over every change of mind and every kind of stop.

Between ticks the acceleration is continuous and the jerk j bounded, so for commands v one period h apart

    v(k) - v(k-1)             = ∫ a dt          and is at most A h,
    v(k) - 2 v(k-1) + v(k-2)  = ∫ j(t) w(t) dt  and is at most (J(k-1) + J(k)) h² / 2,

where w is the hat of height h and half-width h about the middle command, and A and J are the limits of
what led to each command: ordinary motion, letting go, or a stop. Only rounding is added to these.
"""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from latentarm.control.step import Step
from latentarm.core.types import Input
from latentarm.robots.kinematics.obstacles import Sphere
from latentarm.safety.config import SafetyConfig
from latentarm.safety.obstacles import table
from stepping import stepped

ROUNDING_RAD_S = 3e-9
"""The stack itself takes commands of a nanoradian per second for rest."""

OBSTACLES = (table(0.0), Sphere("ball", np.array([0.5, 0.2, 0.3]), 0.1))
EVENTS = ("push", "push", "push", "let go", "stop", "stale", "late", "switch", "broken", "reading")


@st.composite
def drives(draw):
    """A seed, and what happens: an event and for how many ticks."""
    ticks = st.integers(1, 15)
    return draw(st.integers(0, 2**32 - 1)), draw(
        st.lists(st.tuples(st.sampled_from(EVENTS), ticks), min_size=2, max_size=6)
    )


def commands(arm, scripted, config, dt_s, seed, events):
    """The commands of a drive, and for each one what led to it."""
    rng = np.random.default_rng(seed)
    controller = scripted(rng.uniform(-1.0, 1.0, (2, 7)), modes=("one", "two"))
    step = Step(arm, controller, config, dt_s=dt_s)
    q = np.clip(arm.home + rng.normal(size=7) * 0.3, arm.limits.lower + 0.11, arm.limits.upper - 0.11)
    step.reset(q)
    velocities, led = [np.zeros(7)] * 2, ["rest"] * 2
    for event, ticks in events:
        if step.stopped is not None and event not in ("stop", "stale", "reading"):
            # The person lets go and enables again, perhaps while the arm still slows down.
            record = stepped(step, Input(np.zeros(2)), 0.0, q, len(velocities) * dt_s)
            velocities.append(record.command.velocity)
            led.append("stop")
            q = q + record.command.velocity * dt_s
            step.enable()
        u = rng.choice([-1.0, 1.0], 2) * rng.uniform(0.2, 1.0, 2)
        if event == "switch":
            controller.matrix = rng.uniform(-1.0, 1.0, (2, 7))
            step.choose_mode(1 - step.mode)
        if event == "stop":
            step.stop("Stop was pressed.")
        for _ in range(ticks):
            age = {"stale": 1.0, "late": config.input_timeout_s + 0.5 * config.input_grace_s + 1e-6}.get(
                event, 0.0
            )
            given = Input(np.zeros(2) if event == "let go" else u)
            if event == "broken":
                given = Input(np.array([np.nan, 0.0]))
            reading = np.full(7, np.nan) if event == "reading" else q
            record = stepped(step, given, age, reading, len(velocities) * dt_s)
            velocities.append(record.command.velocity)
            if step._stack._brake is not None:
                led.append("stop")
            else:
                led.append("release" if event == "let go" else "motion")
            q = q + record.command.velocity * dt_s
    return step._stack.bounds, np.array(velocities), led


@given(st.sampled_from([0.001, 0.01, 0.02]), drives())
def test_every_command_keeps_acceleration_and_jerk(arm, scripted, dt_s, drive):
    config = SafetyConfig(obstacles=OBSTACLES, input_grace_s=0.05, input_timeout_s=0.03, release_fraction=0.5)
    bounds, velocity, led = commands(arm, scripted, config, dt_s, *drive)
    acceleration = {
        "rest": np.zeros(7),
        "motion": bounds.acceleration,
        "release": bounds.release_acceleration,
        "stop": bounds.stop_acceleration,
    }
    jerk = {
        "rest": np.zeros(7),
        "motion": bounds.jerk,
        "release": bounds.release_jerk,
        "stop": bounds.stop_jerk,
    }
    change = np.diff(velocity, axis=0)
    highest = np.zeros(7)
    for k in range(2, len(velocity)):
        # What a harder stop has built up, motion takes back at its jerk: its own limit holds from then on.
        highest = np.maximum(highest, acceleration[led[k]])
        assert (np.abs(change[k - 1]) <= highest * dt_s + ROUNDING_RAD_S).all(), (k, led[k - 2 : k + 1])
        highest = np.maximum(highest - jerk[led[k]] * dt_s, acceleration[led[k]])
        second = np.abs(change[k - 1] - change[k - 2])
        most = 0.5 * (jerk[led[k]] + jerk[led[k - 1]]) * dt_s**2
        assert (second <= most + 2 * ROUNDING_RAD_S).all(), (k, led[k - 2 : k + 1])
