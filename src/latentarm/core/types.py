"""The vocabulary shared by every package: small frozen records of NumPy arrays.

Symbols follow Losey et al., "Learning Latent Actions to Control Assistive Robots":
state ``s`` (rad), action ``a`` (rad/s), latent action ``z``, input ``u``, context ``c``,
belief ``b``, goal ``g``, end-effector pose ``x``.
"""

import math
from collections.abc import Mapping
from dataclasses import asdict, dataclass, field
from os import PathLike
from typing import Literal

import numpy as np
from numpy.typing import NDArray

StrPath = str | PathLike[str]
"""A file or folder, as the public functions take it."""

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]
BoolArray = NDArray[np.bool_]

NO_GRIPPER: FloatArray = np.zeros(0)
"""`Context.gripper` and `Context.gripper_target` where they are not known."""

NO_OBJECTS: FloatArray = np.zeros((0, 9))
"""`Context.objects` where they are not known."""

NO_THINGS: FloatArray = np.zeros((0, 7))
"""`StepRecord.things` where nobody looks."""

NO_GRIPPER.flags.writeable = NO_OBJECTS.flags.writeable = NO_THINGS.flags.writeable = False


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
        name: what a person would call it.
        configuration: (n,), rad.
        pose: the end-effector pose at ``configuration``.
    """

    name: str
    configuration: FloatArray
    pose: Pose


@dataclass(frozen=True)
class Provenance:
    """Who and what recorded an episode; "" where that is unknown.

    Attributes:
        person: who drove.
        run: name of the trained run that they drove with.
        run_fingerprint: of its model's file.
        profile: the person whose alignment was used.
        device: kind of input device, such as ``keyboard``; ``simulated`` for a simulated person.
        controller: what turned inputs into motion when the episode began.
        version: of this package.
        started_utc: when the episode began, ISO 8601 in UTC.
        complete: whether the recording was ended, rather than cut short.
    """

    person: str = ""
    run: str = ""
    run_fingerprint: str = ""
    profile: str = ""
    device: str = ""
    controller: str = ""
    version: str = ""
    started_utc: str = ""
    complete: bool = True


@dataclass(frozen=True)
class Episode:
    """One demonstration, sampled at increasing times.

    Attributes:
        state: (T, n), joint positions, rad.
        timestamp: (T,), s from the episode's start.
        action: (T, m), joint velocities, rad/s, or None where none were recorded.
        task: what was done, in words.
        extras: further features of the dataset by name (``belief``, ``input.u``, ...), each (T, k).
        provenance: who and what recorded it, or None where nothing is known of that.
    """

    state: FloatArray
    timestamp: FloatArray
    action: FloatArray | None = None
    task: str = ""
    extras: Mapping[str, FloatArray] = field(default_factory=dict)
    provenance: Provenance | None = None


@dataclass(frozen=True)
class StatedJointLimits:
    """What somebody states of one joint; None where they do not. A sliding joint has m instead of rad.

    Attributes:
        position: lowest and highest, rad.
        velocity: rad/s.
        acceleration: rad/s².
        jerk: rad/s³.
        sliding: whether the figures are those of a sliding joint; None where there are no figures.
    """

    position: tuple[float, float] | None = None
    velocity: float | None = None
    acceleration: float | None = None
    jerk: float | None = None
    sliding: bool | None = None


@dataclass(frozen=True)
class StatedGripper:
    """What somebody states of a gripper; see `latentarm.robots.gripper.Gripper`.

    Attributes:
        joints: of the robot's model, that move its fingers or its jaw; empty where the model has none.
        width: the largest opening, m.
        speed: the fastest change of the opening, m/s.
        force: the largest force between the fingers, N.
    """

    joints: tuple[str, ...]
    width: float
    speed: float
    force: float


@dataclass(frozen=True)
class StatedLimits:
    """What somebody states of a robot's limits, as in a limits file.

    Attributes:
        joints: by name; joints that nothing is said of are left out.
        tool_speed: largest speed of the tool, m/s, or None.
        gripper: its gripper, or None where nothing is said of one.
    """

    joints: Mapping[str, StatedJointLimits]
    tool_speed: float | None = None
    gripper: StatedGripper | None = None


@dataclass(frozen=True)
class Demonstrations:
    """The dataset ``D`` as stored on disk: whole episodes of one robot.

    Attributes:
        episodes: the episodes, all with the same n.
        rate_hz: nominal sampling rate.
        joint_names: n names.
        robot: name or model path of the robot, or "" where unknown.
        goals: the discrete goals ``G``, empty where none are known.
        import_record: what importing decided about units, joints and so on, by subject, in words; empty for
            demonstrations that were never imported.
        end_effector: which site, body or link of a model file is the end-effector; None where the robot
            has but one.
        limits: what was stated of the robot's limits, or None.
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
        """What importing warned of, now or before."""
        return [said for subject, said in self.import_record.items() if subject.endswith("warning")]


@dataclass(frozen=True)
class Pairs:
    """Context-action pairs ``(c, a)`` drawn from demonstrations.

    The action is always taken from the states as they were demonstrated. State noise, where
    asked for, is added to ``context`` afterwards, so that it can never be reconstructed from
    the action: ``clean_context`` is the same context without it.

    Attributes:
        context: (N, c), what the decoder sees; its first n entries are the state, rad.
        clean_context: (N, c), ``context`` before state noise.
        action: (N, m), noise-free joint velocity, rad/s.
        episode: (N,), index of the episode that each pair comes from.
        held: (N, K), which of the things in the context move with the arm's tool; none where the arm is not
            known.
    """

    context: FloatArray
    clean_context: FloatArray
    action: FloatArray
    episode: IntArray
    held: BoolArray


@dataclass(frozen=True)
class Context:
    """What the robot knows when it decodes an input; a decoder sees some of it (`latentarm.core.context`).

    Attributes:
        state: (n,), joint positions ``s``, rad.
        belief: (G,), probability over goals ``b``; empty where there are no goals.
        gripper: (1,), opening of the gripper, m; empty where it is not known.
        objects: (K, 9), poses in the base frame of the things that matter: position, m, and the first two
            columns of the rotation matrix (`latentarm.robots.kinematics.pose_rows`); empty where unknown.
        gripper_target: (1,), opening that the gripper was told to go to, m; until it was told anything, its
            own, and 0 where it holds something. Empty where that is not known.
    """

    state: FloatArray
    belief: FloatArray
    gripper: FloatArray = field(default_factory=lambda: NO_GRIPPER)
    objects: FloatArray = field(default_factory=lambda: NO_OBJECTS)
    gripper_target: FloatArray = field(default_factory=lambda: NO_GRIPPER)


GripperAsk = Literal["open", "close", "toggle"]
"""What a person asks of a gripper."""


@dataclass(frozen=True)
class Input:
    """What the person does with their interface at one moment.

    Attributes:
        u: (d,), each entry in [-1, 1].
        switch_mode: the person asks for the controller's next mode.
        gripper: what the person asks of the gripper; None asks nothing. Like a mode switch it counts once,
            however long it is held.
        pace: share of the speed, in [0, 1], that a second person leaves the first. It counts after all
            limits, for everything that moves: what the robot adds, a way back, the gripper.
        opens: whether the person holds down what opens the gripper of an arm that is not enabled.
    """

    u: FloatArray
    switch_mode: bool = False
    gripper: GripperAsk | None = None
    pace: float = 1.0
    opens: bool = False


@dataclass(frozen=True)
class GripperReading:
    """What a gripper measured at one moment.

    Attributes:
        width_m: opening between the fingers, m.
        holding: whether something is held between them.
    """

    width_m: float
    holding: bool = False


@dataclass(frozen=True)
class Reading:
    """What an arm measured at one moment.

    Attributes:
        q: (n,), joint positions, rad.
        dq: (n,), joint velocities, rad/s.
        time_s: when they were measured, on the control loop's clock, s.
        sequence: grows with every new reading, across reconnections too.
        gripper: of its gripper, or None where it has none.
    """

    q: FloatArray
    dq: FloatArray
    time_s: float
    sequence: int
    gripper: GripperReading | None = None


StopCode = Literal[
    "arm_emergency_stop",
    "arm_fault",
    "arm_off",
    "clock_jumped",
    "clock_stood_still",
    "controller_failed",
    "controller_invalid",
    "emergency_stop_released",
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
    """A safety filter's refusal.

    Attributes:
        reason: one short sentence for the person, in English.
        untrusted: the readings of the joints cannot be true; a recording ends before them.
        code: what kind of stop it is, for interfaces in other languages; None where somebody else than this
            package says why.
        parameters: what such a sentence names; a name of a number ends in its unit.
    """

    reason: str
    untrusted: bool = False
    code: StopCode | None = field(default=None, compare=False)
    parameters: Mapping[str, str | int] = field(default_factory=dict, compare=False)


@dataclass(frozen=True)
class GripperCommand:
    """Where a gripper is to go, and how hard it may press.

    Attributes:
        width_m: opening to reach, m.
        speed_m_s: how fast the opening may change, m/s. At 0 the fingers stay where they are, whatever the
            width says, and hold what they hold as hard as they do now, and no harder.
        force_n: how hard the fingers may press together, N; a gripper that holds something keeps this force.
    """

    width_m: float
    speed_m_s: float
    force_n: float


@dataclass(frozen=True)
class Command:
    """What leaves the safety filter for the robot.

    Attributes:
        velocity: (n,), rad/s, finite and within limits.
        duration_s: the robot must stop by itself if no new command arrives within this time.
        stop: why the arm is being stopped, or None.
        limited_by: names of the filters that changed what was asked for.
        gripper: where the gripper is to go, or None where it is to stay as it is. Unlike a velocity it does
            not run out: what is held must not fall when commands end.
    """

    velocity: FloatArray
    duration_s: float
    stop: Stop | None = None
    limited_by: tuple[str, ...] = ()
    gripper: GripperCommand | None = None


@dataclass(frozen=True)
class StepRecord:
    """Everything that one pass through Algorithm 1 read and decided.

    Attributes:
        time_s: the loop's monotonic clock.
        state: (n,), ``s``, rad; NaN where the arm's reading could not be used.
        input: (d,), ``u`` as it was used (zero where it was stale or refused).
        latent: (d,), ``z``.
        action_human: (m,), ``a_h``, rad/s.
        action_assist: (m,), ``a_r``, rad/s.
        alpha: arbitration in [0, 1] (equation 2).
        belief: (G,), belief that this step used.
        mode: index of the controller's mode.
        command: what was sent.
        bound_rad: radius ``delta / b(g)`` of the ball about the likeliest goal that help towards the
            goals constrains the arm to (equation 14), rad; NaN without goals or help, and for help that
            the equation is not about.
        gripper: what the gripper measured, or None without one.
        things: (K, 7), where the things about the arm stand, in the order of the episode's header: position,
            m, and quaternion (w, x, y, z), in the base frame; empty where nobody looks. `Step` does not.
        pace: share of the speed that a second person left, see `Input.pace`.
        added: how much of the assistive action was added to the person's: what the filters were asked for is
            ``(1 - alpha) a_h + (alpha + added) a_r``. 0 where help takes the place of the person's
            action, as in equation 2.
    """

    time_s: float
    state: FloatArray
    input: FloatArray
    latent: FloatArray
    action_human: FloatArray
    action_assist: FloatArray
    alpha: float
    belief: FloatArray
    mode: int
    command: Command
    bound_rad: float = math.nan
    gripper: GripperReading | None = None
    things: FloatArray = field(default_factory=lambda: NO_THINGS)
    pace: float = 1.0
    added: float = 0.0


@dataclass(frozen=True)
class Row:
    """One figure of any study, in the one format that every command prints as JSON.

    Absent fields are None. ``measure`` names are snake_case, ``n`` is the number of runs.
    """

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
        """Plain mapping, ready for ``json.dumps``."""
        return asdict(self)
