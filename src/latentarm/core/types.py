"""The vocabulary of every package: small frozen records of NumPy arrays, with the symbols of Losey et al."""

import math
from collections.abc import Mapping
from dataclasses import asdict, dataclass, field, replace
from os import PathLike
from typing import Literal

import numpy as np
from numpy.typing import NDArray

StrPath = str | PathLike[str]  # a file or folder, as the public functions take it

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]
BoolArray = NDArray[np.bool_]

NO_GRIPPER: FloatArray = np.zeros(0)  # `Context.gripper` and `Context.gripper_target` where unknown
NO_OBJECTS: FloatArray = np.zeros((0, 9))  # `Context.objects` where unknown
NO_THINGS: FloatArray = np.zeros((0, 7))  # `StepRecord.things` where nobody looks
NO_SIGHTINGS: FloatArray = np.zeros((0, 2))  # `StepRecord.sightings` where nobody says

NO_GRIPPER.flags.writeable = NO_OBJECTS.flags.writeable = False
NO_THINGS.flags.writeable = NO_SIGHTINGS.flags.writeable = False


@dataclass(frozen=True)
class Pose:
    """One or many rigid poses ``x`` in the robot's base frame.

    Attributes:
        position: (..., 3), m.
        rotation: (..., 3, 3), rotation matrices.
    """

    position: FloatArray
    rotation: FloatArray


@dataclass(frozen=True)
class Goal:
    """A goal ``g`` that the person may want.

    Attributes:
        configuration: (n,), rad.
        pose: end-effector pose at ``configuration``.
    """

    name: str
    configuration: FloatArray
    pose: Pose


@dataclass(frozen=True)
class Provenance:
    """Who and what recorded an episode; "" where unknown."""

    person: str = ""  # the driver
    run: str = ""  # the trained run that they drove with
    run_fingerprint: str = ""  # of its model's file
    profile: str = ""  # the person whose alignment was used
    device: str = ""  # kind of input device, such as ``keyboard``; ``simulated`` for a simulated person
    controller: str = ""  # when the episode began
    task_name: str = ""  # of the task in the catalogue at which the arm was driven
    version: str = ""  # of this package
    started_utc: str = ""  # when the episode began, ISO 8601 in UTC
    complete: bool = True  # whether the recording was ended, rather than cut short
    shadow: bool = False  # whether the arm stood by while commands were computed and not sent


@dataclass(frozen=True)
class Episode:
    """One demonstration, sampled at increasing times.

    Attributes:
        state: (T, n), joint positions, rad.
        timestamp: (T,), s from the episode's start.
        action: (T, m), joint velocities, rad/s, or None where none were recorded.
        task: in words.
        extras: further features of the dataset by name (``belief``, ``input.u``, ...), each (T, k).
        provenance: None where unknown.
    """

    state: FloatArray
    timestamp: FloatArray
    action: FloatArray | None = None
    task: str = ""
    extras: Mapping[str, FloatArray] = field(default_factory=dict)
    provenance: Provenance | None = None

    def at(self, samples: slice | IntArray) -> "Episode":
        """Some of its samples, with their timestamps."""
        return replace(
            self,
            state=self.state[samples],
            timestamp=self.timestamp[samples],
            action=None if self.action is None else self.action[samples],
            extras={name: values[samples] for name, values in self.extras.items()},
        )


@dataclass(frozen=True)
class StatedJointLimits:
    """Limits that somebody states of one joint; None where unstated. A sliding joint has m instead of rad."""

    position: tuple[float, float] | None = None  # lowest and highest, rad
    velocity: float | None = None  # rad/s
    acceleration: float | None = None  # rad/s²
    jerk: float | None = None  # rad/s³
    sliding: bool | None = None  # None where there are no figures
    margin: float | None = None  # distance to keep from both, rad


@dataclass(frozen=True)
class StatedGripper:
    """Figures that somebody states of a gripper; see `latentarm.robots.gripper.Gripper`."""

    # of the robot's model that move the fingers or the jaw; empty where the model has none
    joints: tuple[str, ...]
    width: float  # the largest opening, m
    speed: float  # the fastest change of the opening, m/s
    force: float  # the largest force between the fingers, N


@dataclass(frozen=True)
class StatedLimits:
    """Limits that somebody states of a robot, as in a limits file."""

    joints: Mapping[str, StatedJointLimits]  # by name, without unstated ones
    tool_speed: float | None = None  # m/s
    gripper: StatedGripper | None = None


@dataclass(frozen=True)
class Demonstrations:
    """The dataset ``D`` as stored on disk: whole episodes of one robot.

    Attributes:
        episodes: all with the same n.
        rate_hz: nominal sampling rate.
        robot: name or model path of the robot, or "" where unknown.
        goals: the discrete goals ``G``, empty where none are known.
        import_record: decisions of the import about units, joints and so on, by subject, in words; empty for
            demonstrations that were never imported.
        end_effector: site, body or link of the model file; None where the robot has but one.
        limits: as stated, or None.
        objects: names of the K things whose poses the feature ``observation.environment_state`` (T, 7 K)
            holds: position, m, and quaternion (w, x, y, z), in the base frame; empty where it holds none.
    """

    episodes: tuple[Episode, ...]
    rate_hz: float
    joint_names: tuple[str, ...]
    robot: str = ""
    goals: tuple[Goal, ...] = ()
    import_record: Mapping[str, str] = field(default_factory=dict)
    end_effector: str | None = None
    limits: StatedLimits | None = None
    objects: tuple[str, ...] = ()

    @property
    def dof(self) -> int:
        """Number of joints n."""
        return len(self.joint_names)

    @property
    def warnings(self) -> list[str]:
        """Warnings of this import and earlier ones, and of episodes in which the arm stood by."""
        said = [said for subject, said in self.import_record.items() if subject.endswith("warning")]
        shadows = sum(one.provenance is not None and one.provenance.shadow for one in self.episodes)
        if shadows:
            said.append(
                f"{shadows} of {len(self.episodes)} episodes are from shadow mode: the arm did not follow"
                " their actions."
            )
        return said


@dataclass(frozen=True)
class Pairs:
    """Context-action pairs ``(c, a)`` drawn from demonstrations.

    The action always comes from the states as they were demonstrated. State noise is added to ``context``
    only, so that nobody can reconstruct it from the action.
    """

    context: FloatArray  # (N, c); its first n entries are the state, rad
    clean_context: FloatArray  # (N, c), ``context`` before state noise
    action: FloatArray  # (N, m), noise-free joint velocity, rad/s
    episode: IntArray  # (N,), index of each pair's episode
    # (N, K), whether each thing in the context moves with the tool; K = 0 where the arm is unknown
    held: BoolArray


@dataclass(frozen=True)
class Context:
    """Everything that a decoder may see at one moment; `latentarm.core.context` picks its features.

    Attributes:
        state: (n,), joint positions ``s``, rad.
        belief: (G,), probability over goals ``b``; empty where there are no goals.
        gripper: (1,), opening of the gripper, m; empty where unknown.
        objects: (K, 9), poses in the base frame of the things that matter: position, m, and the first two
            columns of the rotation matrix (`latentarm.robots.kinematics.pose_rows`); empty where unknown.
        gripper_target: (1,), commanded opening, m: its own before the first command, and 0 where it holds
            something; empty where unknown.
    """

    state: FloatArray
    belief: FloatArray
    gripper: FloatArray = field(default_factory=lambda: NO_GRIPPER)
    objects: FloatArray = field(default_factory=lambda: NO_OBJECTS)
    gripper_target: FloatArray = field(default_factory=lambda: NO_GRIPPER)


GripperAsk = Literal["open", "close", "toggle"]  # a person's request to a gripper


@dataclass(frozen=True)
class Input:
    """A person's input at one moment.

    Attributes:
        u: (d,), each entry in [-1, 1].
        switch_mode: the person asks for the controller's next mode.
        gripper: request to the gripper, or None. Like a mode switch it counts once, however long it is held.
        pace: share of the speed, in [0, 1], that a second person leaves the first. It counts after all
            limits, for everything that moves: what the robot adds, a way back, the gripper.
        opens: whether the person holds down the button that opens the gripper of a disabled arm.
        delay_s: how old the state was that this answers when it came, s; NaN where that is not measured.
    """

    u: FloatArray
    switch_mode: bool = False
    gripper: GripperAsk | None = None
    pace: float = 1.0
    opens: bool = False
    delay_s: float = math.nan


@dataclass(frozen=True)
class GripperReading:
    """A gripper's measurements at one moment."""

    width_m: float  # opening between the fingers, m
    holding: bool = False  # whether it holds something


@dataclass(frozen=True)
class Reading:
    """An arm's measurements at one moment.

    Attributes:
        q: (n,), joint positions, rad.
        dq: (n,), joint velocities, rad/s.
        time_s: of the measurement, on the control loop's clock, s.
        sequence: grows with every new reading, across reconnections too.
        gripper: None where the arm has none.
        external_torque: (n,), the arm's own estimate of what everything outside exerts on its joints, N m
            (N where a joint slides); None where the arm has none.
    """

    q: FloatArray
    dq: FloatArray
    time_s: float
    sequence: int
    gripper: GripperReading | None = None
    external_torque: FloatArray | None = None


StopCode = Literal[
    "arm_emergency_stop",
    "arm_fault",
    "arm_off",
    "clock_jumped",
    "clock_stood_still",
    "controller_failed",
    "controller_invalid",
    "emergency_stop_released",
    "force_high",
    "gripper_invalid",
    "input_invalid",
    "input_late",
    "joint_astray",
    "joint_frozen",
    "joint_jumped",
    "joints_invalid",
    "let_go_first",
    "loop_late",
    "no_smooth_path",
    "not_enabled",
    "reading_invalid",
    "reading_old",
    "readings_unsteady",
    "slide_astray",
    "slide_jumped",
]
"""Kinds of stops."""


@dataclass(frozen=True)
class Stop:
    """A safety filter's refusal."""

    reason: str  # one short sentence for the person, in English
    untrusted: bool = False  # the readings of the joints cannot be true; a recording ends before them
    # kind of stop, for interfaces in other languages; None for a stop from outside this package
    code: StopCode | None = field(default=None, compare=False)
    # values in that sentence, by name; a number's name ends in its unit
    parameters: Mapping[str, str | int] = field(default_factory=dict, compare=False)


@dataclass(frozen=True)
class GripperCommand:
    """A gripper's target, and the force that it may press with."""

    width_m: float  # target opening, m
    # limit on the opening's rate, m/s. At 0 the fingers stay where they are, whatever the width says, and
    # neither loosen nor tighten their hold.
    speed_m_s: float
    force_n: float  # limit on the force between the fingers, N; a gripper that holds something keeps it


@dataclass(frozen=True)
class Command:
    """The safety filters' output, for the robot."""

    velocity: FloatArray  # (n,), rad/s, finite and within limits
    duration_s: float  # the robot stops by itself if no new command arrives within this time
    stop: Stop | None = None  # why the arm stops, or None
    limited_by: tuple[str, ...] = ()  # names of the filters that changed it
    # target of the gripper, or None to leave it as it is. Unlike a velocity it does not run out, so that
    # nothing falls when commands end.
    gripper: GripperCommand | None = None


@dataclass(frozen=True)
class StepRecord:
    """Every value that one pass through Algorithm 1 read and decided."""

    time_s: float  # the loop's monotonic clock
    state: FloatArray  # (n,), ``s``, rad; NaN where the arm's reading was unusable
    input: FloatArray  # (d,), ``u`` as used (zero where it was stale or refused)
    latent: FloatArray  # (d,), ``z``
    action_human: FloatArray  # (m,), ``a_h``, rad/s
    action_assist: FloatArray  # (m,), ``a_r``, rad/s
    alpha: float  # arbitration in [0, 1] (equation 2)
    belief: FloatArray  # (G,)
    mode: int  # index in the controller
    command: Command  # as sent
    # radius ``delta / b(g)`` of the ball about the likeliest goal that help constrains the arm to (equation
    # 14), rad; NaN without goals or help, and for help that the equation does not cover
    bound_rad: float = math.nan
    gripper: GripperReading | None = None  # as measured, or None without one
    # (K, 7), poses of the things about the arm in the order of the episode's header: position, m, and
    # quaternion (w, x, y, z), in the base frame. `Step` leaves it empty.
    things: FloatArray = field(default_factory=lambda: NO_THINGS)
    # (K, 2), for each of them the index of the source of its pose in the header, -1 for another one, and the
    # age of the pose, s; empty where the header names no source
    sightings: FloatArray = field(default_factory=lambda: NO_SIGHTINGS)
    pace: float = 1.0  # see `Input.pace`
    delay_s: float = math.nan  # see `Input.delay_s`; NaN also where the input was stale or refused
    # weight of the assistive action on top of the blend: the filters get ``(1 - alpha) a_h + (alpha + added)
    # a_r``. 0 where help replaces the person's action, as in equation 2.
    added: float = 0.0


@dataclass(frozen=True)
class Row:
    """One figure of any study in JSON: ``measure`` is snake_case, ``n`` the number of runs."""

    study: str
    measure: str
    unit: str
    mean: float | None
    sd: float | None
    n: int
    task: str | None = None
    model: str | None = None
    condition: str | None = None
    paper_mean: float | None = None
    paper_sd: float | None = None

    def as_json(self) -> dict[str, object]:
        """The fields by name, ready for ``json.dumps``."""
        return asdict(self)
