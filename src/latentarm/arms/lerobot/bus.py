"""A robot of LeRobot over its motors' bus. Nothing here imports LeRobot before a `MotorsBus` is made."""

import math
import re
import select
import statistics
import time
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from dataclasses import fields
from importlib import import_module
from pathlib import Path
from typing import Any, Final, TypeVar, final

from latentarm.arms.lerobot.options import Options
from latentarm.core.errors import UserError

KINDS: Final = ("so100_follower", "so101_follower", "koch_follower", "omx_follower")
"""The robots of LeRobot that have one arm on one bus, and the modules that register them."""

_MODULES: Final = ("so_follower", "koch_follower", "omx_follower")
GRIPPER: Final = "gripper"  # motor of the gripper; LeRobot reads it from 0 (closed) to 100 (open)
HOTTEST_C: Final = 60  # hotter motors are not driven; their own protection is at 70
_ANSWER_S: Final = 0.002  # longest wait for a byte before the servos' SDK checks its time-out
RAMP_RAD_S2: Final = 100 * 2 * math.pi / 4096  # unit of Feetech's register Acceleration: 100 encoder steps/s²
SLOWEST_RAMP_RAD_S2: Final = 10.0  # a motor with a slower ramp in its registers does not stop in time
_BEYOND_DEG: Final = 15.0  # a joint cannot be farther outside its calibrated range
_ALIKE_STEPS: Final = 20  # largest difference between two readings of a motor at rest
_TRIES: Final = 3  # a bus loses an answer now and then
_MISSING: Final = re.compile(r"- (\d+) \(expected")  # numbers of missing motors in LeRobot's list
_FAILURES: Final = (OSError, RuntimeError, ValueError)  # raised by LeRobot for a bad answer
_Answer = TypeVar("_Answer")


@final
class MotorsBus:
    """The bus of one robot, with LeRobot's own classes; not open at first.

    Positions of the arm's motors are in degrees from the middle of their calibrated range, as with LeRobot's
    ``use_degrees``. Only `release` switches torque off. Methods raise OSError where a motor does not answer.
    """

    def __init__(self, options: Options) -> None:
        self._options = options
        self._robot = _robot(options)
        self._bus: Any = self._robot.bus
        _sleep_until_answers_come(self._bus.port_handler)
        _discard_late_answers(self._bus.port_handler)
        self.motors: tuple[str, ...] = tuple(self._bus.motors)
        self.joints = tuple(name for name in self.motors if name != GRIPPER)
        degrees = import_module("lerobot.motors").MotorNormMode.DEGREES
        for name in self.joints:
            if self._bus.motors[name].norm_mode is not degrees:
                raise UserError(
                    f"LeRobot's {options.kind} reads {name} in no angle, which cannot be driven: choose one"
                    f" of {', '.join(KINDS)}."
                )

    def open(self) -> None:
        """Open the port and check that all motors answer; changes nothing."""
        kind, port = self._options.kind, self._options.port
        try:
            _again(self._open_once)
        except _FAILURES as error:
            why = str(error.__cause__ or error)
            missing = [int(number) for number in _MISSING.findall(why)]
            if len(missing) == len(self.motors):
                raise UserError(
                    f"No motor of {kind} answers on {port}: check the cable and the supply."
                ) from error
            if missing:
                names = [name for name in self.motors if self._bus.motors[name].id in missing]
                raise UserError(
                    f"The motors {', '.join(names)} of {kind} do not answer on {port}: check their cables."
                ) from error
            why = " ".join(why.split())[:300]
            raise UserError(
                f"{port} cannot be used for {kind}: see that the arm is connected ({why})."
            ) from error

    def _open_once(self) -> None:
        try:
            self._bus.connect()
        except _FAILURES:
            self.close()
            raise

    def close(self) -> None:
        """Close the port; motors under power hold their positions."""
        if self._bus.is_connected:
            self._bus.disconnect(disable_torque=False)

    def refusals(self) -> tuple[str, ...]:
        """Reasons not to drive the arm; its bus is open."""
        found: list[str] = []
        file = Path(self._robot.calibration_fpath)
        kind, port, name = self._options.kind, self._options.port, self._options.name
        if not file.is_file():
            known = ", ".join(sorted(one.stem for one in file.parent.glob("*.json"))) or "none"
            found.append(
                f"There is no calibration {file} (there: {known}): name another id, or run"
                f" lerobot-calibrate --robot.type={kind} --robot.port={port} --robot.id={name}."
            )
        elif not _again(lambda: self._bus.is_calibrated):
            found.append(
                f"The motors do not have the calibration {file}: run"
                f" lerobot-calibrate --robot.type={kind} --robot.port={port} --robot.id={name}."
            )
        for motor, celsius in self._read("Present_Temperature").items():
            if celsius > HOTTEST_C:
                found.append(f"The motor {motor} is at {celsius} °C: let it cool below {HOTTEST_C} °C.")
        if self._has("Acceleration"):
            powered = self._read("Torque_Enable")
            for motor, units in self._read("Acceleration").items():
                # LeRobot sets it to 254 where a motor is configured, which needs torque off.
                if powered[motor] and 0.0 < (ramp := units * RAMP_RAD_S2) < SLOWEST_RAMP_RAD_S2:
                    found.append(
                        f"The motor {motor} is under power and set to slow down by {ramp:.1f} rad/s² at most:"
                        " hold the arm and switch its supply off and on, so that enabling configures it."
                    )
        return tuple(found)

    def facts(self) -> dict[str, str]:
        """Facts about the arm; its bus is open."""
        spans_s: list[float] = []
        for _ in range(20):
            begun = time.perf_counter()
            self._read("Present_Position")
            spans_s.append(time.perf_counter() - begun)
        models = {self._bus.motors[name].model for name in self.motors}
        hottest = max(self._read("Present_Temperature").items(), key=lambda item: item[1])
        on = sum(self._read("Torque_Enable").values())
        told = {
            "motors": f"{len(self.motors)} {', '.join(sorted(models))}: {', '.join(self.motors)}",
            "temperature": f"{hottest[1]} °C at most ({hottest[0]})",
            "torque": f"on at {on} of {len(self.motors)} motors",
            "round trip": f"{1000 * statistics.median(spans_s):.1f} ms for the positions of all motors",
        }
        if self._has("Firmware_Major_Version"):
            major, minor = self._read("Firmware_Major_Version"), self._read("Firmware_Minor_Version")
            told["firmware"] = ", ".join(sorted({f"{major[name]}.{minor[name]}" for name in self.motors}))
        if self._has("Acceleration"):
            ramp = min(self._read("Acceleration").values()) * RAMP_RAD_S2
            limit = f"{ramp:.0f} rad/s² by" if ramp else "no limit in"
            told["acceleration"] = f"{limit} its registers"
        if self._has("Present_Voltage"):
            told["supply"] = f"{min(self._read('Present_Voltage').values()) / 10:.1f} V at the weakest motor"
        if self._bus.calibration:
            at = self.positions()
            told["positions"] = ", ".join(f"{name} {at[name]:.1f}°" for name in self.joints)
            told["calibrated to"] = ", ".join(f"{name} ±{half:.1f}°" for name, half in self.ranges().items())
        return told

    def ranges(self) -> dict[str, float]:
        """Half of each joint's calibrated range, degrees."""
        found: dict[str, float] = {}
        for name in self.joints:
            one = self._bus.calibration[name]
            ticks = self._bus.model_resolution_table[self._bus.motors[name].model] - 1
            found[name] = (one.range_max - one.range_min) * 180.0 / ticks
        return found

    def positions(self) -> Mapping[str, float]:
        """Joints in degrees, the gripper from 0 to 100; an impossible value is an OSError too."""
        found = self._whole("Present_Position", normalize=True)
        ranges = self.ranges()
        for name in self.joints:
            if abs(found[name]) > ranges[name] + _BEYOND_DEG:
                raise ConnectionError(
                    f"The motor {name} says that it is at {found[name]:.0f}°, outside its calibrated range."
                )
        return found

    def go(self, targets: Mapping[str, float]) -> None:
        """Send targets to the motors, in units of `positions`."""
        self._bus.sync_write("Goal_Position", dict(targets))

    def limp(self) -> tuple[str, ...]:
        """The motors whose torque is off."""
        return tuple(name for name, on in self._read("Torque_Enable").items() if not on)

    def energise(self) -> None:
        """Switch torque on where it is off, at the motors' present positions.

        An arm without any torque is configured too, as by LeRobot's connect. One under power is not: that
        would let it drop for a moment.
        """
        limp = self.limp()
        # That all have torque must be no late answer to another question.
        if not limp and not (limp := self.limp()):
            return
        # A motor goes to its last goal as soon as torque is on.
        self._bus.sync_write("Goal_Position", self._sure_positions(), normalize=False)
        if len(limp) == len(self.motors):
            _again(self._robot.configure)
        else:
            self._bus.enable_torque(list(limp), num_retry=_TRIES)
        if still := self.limp():
            raise ConnectionError(f"{', '.join(still)} stays without torque: check its supply and its cable.")

    def release(self, motors: Sequence[str]) -> None:
        """Switch torque off at some motors."""
        self._bus.disable_torque(list(motors), num_retry=_TRIES)

    def _has(self, register: str) -> bool:
        """Whether the motors have a register: other makers have others."""
        models = {motor.model for motor in self._bus.motors.values()}
        return all(register in self._bus.model_ctrl_table[model] for model in models)

    def _sure_positions(self) -> dict[str, int]:
        """Encoder steps that the motors report twice in a row: torque will hold them there."""
        before = self._read("Present_Position")
        for _ in range(_TRIES):
            now = self._read("Present_Position")
            if all(abs(now[name] - before[name]) <= _ALIKE_STEPS for name in self.motors):
                return now
            before = now
        raise ConnectionError("The motors say that they are elsewhere each time: hold the arm still.")

    def _read(self, register: str) -> dict[str, int]:
        return self._whole(register, normalize=False)

    def _whole(self, register: str, *, normalize: bool) -> dict[str, Any]:
        """Answers of all motors, each checked to be whole.

        LeRobot takes an answer without enough bytes for a 0. A late answer to an earlier question can have
        fewer bytes. As a position, 0 would let the arm go there.
        """
        found: dict[str, Any] = self._bus.sync_read(register, normalize=normalize, num_retry=1)
        reader = self._bus.sync_reader
        for name in self.motors:
            if len(reader.data_dict[self._bus.motors[name].id]) != reader.data_length:
                raise ConnectionError(f"The motor {name} has answered something else than was asked.")
        return found


def _again(ask: Callable[[], _Answer]) -> _Answer:
    for _ in range(_TRIES - 1):
        with suppress(*_FAILURES):
            return ask()
    return ask()


def _sleep_until_answers_come(port: Any) -> None:
    """Let the port of a servos' SDK sleep while there is nothing to read.

    The SDK polls in a loop that never sleeps. At real-time priority that keeps the kernel's worker for
    incoming bytes off the processor, so that answers came too late on a busy machine.
    """
    read_at_once = port.readPort

    def read(length: int) -> Any:
        select.select([port.ser], [], [], _ANSWER_S)
        return read_at_once(length)

    port.readPort = read


def _discard_late_answers(port: Any) -> None:
    """Let the port of a servos' SDK discard before each question what came too late for earlier ones.

    The SDK means to, but its own method waits for what was written. Answers to questions that a bus had kept
    while it stood still would be read in place of newer ones from then on.
    """
    port.clearPort = lambda: port.ser.reset_input_buffer()


def _robot(options: Options) -> Any:
    robots = import_module("lerobot.robots")
    for module in _MODULES:
        import_module(f"lerobot.robots.{module}")
    import_module("lerobot.utils.import_utils").register_third_party_plugins()
    known = robots.RobotConfig.get_known_choices()
    if options.kind not in known:
        raise UserError(f"LeRobot has no robot {options.kind}: choose one of {', '.join(KINDS)}.")
    config = known[options.kind]
    names = {field.name for field in fields(config)}
    folder = None if options.folder is None else Path(options.folder)
    given = {"port": options.port, "id": options.name, "calibration_dir": folder}
    # So that positions are angles, and nothing lets the arm drop.
    given |= {"use_degrees": True, "disable_torque_on_disconnect": False}
    try:
        taken = {name: value for name, value in given.items() if name in names}
        robot = robots.make_robot_from_config(config(**taken))
    except ImportError as error:
        raise UserError(f"LeRobot cannot make {options.kind}: {error}.") from error
    if not hasattr(robot, "bus") or "port" not in names:
        raise UserError(
            f"LeRobot's {options.kind} is no arm on a bus of motors: choose one of {', '.join(KINDS)}."
        )
    return robot
