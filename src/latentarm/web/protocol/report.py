"""The control process's report to the page's server, in every tick."""

from typing import ClassVar, Final, Literal

from latentarm.surroundings.tracker import Seen
from latentarm.tasks.mishap import MishapKind
from latentarm.web.protocol.notice import Message, Notice
from latentarm.web.protocol.orders import HelpLevel, ModeName

HeldBack = Literal["clearance", "freshness", "workspace", "joint_position", "force", "zone"]
Phase = Literal["disengaged", "neutral_needed", "ready", "moving", "stopping"]
Guiding = Literal["offered", "on", "own"]
"""*own*: guiding by hand is a mode of the arm's own, which is switched on at the arm."""

Point = tuple[float, float, float]
PoseRow = tuple[float, float, float, float, float, float, float]  # x, y, z (m) and a quaternion w, x, y, z


class Ghosts(Message):
    """Where each full deflection would take the tool over the next second: all of it, or nothing at all."""

    up: tuple[Point, ...]  # points of the path, m; empty, like all the others, before they are known
    down: tuple[Point, ...]
    left: tuple[Point, ...]
    right: tuple[Point, ...]
    # the tool at the end of that second, for directions all round the stick, counter-clockwise from the
    # right
    ring: tuple[PoseRow, ...]


NO_GHOSTS: Final = Ghosts(up=(), down=(), left=(), right=(), ring=())


class Recording(Message):
    """A recording under way or done."""

    on: bool  # whether an episode is under way
    samples: int  # of this episode so far
    episodes: int  # complete ones in the journal
    problem: Notice | None  # why the last episode was broken off, or None


class GripperState(Message):
    """The gripper; ``closing``: whether the last command was to close, None before the first."""

    width_m: float
    holding: bool
    closing: bool | None


class SeenThing(Message):
    """Tracking state of a thing, see `latentarm.surroundings.tracker.Whereabouts`."""

    name: str
    seen: Seen
    age_s: int  # of its newest sighting
    source: str  # of that sighting, as ``--objects`` names it; "" before the first


class Things(Message):
    """Where things and grains are, in the order of ``/scene.json``."""

    poses: tuple[PoseRow, ...]
    grains: tuple[tuple[float, ...], ...]  # for each kind, x, y, z of one grain after the other, m
    seen: tuple[SeenThing, ...] = ()  # of the things whose places are not the simulation's truth


class Why(Message):
    """Why a run of a task has failed; ``thing`` names the thing or the grains concerned."""

    code: MishapKind
    thing: str


class ToGo(Message):
    """The remaining way to where the tool is to be next."""

    shift_m: Point  # along the axes of the base frame, m
    turn_rad: Point  # about the tool's own axes, a rotation vector, rad
    gripper: Literal["open", "close"] | None  # the action to request now; null for none


class Lost(Message):
    """A thing that a step needs, no longer held; ``step`` is the index of the step that takes it again."""

    thing: str
    step: int


class Fill(Message):
    """How full a cup or a bowl is."""

    thing: str
    share: float  # of what is poured, in [0, 1]
    enough: float | None  # share that must be in it; null for the vessel poured from


class TaskState(Message):
    """Progress of a run of the task."""

    choice: int  # index of what is to be done
    done: int  # number of completed steps
    outcome: Literal["success", "failure"] | None  # null while it goes on
    why: Why | None  # why it has failed
    time_s: float  # since the arm was first enabled in this run, until its outcome, s
    to_go: ToGo | None  # for the current step; null where nothing is left to do
    # a thing that slipped or was let go too early: it is to be taken again before the steps go on
    lost: Lost | None
    fills: tuple[Fill, ...]  # of the cups and bowls, where something is poured
    short: bool  # whether too little is left to pour


class ArmState(Message):
    """The part of the arm's state that a `Report` and a `State` have in common."""

    extensible: ClassVar[bool] = True

    nonce: str  # for the driver to echo in the next input
    tick: int
    # ``disengaged``, ``neutral_needed`` (the stick must be let go), ``ready`` (enabled and standing still),
    # ``moving``, ``stopping``
    phase: Phase
    note: Notice | None  # shown for a while instead of the state; None for nothing
    reason: Notice | None  # why the arm may not move; None if it may
    held_back: HeldBack | None  # why it moves slower than asked; None if it does not
    zone: str | None  # name of the zone that slows it down now; None if none does
    returning: bool  # whether it is on its way back to its start, or to a saved pose
    bound_for: str | None  # name of that pose; None on the way to the start, and on no way
    at_start: bool  # whether it is there
    guiding: Guiding | None  # None if the arm cannot be guided by hand
    lost: bool  # whether the connection to the arm is lost
    let_go_first: bool  # whether the stick does something else now: it must be let go before it moves the arm
    idle_left_s: int | None  # until it is disabled because nobody gives an input, shortly before; else None
    mode: ModeName
    axes: int  # which pair of the end-effector's axes
    help: HelpLevel | None  # level of help with learned motions; None without help
    profile: str | None  # whose alignment
    tool: Point
    gripper: GripperState | None  # as last read; None if the arm has no gripper, or before the first reading
    held: tuple[str, ...]  # names of what counts as a part of the arm because it holds it
    task: TaskState
    things: Things | None  # where they are; None in an empty scene, and if they have not changed
    ghosts: Ghosts | None  # None, only in a `State`, while the last ones hold
    alpha: float  # the robot's share, in [0, 1]
    late_share: float  # share of the control loop's deadlines that were missed
    recording: Recording | None  # None before the first


class Report(ArmState):
    """Report of the control process in every tick."""

    time_s: float  # the control process's clock
    driver: int  # number of the driver whose inputs count
    run: str | None  # path of the run that is driven; None without one
    own_task: bool  # see `Spec`
    seed: int  # decides where things were placed and where the arm started
    loading: bool  # whether another setup is being loaded; there are no further reports until it is
    q: tuple[float, ...]  # (n,), joint positions as last read, rad
    reading_age_s: float  # how long ago that was, s
    belief: tuple[float, ...]  # over the goals; empty for a task without goals
    journal: str | None  # path of the journal that is or was last recorded to; None before the first
