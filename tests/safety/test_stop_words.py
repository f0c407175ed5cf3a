"""Whatever stops the arm is said in every language, with what it names."""

import re

import numpy as np
import pytest

from latentarm.arms.contract import ArmStatus
from latentarm.control.loop import stop_of
from latentarm.core.types import Reading, Stop
from latentarm.safety.config import SafetyConfig
from latentarm.safety.limits import Bounds
from latentarm.safety.newest_reading import NewestReading
from latentarm.safety.plausibility import Plausibility
from latentarm.safety.tool_force import ToolForce
from latentarm.web.protocol.notice import Notice, notice_of_stop
from latentarm.web.words.catalogue import languages


def followed(robot, reading, velocity, **limits):
    """The stop of a robot that is commanded to move for a second while its reading becomes this one."""
    made = Plausibility(Bounds(SafetyConfig(**limits), robot, 0.01), robot)
    q = robot.home
    for tick in range(100):
        time_s = 0.01 * tick
        stop = made.jump(q, time_s) or made.follow(q, velocity, time_s, new=True, driven=True)
        if stop is not None:
            return stop
        q = reading(q)
    raise AssertionError("nothing was noticed")


def stops(panda, gantry):
    """One stop of each kind that names anything."""
    third, first = np.eye(7)[2], np.eye(4)[0]
    late = NewestReading(0.05, 0.03).refusal(Reading(panda.home, panda.home, 0.0, 0), 0.06)
    feels, down = ToolForce(panda, 15.0), -panda.chain.jacobian(panda.home)[2]
    feels.saw(-40.0 * down)
    pressed = feels.refusal(panda.home, down)
    return {
        "joint_jumped": followed(panda, lambda q: q + 0.3 * third, np.zeros(7)),
        "slide_jumped": followed(gantry, lambda q: q + 0.4 * first, np.zeros(4), joint_speed=0.5),
        "joint_frozen": followed(panda, lambda q: q, 0.3 * third),
        "joint_astray": followed(panda, lambda q: q + 0.005 * third, np.zeros(7)),
        "slide_astray": followed(gantry, lambda q: q + 0.005 * first, np.zeros(4), joint_speed=0.5),
        "reading_old": late,
        "force_high": pressed,
        "controller_failed": Stop("It failed (no).", code="controller_failed", parameters={"text": "no"}),
        "arm_fault": stop_of(ArmStatus("fault", "A motor is hot.")),
        "arm_emergency_stop": stop_of(ArmStatus("emergency_stop", "Pressed.")),
    }


@pytest.mark.parametrize("language", sorted(languages()))
def test_what_stops_the_arm_is_said_in_every_language(arm, gantry, language):
    say = languages()[language].say
    for code, stop in stops(arm, gantry).items():
        assert stop.code == code
        notice = notice_of_stop(stop)
        said = say(f"notice.{notice.code}", notice.parameters)
        assert all(str(value) in said for value in notice.parameters.values())
        # What the safety filters say is English and stays in journals; only what an arm itself says is shown.
        assert stop.reason not in said or code == "arm_fault"
        assert not re.search(r"[{}]", said)


def test_amounts_are_in_degrees_or_millimetres(arm, gantry):
    jumped = stops(arm, gantry)["joint_jumped"].parameters
    assert jumped == {"joint": "joint3", "moved_deg": 17, "elapsed_ms": 10}
    assert stops(arm, gantry)["slide_jumped"].parameters["moved_mm"] == 400


def test_a_sentence_of_somebody_elses_is_said_as_it_is():
    assert notice_of_stop(Stop("The stick is gone.")).text == "The stick is gone."


def test_guests_are_named_by_number_and_a_notice_may_have_a_cause():
    assert Notice(code="stop_pressed_by", parameters={"name": 3, "page": "x"}).text == "Guest 3 pressed Stop."
    because = {"because": "reading_old", "age_ms": 60}
    said = Notice(code="recording_ended", parameters=because).text
    assert said.startswith("The recording ended here. There was no report from the arm for 60 ms")
