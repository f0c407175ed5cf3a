"""Whatever happens: arm and gripper move only as somebody asks who may ask, and no faster than their pace."""

import math
from collections import deque
from dataclasses import dataclass, replace
from typing import Final, Literal

import numpy as np
from hypothesis import example, given
from hypothesis import strategies as st

from latentarm.assistance.blending import FixedAlpha
from latentarm.assistance.boltzmann import BoltzmannBelief
from latentarm.assistance.goal_blending import GoalBlending
from latentarm.control.step import Step
from latentarm.core.types import Goal, GripperAsk, GripperReading, Input, Reading, Stop
from latentarm.robots.catalogue import load_robot
from latentarm.robots.gripper import Gripper
from latentarm.robots.kinematics.obstacles import Sphere
from latentarm.safety.config import SafetyConfig
from latentarm.safety.obstacles import table
from latentarm.safety.zones import Zone

DT: Final = 0.01
HAND: Final = Gripper(("left", "right"), 0.08, 0.1, 70.0)
ROBOT: Final = replace(load_robot("panda"), gripper=HAND)
LIMITS: Final = SafetyConfig(
    obstacles=(table(0.0),),
    zones=(Zone(Sphere("face", np.array([0.4, 0.0, 0.6]), 0.2), 0.05),),
    input_grace_s=0.03,
)
GOALS: Final = tuple(
    Goal(f"goal {i}", q, ROBOT.chain.forward(q)) for i, q in enumerate((ROBOT.home + 0.3, ROBOT.home - 0.2))
)
SETTLES_S: Final = 0.5
"""The arm is as slow as it is told, or at rest, within this time."""

FAR_TOO_FAST: Final = np.stack([np.full(7, 20.0), np.linspace(-30.0, 30.0, 7)])

Event = Literal["nothing", "stop", "enable", "refuse", "mode", "forget"]


@dataclass(frozen=True)
class Span:
    """Some ticks in which the same is done; the event comes before the first."""

    event: Event = "nothing"
    u: tuple[float, float] = (0.0, 0.0)
    age_s: float = 0.0
    pace: float = 1.0
    ask: GripperAsk | None = None
    switch: bool = False
    opens: bool = False
    guide: Literal["no", "open", "close", "toggle", "holds still"] = "no"
    ticks: int = 1


spans = st.builds(
    Span,
    event=st.sampled_from(("nothing", "nothing", "stop", "enable", "enable", "refuse", "mode", "forget")),
    u=st.sampled_from(((0.0, 0.0), (0.0, 0.0), (1.0, 0.0), (0.0, -1.0), (0.6, 0.6), (2.0, math.nan))),
    age_s=st.sampled_from((0.0, 0.0, 0.0, 0.03, 0.06, 1.0, math.inf, math.nan)),
    pace=st.sampled_from((1.0, 1.0, 0.0, 0.2, 0.5)),
    ask=st.sampled_from((None, None, "open", "close", "toggle")),
    switch=st.booleans(),
    opens=st.booleans(),
    guide=st.sampled_from(("no", "no", "no", "open", "close", "toggle", "holds still")),
    ticks=st.sampled_from((1, 2, 5, 20, 60, 130)),
)
"""Each kind of trouble often enough to meet the others."""


class World:
    """A step, the arm and the fingers that it moves, and what a bystander knows of who may move them."""

    def __init__(self, scripted, oracle):
        configurations = np.stack([goal.configuration for goal in GOALS])
        self.step = Step(
            ROBOT,
            scripted(FAR_TOO_FAST, modes=("one", "two")),
            LIMITS,
            goals=GOALS,
            belief=BoltzmannBelief(configurations, period_s=0.05),
            assistance=GoalBlending(configurations, FixedAlpha(0.5)),
            dt_s=DT,
        )
        self.step.reset(ROBOT.home)
        self.first_belief = self.step.belief
        self.link_speed = oracle(ROBOT).link_speed
        self.q, self.velocity = ROBOT.home, np.zeros(7)
        self.width_m, self.holding = HAND.width_m, False
        self.number = 0
        self.enabled = self.neutral = self.asked_since = self.pushed_since = False
        self.ask = None
        self.held_since = self.held_at = math.inf
        self.paces = deque(maxlen=round(SETTLES_S / DT))

    def happens(self, event):
        if event in ("stop", "refuse"):
            if event == "stop":
                self.step.stop("Somebody stops it.")
            else:
                self.step.refuse(Stop("The arm is off."))
            self.enabled = self.neutral = False
        elif event == "enable":
            was = self.enabled
            refused = self.step.enable()
            assert was or (refused is None) == self.neutral, "after a stop the stick must be seen at rest"
            if refused is None and not was:
                self.enabled, self.asked_since, self.pushed_since = True, False, False
        elif event == "mode":
            self.step.choose_mode(1 - self.step.mode)
        elif event == "forget":
            self.step.forget()

    def tick(self, span, guide, *, guided):
        if guided:
            self.step.guided(guide)
        self.number += 1
        time_s = DT * self.number
        hand = GripperReading(self.width_m, self.holding)
        given = Input(np.array(span.u), span.switch, span.ask, span.pace, span.opens)
        believed = self.step.belief
        record = self.step(
            given, span.age_s, Reading(self.q, self.velocity, time_s, self.number, hand), time_s
        )
        self.step.sent(time_s)
        usable = 0.0 <= span.age_s <= LIMITS.input_timeout_s and np.isfinite(span.u).all()
        late_s = LIMITS.input_timeout_s + LIMITS.input_grace_s
        falters = self.enabled and LIMITS.input_timeout_s < span.age_s <= late_s
        pushes = bool(usable and any(span.u))
        if usable:
            self.asked_since |= self.enabled and span.ask is not None and span.ask != self.ask
            self.ask = span.ask
        runs = self.step.stopped is None
        assert runs <= (self.enabled and (usable or falters)), "nobody has enabled it, or nobody is there"
        if not falters:
            self.neutral = usable and not pushes and (runs or not self.enabled)
        self.enabled = runs
        if usable and span.opens and not runs:
            self.held_since, self.held_at = min(self.held_since, time_s), time_s
        elif usable or runs or time_s - self.held_at > LIMITS.input_grace_s:
            self.held_since = math.inf
        self.held_s = time_s - self.held_since if usable else -math.inf
        pace = span.pace if usable else 0.0 if falters else 1.0
        self.check_arm(record.command.velocity, pace if pushes and runs else 0.0)
        self.check_gripper(record.command.gripper, pace, guided=guided and not runs)
        if runs and not self.pushed_since:
            np.testing.assert_array_equal(believed, self.first_belief)
        self.pushed_since |= pushes and runs

    def check_arm(self, velocity, pace):
        """It is no faster than this pace, or one of a moment ago, allows."""
        at_rest = not self.velocity.any()
        self.paces.append(pace)
        most = max(self.paces)
        assert (np.abs(velocity) <= most * self.step.joint_speed + 1e-9).all()
        if velocity.any():
            assert not at_rest or pace > 0.0, "nobody has asked for this"
            if self.number % 5 == 0:
                assert self.link_speed(self.q, velocity) <= most * LIMITS.link_speed + 1e-6
        self.q, self.velocity = self.q + DT * velocity, velocity

    def check_gripper(self, command, pace, *, guided):
        if command is None:
            return
        assert command.speed_m_s <= pace * LIMITS.gripper_speed + 1e-12
        most_m = DT * command.speed_m_s
        moved_m = float(np.clip(command.width_m - self.width_m, -most_m, most_m))
        if moved_m and not guided:
            if self.enabled:
                assert self.asked_since, "nobody has asked since it was enabled"
            else:
                assert moved_m > 0.0, "it closes, and the arm is not enabled"
                assert self.held_s > 1.0 - 1e-9, "nobody has held it for a second"
        # Something 20 mm thick is in the way.
        self.holding = self.width_m + moved_m < 0.02
        self.width_m = max(self.width_m + moved_m, 0.02)


def drive(scripted, oracle, all_of_them):
    world = World(scripted, oracle)
    for span in all_of_them:
        world.happens(span.event)
        for tick in range(span.ticks):
            asks = None if tick or span.guide in ("no", "holds still") else span.guide
            world.tick(span, asks, guided=span.guide != "no")
    return world


ENABLED: Final = (Span(), Span("enable"))
PUSH: Final = (1.0, 0.0)


@given(st.lists(spans, max_size=12))
@example(
    [
        *ENABLED,
        Span(ask="open"),
        Span("stop"),
        Span(guide="close", ticks=130),
        Span(),
        Span("enable", ticks=60),
    ]
)
@example([*ENABLED, Span(ask="close", ticks=5), Span("stop"), Span(ticks=20), Span("enable", ticks=60)])
@example([*ENABLED, Span(ask="close", pace=0.0, ticks=20), Span(u=PUSH, pace=0.2, ticks=130)])
@example([*ENABLED, Span(u=PUSH, ticks=130), Span("stop", ticks=60), Span("enable", ticks=5), Span(u=PUSH)])
@example([*ENABLED, Span(ask="close", ticks=130), Span("stop"), Span(opens=True, ticks=130), Span(ticks=5)])
def test_nothing_moves_but_as_somebody_asks_who_may_and_within_their_pace(scripted, oracle, before):
    drive(scripted, oracle, before)


@given(st.lists(spans, max_size=6), st.sampled_from(((1.0, 0.0), (0.0, -1.0), (0.6, 0.6))))
def test_however_it_came_there_an_arm_at_pace_zero_stands_still(scripted, oracle, before, u):
    world = drive(scripted, oracle, before)
    for _ in range(100):
        world.tick(Span(u=u, pace=0.0, ask="toggle", opens=True), None, guided=False)
    assert not world.velocity.any()


@given(st.lists(spans, max_size=3))
def test_however_it_came_there_a_disengaged_gripper_can_be_opened(scripted, oracle, before):
    world = drive(scripted, oracle, [*ENABLED, Span(ask="close", ticks=20), *before, Span("stop", ticks=60)])
    for _ in range(280):
        world.tick(Span(opens=True), None, guided=False)
    assert world.width_m > HAND.width_m - 1e-9
