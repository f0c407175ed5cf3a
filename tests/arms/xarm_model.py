"""A simulated xArm: joints that follow velocities of bounded duration, states, modes, errors.

Written from the manufacturer's documentation of its states, modes and codes. It accelerates as fast as its
limits allow, without jerk limits or lag, and nothing pulls at it. It is no measurement of a real arm.
"""

import math
import time
from dataclasses import dataclass, field

CYCLE_S = 0.004
DH = (
    (0.0, 0.0, 267.0),
    (-math.pi / 2, 0.0, 0.0),
    (math.pi / 2, 0.0, 293.0),
    (math.pi / 2, 52.5, 0.0),
    (math.pi / 2, 77.5, 342.5),
    (math.pi / 2, 0.0, 0.0),
    (-math.pi / 2, 76.0, 97.0),
)
"""Modified Denavit-Hartenberg figures of an xArm 7: alpha and a before a joint, d along it; rad and mm."""
IDENTITY = [[1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0], [0.0, 0.0, 0.0, 1.0]]
READY, MOVING, STOPPED = 2, 1, 4
MANUAL, JOINT_VELOCITY = 2, 4
OLD = (1, 8, 0)


@dataclass
class XArmModel:
    """Attributes: see the manufacturer's protocol; angles in rad."""

    axes: int = 7
    kind: int = 7
    firmware: tuple[int, int, int] = (2, 3, 0)
    q: list[float] = field(default_factory=lambda: [0.0] * 7)
    lower: float = -6.28
    upper: float = 6.28
    speed: float = 3.14
    acceleration: float = 20.0
    load_kg: float = 0.8
    collision_sensitivity: int = 3
    simulated: int = 0
    # mm and rad: of the tool from the flange, and of the frame of poses from the base
    tool_offset: list[float] = field(default_factory=lambda: [0.0, 0.0, 100.0, 0.0, 0.0, 0.0])
    base_offset: list[float] = field(default_factory=lambda: [0.0] * 6)

    def __post_init__(self) -> None:
        self.v = [0.0] * 7
        self.gripper = 850.0
        self.gripper_target = 850.0
        self.gripper_speed = 2000.0
        self.gripper_on = False
        self.grips_at: float | None = None
        self.pressed = False
        self.commands = 0
        self.now_s = time.monotonic()
        self.boot()

    def boot(self) -> None:
        """As after power-on: at rest, motors off, position mode, stopped."""
        self.v = [0.0] * 7
        self.target = [0.0] * 7
        self.until_s = 0.0
        self.mode, self.state, self.error, self.warning = 0, STOPPED, 0, 0
        self.motors = False

    def tool(self, q: list[float]) -> list[float]:
        """Pose of the tool at joint angles, mm and rad, by the manufacturer's table of an xArm 7."""
        frame = IDENTITY
        for (alpha, a, d), angle in zip(DH, q, strict=True):
            frame = times(frame, transform([a, 0.0, 0.0], (alpha, 0.0, 0.0)))
            frame = times(frame, transform([0.0, 0.0, d], (0.0, 0.0, angle)))
        frame = times(frame, transform(self.tool_offset[:3], tuple(self.tool_offset[3:])))
        pitch = math.asin(min(max(-frame[2][0], -1.0), 1.0))
        roll, yaw = math.atan2(frame[2][1], frame[2][2]), math.atan2(frame[1][0], frame[0][0])
        return [frame[0][3], frame[1][3], frame[2][3], roll, pitch, yaw]

    def advance(self) -> None:
        """Move on to now, in whole cycles."""
        now_s = time.monotonic()
        while self.now_s + CYCLE_S <= now_s:
            self.now_s += CYCLE_S
            self._cycle()

    def takes_velocity(self) -> bool:
        return self.motors and self.mode == JOINT_VELOCITY and self.state < 3 and not self.error

    def move(self, velocity: list[float], duration_s: float | None) -> None:
        """Take a velocity command; one without duration, or with 0, has no end."""
        self.commands += 1
        if not self.takes_velocity():
            return
        if any(abs(speed) > self.speed for speed in velocity[: self.axes]):
            self.fail(24)
            return
        bounded = duration_s is not None and duration_s > 0.0 and self.firmware >= OLD
        self.target = list(velocity)
        self.until_s = self.now_s + duration_s if bounded and duration_s is not None else float("inf")

    def set_state(self, state: int) -> None:
        if state == 0:
            if self.error or not self.motors:
                return
            self.state = READY
        elif state in (3, 4, 6):
            self.state = STOPPED if state == 4 else state
        self.target = [0.0] * 7

    def set_mode(self, mode: int) -> None:
        if mode != self.mode:
            self.target = [0.0] * 7
        self.mode = mode

    def fail(self, error: int) -> None:
        self.error, self.state = error, STOPPED
        self.target = [0.0] * 7
        if error <= 3:
            self.motors = False

    def clear(self) -> None:
        self.error = 1 if self.pressed else 0

    def push(self, by: list[float]) -> None:
        """Somebody moves the joints by hand, which the arm lets them in manual mode."""
        if self.mode == MANUAL and self.state < 3 and self.motors and not self.error:
            self.q = [joint + moved for joint, moved in zip(self.q, by, strict=True)]

    def press(self) -> None:
        self.pressed = True
        self.fail(1)

    def _cycle(self) -> None:
        if self.now_s > self.until_s:
            self.target = [0.0] * 7
        step = self.acceleration * CYCLE_S
        for joint in range(self.axes):
            change = min(max(self.target[joint] - self.v[joint], -step), step)
            self.v[joint] += change
            self.q[joint] += self.v[joint] * CYCLE_S
            if not self.lower <= self.q[joint] <= self.upper:
                self.q[joint] = min(max(self.q[joint], self.lower), self.upper)
                self.v[joint] = 0.0
                self.fail(23)
        if self.state < 3:
            self.state = MOVING if any(self.v) else READY
        reach = self.gripper_speed * CYCLE_S * 0.2
        towards = min(max(self.gripper_target - self.gripper, -reach), reach)
        if self.gripper_on and not (self.holding() and towards < 0.0):
            self.gripper += towards

    def holding(self) -> bool:
        """Whether something stands between the fingers that are closing."""
        closes = self.gripper_target < self.gripper
        return self.grips_at is not None and closes and self.gripper <= self.grips_at


def times(one: list[list[float]], other: list[list[float]]) -> list[list[float]]:
    return [[sum(row[k] * other[k][j] for k in range(4)) for j in range(4)] for row in one]


def transform(place: list[float], turn: tuple[float, ...]) -> list[list[float]]:
    """By roll, pitch and yaw about fixed axes."""
    (sr, sp, sy), (cr, cp, cy) = map(math.sin, turn), map(math.cos, turn)
    return [
        [cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr, place[0]],
        [sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr, place[1]],
        [-sp, cp * sr, cp * cr, place[2]],
        IDENTITY[3],
    ]
