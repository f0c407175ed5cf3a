"""Why an arm that takes no commands may not move."""

from typing import Final

from latentarm.arms.contract import ArmPhase, ArmStatus
from latentarm.core.types import Stop, StopCode

_CODES: Final[dict[ArmPhase, StopCode]] = {
    "off": "arm_off",
    "disabled": "not_enabled",
    "fault": "arm_fault",
    "emergency_stop": "arm_emergency_stop",
}


def stop_of(status: ArmStatus) -> Stop:
    """Why an arm that takes no commands may not move."""
    said = {"text": status.reason} if status.phase == "fault" else {}
    return Stop(status.reason, code=_CODES.get(status.phase), parameters=said)
