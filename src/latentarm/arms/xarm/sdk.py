"""The manufacturer's library, imported when an arm is made."""

import contextlib
import importlib
import sys
from dataclasses import dataclass
from functools import cache
from typing import Any, Protocol, final

from latentarm.core.errors import UserError


class Port(Protocol):
    """The port through which the library writes requests and reads answers."""

    def flush(self) -> int:
        """Forget answers that nobody waits for."""
        ...

    def write(self, data: bytes) -> int:
        """Send a frame; 0, or -1 where it cannot be sent."""
        ...

    def read(self, timeout: float | None = None) -> bytes | int:
        """The next frame, or -1 where none has come within the time, s."""
        ...


@final
@dataclass(frozen=True)
class Sdk:
    """The used part of the library."""

    version: str
    command_class: Any  # ``UxbusCmdTcp``
    report_class: Any  # ``ReportDataStructure``
    # the controller's, by code: title and description by language
    errors: dict[object, dict[str, dict[str, str]]]
    gripper_errors: dict[object, dict[str, dict[str, str]]]  # the gripper's
    # lowest and highest position of each joint, rad, by number of joints and number of the type
    joint_limits: dict[int, dict[int, list[tuple[float, float]]]]

    def commands(self, port: Port) -> Any:
        """Requests over a port, in the manufacturer's private protocol; each answer begins with a code."""
        return self.command_class(port)

    def report(self, port: int) -> Any:
        """A reader of the reports of one of the manufacturer's ports, 30000 to 30003; angles in rad."""
        return self.report_class.create(port, is_radian=True)


@cache
def load_sdk() -> Sdk:
    """Import the library."""
    try:
        # It prints its version, and logs to what standard output is at this moment.
        with contextlib.redirect_stdout(sys.stderr):
            version = importlib.import_module("xarm.version")
            commands = importlib.import_module("xarm.core.wrapper.uxbus_cmd_tcp")
            report = importlib.import_module("xarm.x3.report")
            codes = importlib.import_module("xarm.core.config.x_code")
            figures = importlib.import_module("xarm.core.config.x_config")
    except ImportError as error:
        raise UserError(
            "--arm xarm needs the manufacturer's library: install it with pip install 'latentarm[xarm]'"
            f" ({error})."
        ) from error
    except OSError as error:
        raise UserError(
            "--arm xarm cannot import xarm-python-sdk, which keeps a log in ~/.UFACTORY:"
            f" make the home directory writable ({error})."
        ) from error
    errors = codes.ControllerErrorCodeMap, codes.GripperErrorCodeMap
    limits = figures.XCONF.Robot.JOINT_LIMITS
    return Sdk(version.__version__, commands.UxbusCmdTcp, report.ReportDataStructure, *errors, limits)
