"""The process next to the bus: it holds the arm's position when commands run out.

The servos of LeRobot's arms know positions only, and stay at the last target. This process sends a new one a
hundred times a second while a command is in force. When commands run out, when the commanding process stalls
or is killed, and when this one is killed, the last target stands: the arm stops, under power, and does not
drop.
"""

import signal
import sys
import time
from collections import deque
from collections.abc import Mapping
from contextlib import suppress
from typing import Any, Final, final

import numpy as np

from latentarm.arms.contract import ArmPhase
from latentarm.arms.helper_process import MessagePort
from latentarm.arms.lerobot.bus import GRIPPER, MotorsBus
from latentarm.arms.lerobot.jaw import Jaw
from latentarm.arms.lerobot.options import Options
from latentarm.arms.lerobot.targets import Targets
from latentarm.core.errors import UserError
from latentarm.core.punctuality import OwnPauses, ask_for_priority, short_collections
from latentarm.core.types import FloatArray

PERIOD_S: Final = 0.01  # of the targets
_FAILURES: Final = 5  # the arm has a fault after so many rounds without an answer
_SILENT_PERIOD_S: Final = 0.2  # of later rounds: each waits for answers that do not come
_TORQUE_ROUNDS: Final = 10  # between checks that all motors are under power
_VELOCITY_ROUNDS: Final = 5  # span of a velocity: one encoder step in one round is a large one
_MOVING_RAD_S: Final = 0.05  # slower motion is below the encoders' resolution over 50 ms


def now_s() -> float:
    """The clock that all processes of this machine share, and that goes on during suspend, s."""
    return time.clock_gettime(time.CLOCK_BOOTTIME)


@final
class Keeper:
    """Keeps one arm, on a bus not yet open, for the commanding process at the other end of ``port``.

    ``setup`` has ``joints``, ``lower``, ``upper`` and ``speed`` (n each, rad, rad/s), and the gripper's
    ``width_m`` or None.
    """

    def __init__(self, port: MessagePort, bus: MotorsBus, setup: Mapping[str, Any]) -> None:
        self._port, self._bus, self._setup = port, bus, setup
        self._joints: list[str] = setup["joints"]
        self._jaw = None if setup["width_m"] is None else Jaw(setup["width_m"])
        self._phase: ArmPhase = "off"
        self._reason = ""
        self._failures = self._rounds = 0
        self._released = self._grips = False
        self._pauses = OwnPauses()
        self._targets: Targets | None = None
        self._q = np.zeros(len(self._joints))
        self._seen: deque[tuple[float, FloatArray]] = deque(maxlen=_VELOCITY_ROUNDS + 1)
        self._read_s = now_s()

    def run(self) -> None:
        """Keep the arm until the other process is gone; then leave it in place, under power."""
        due_s = now_s()
        try:
            while True:
                while (message := self._port.receive()) is not None:
                    self._heed(message)
                if self._phase != "off":
                    self._round()
                period_s = PERIOD_S if self._failures < _FAILURES else _SILENT_PERIOD_S
                due_s = max(due_s + period_s, now_s() - PERIOD_S)
                time.sleep(max(due_s - now_s(), 0.0))
                self._pauses.note(now_s() - due_s)
        except EOFError:
            pass
        finally:
            with suppress(OSError):
                self._hold()
                self._bus.close()

    def _heed(self, message: Mapping[str, Any]) -> None:
        match message.get("do"):
            case "move":
                self._command(message)
            case "look":
                self._port.send({"asked": message["asked"], **self._looked()})
            case "connect":
                self._port.send({"asked": message["asked"], **self._connected()})
            case "close":
                self._hold()
                self._halt()
                self._bus.close()
                self._phase = "off"
                self._port.send({"asked": message["asked"], "closed": True})
            case "enable":
                self._enable()
            case "disable":
                self._hold()
                self._halt()
                if self._phase == "ready":
                    self._phase, self._reason = "disabled", ""
            case "guide":
                self._let_go()
            case "grip" if self._phase in ("guided", "disabled", "fault") and self._jaw is not None:
                self._jaw.command(*message["gripper"])
                self._grips = message["gripper"][1] > 0.0 and (self._grips or self._jaw_has_torque())
            case "stop":
                self._halt()
            case "recover" if self._phase == "fault" and not self._failures:
                self._phase, self._reason = "disabled", ""
            case _:
                pass

    def _looked(self) -> dict[str, object]:
        """Facts and refusals; leaves the bus as open as before."""
        begun = self._phase
        try:
            if begun == "off":
                self._bus.open()
            return {"facts": self._bus.facts(), "refusals": list(self._bus.refusals())}
        except (UserError, OSError) as error:
            return {"refused": _sentence(error)}
        finally:
            if begun == "off":
                self._bus.close()

    def _connected(self) -> dict[str, object]:
        try:
            if self._phase == "off":
                self._bus.open()
            refusals = self._bus.refusals()
            if refusals:
                raise UserError(refusals[0])
            self._targets = self._new_targets()
            self._read()
            self._failures = 0
            self._phase, self._reason = "disabled", ""
        except (UserError, OSError) as error:
            self._bus.close()
            self._phase = "off"
            return {"refused": _sentence(error)}
        return {"connected": True, **self._state()}

    def _new_targets(self) -> Targets:
        """Targets within the limits of both the model and the calibration."""
        ranges = self._bus.ranges()
        half = np.deg2rad([ranges[joint] for joint in self._joints])
        lower, upper = (np.array(self._setup[name], dtype=np.float64) for name in ("lower", "upper"))
        speed = np.array(self._setup["speed"], dtype=np.float64)
        return Targets(np.maximum(lower, -half), np.minimum(upper, half), speed)

    def _command(self, message: Mapping[str, Any]) -> None:
        if self._phase != "ready" or self._targets is None:
            return
        sent_s = float(message["sent_s"])
        if sent_s > now_s():
            return  # the clock has gone back: nobody knows how old it is
        velocity = np.array(message["velocity"], dtype=np.float64)
        self._targets.command(velocity, sent_s, sent_s + float(message["duration_s"]))
        if self._jaw is not None and message["gripper"] is not None:
            self._jaw.command(*message["gripper"])

    def _halt(self) -> None:
        if self._targets is not None:
            self._targets.halt(self._q)
        if self._jaw is not None:
            self._jaw.halt()

    def _enable(self) -> None:
        if self._phase != "disabled" or self._targets is None:
            return
        try:
            self._bus.energise()
            self._read()
        except OSError as error:
            self._fail(f"The motors do not take power: {_sentence(error)}")
            return
        self._targets.begin(self._q)
        self._phase, self._reason = "ready", ""

    def _let_go(self) -> None:
        """Switch the joints' torque off, so that a person can move them; the gripper's stays on."""
        if self._phase != "disabled":
            return
        try:
            self._bus.energise()
            self._read()
            self._released = True
            self._bus.release(self._joints)
        except OSError as error:
            self._fail(f"The motors do not let go: {_sentence(error)}")
            return
        self._phase, self._reason = "guided", ""

    def _hold(self) -> None:
        """Hold an arm in place, under power, if it is guided or was."""
        if self._phase == "guided":
            self._phase, self._reason = "disabled", ""
        if not self._released:
            return
        try:
            self._bus.energise()
        except OSError as error:
            self._fail(f"The motors do not take power, so hold the arm: {_sentence(error)}")
            return
        self._released = False

    def _round(self) -> None:
        before_s = self._read_s
        try:
            opening = self._read()
            if self._phase == "ready" and self._targets is not None:
                target = np.rad2deg(self._targets.advance(now_s(), self._q)).tolist()
                goals = dict(zip(self._joints, target, strict=True))
                if self._jaw is not None:
                    goals[GRIPPER] = self._jaw.advance(min(self._read_s - before_s, 2 * PERIOD_S), opening)
                self._bus.go(goals)
            elif (self._phase == "guided" or self._grips) and self._jaw is not None:
                width = self._jaw.advance(min(self._read_s - before_s, 2 * PERIOD_S), opening)
                self._bus.go({GRIPPER: width})
            self._check_torque()
        except OSError:
            self._failures += 1
            if self._failures >= _FAILURES:
                advice = self._pauses.or_else("check its cable and its supply")
                self._fail(f"The arm's bus does not answer: {advice}.")
            lost = self._failures >= _FAILURES
            self._port.send({"phase": self._phase, "reason": self._reason, "lost": lost})
            return
        self._failures = 0
        if self._phase != "guided":
            self._hold()
        self._port.send(self._state())

    def _check_torque(self) -> None:
        self._rounds += 1
        if self._phase == "ready" and self._rounds % _TORQUE_ROUNDS == 0 and (limp := self._bus.limp()):
            self._fail(
                f"{', '.join(limp)} has switched its torque off, as for overload, heat or voltage: support"
                " the arm, then enable it again."
            )

    def _read(self) -> float:
        """Read the positions; returns the gripper's, from 0 to 100."""
        positions = self._bus.positions()
        self._read_s = now_s()
        self._q = np.deg2rad([positions[joint] for joint in self._joints])
        self._seen.append((self._read_s, self._q))
        opening = float(positions.get(GRIPPER, 0.0))
        if self._jaw is not None and self._phase not in ("ready", "guided") and not self._grips:
            self._jaw.begin(opening)
        return opening

    def _jaw_has_torque(self) -> bool:
        """Whether the jaw's torque is on; if not, writing a goal turns it on and makes the jaw jump."""
        with suppress(OSError):
            return GRIPPER not in self._bus.limp()
        return False

    def _fail(self, reason: str) -> None:
        if self._phase != "fault":
            self._halt()
            self._phase, self._reason = "fault", reason

    def _velocity(self) -> FloatArray:
        (first_s, first), (last_s, last) = self._seen[0], self._seen[-1]
        return (last - first) / (last_s - first_s) if last_s > first_s else np.zeros_like(last)

    def _state(self) -> dict[str, object]:
        velocity = self._velocity()
        moves = bool(np.abs(velocity).max() > _MOVING_RAD_S)
        width_m, holding = (None, False) if self._jaw is None else self._jaw.measured()
        return {
            "phase": "moving" if self._phase == "ready" and moves else self._phase,
            "reason": self._reason,
            "q": self._q.tolist(),
            "dq": velocity.tolist(),
            "read_s": self._read_s,
            "width_m": width_m,
            "holding": holding,
        }


def _sentence(error: Exception) -> str:
    return " ".join(str(error).split())[:400]


def main() -> None:
    """Open the bus of the first message, describe it, and keep its arm."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    port = MessagePort.of_helper()
    setup = port.receive(wait_s=60.0)
    if setup is None:
        return
    try:
        bus = MotorsBus(Options(**setup["options"]))
    except UserError as error:
        port.send({"refused": str(error)})
        return
    port.send({"joints": list(bus.joints), "gripper": GRIPPER in bus.motors})
    ask_for_priority()
    with short_collections():
        Keeper(port, bus, setup).run()


if __name__ == "__main__":
    sys.exit(main())
