"""The controller's codes as sentences that say what to do."""

from typing import Final

from latentarm.arms.xarm.sdk import Sdk

EMERGENCY_STOPS: Final = (1, 2, 3)  # codes: on the control box, on its inputs, on a three-state switch
_BUTTONS: Final = {
    1: "The emergency stop button on the control box is pressed",
    2: "The emergency stop input of the control box is triggered",
    3: "The emergency stop button of the three-state switch is pressed",
}

_OWN: Final = {
    22: "stop driving this way, and move the arm away from itself by hand in UFACTORY Studio's manual mode",
    23: "move the joint back into its range in UFACTORY Studio",
    24: "lower the speed",
    25: "lower the speed",
    31: "check what the arm has hit, its payload and its collision sensitivity",
    35: "move the arm back inside its safety boundary in UFACTORY Studio's manual mode",
}
"""Advice that replaces the manufacturer's, which is about programs or paths."""


def emergency_stop(code: int) -> str:
    """Advice about an emergency stop."""
    return f"{_BUTTONS[code]}: release it when it is safe, then enable the arm again."


def controller_error(sdk: Sdk, code: int) -> str:
    """An error of the controller in words, and what to do about it."""
    known = sdk.errors.get(code)
    if known is None:
        return (
            f"The arm's controller reports error {code}: look it up in UFACTORY Studio, then enable the arm"
            " again."
        )
    title = known["en"]["title"].rstrip(".")
    theirs = known["en"]["desc"].strip().rstrip(".")
    todo = _OWN.get(code) or theirs[:1].lower() + theirs[1:] or "check it in UFACTORY Studio"
    return f"The arm has stopped with error {code}, {title}: {todo}, then enable it again."


def gripper_error(sdk: Sdk, code: int) -> str:
    """An error of the gripper in words."""
    known = sdk.gripper_errors.get(code)
    title = known["en"]["title"].rstrip(".") if known else "unknown"
    return f"The gripper reports error {code}, {title}: check what it holds, then enable the arm again."
