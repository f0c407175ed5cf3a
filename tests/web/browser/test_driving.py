"""A person drives to a goal, by every way of pressing that the page has.

The person is simulated: they look at where each direction would take the tool and press the one that ends
nearest to the goal. Everything they do goes through the browser; where the arm is comes from the server.
"""

import time

import numpy as np
import pytest

from .hands import Buttons, Gamepad, Keyboard, OneSwitch, Pointer

NEAR_M = 0.03
PATIENCE_S = 60.0
NOTICED_S = 1.0
"""A person sees that nothing moves within this."""


def best_direction(arm, goal, pushed):
    """What is pushed, as long as it comes nearer; else whose next half second ends nearest to the goal."""

    def left_m(name):
        return np.linalg.norm(np.array(arm.ghosts[name][2]) - goal)

    if pushed is not None and left_m(pushed) < np.linalg.norm(arm.tool - goal):
        return pushed
    return min(arm.ghosts, key=left_m)


def drive(hand, arm, goal):
    """Until the tool is there; whenever the arm has stopped, let go and enable it, as people do."""
    end_s = time.monotonic() + PATIENCE_S
    pushed = None
    while np.linalg.norm(arm.tool - goal) > NEAR_M:
        assert time.monotonic() < end_s, (
            f"{np.linalg.norm(arm.tool - goal):.3f} m away; {arm.state['reason']}"
        )
        if not arm.enabled:
            hand.let_go()
            pushed = None
            time.sleep(0.2)
            hand.enable()
            time.sleep(0.3)
            continue
        best = best_direction(arm, goal, pushed)
        if best != pushed:
            hand.let_go()
            hand.push(best)
            pushed = best
        elif not arm.comes_to(lambda: arm.state["phase"] == "moving" or not arm.enabled, NOTICED_S):
            # Another choice was lit by the time of the press: once more.
            pushed = None
        time.sleep(0.1)
    hand.let_go()


@pytest.mark.parametrize(
    ("hand", "goal"),
    [(Pointer, "carrot"), (Keyboard, "tofu"), (Buttons, "carrot"), (OneSwitch, "carrot"), (Gamepad, "melon")],
)
def test_a_person_drives_to_a_goal(open_page, seat, arm, hand, goal):
    page = seat(open_page(hand.script()), arm)
    assert np.linalg.norm(arm.tool - arm.goals[goal]) > 0.2
    drive(hand(page), arm, arm.goals[goal])
    arm.is_let_go()
    assert np.linalg.norm(arm.tool - arm.goals[goal]) < NEAR_M + 0.01
