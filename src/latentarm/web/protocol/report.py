"""The control process's report to the page's server, in every tick."""

from typing import Final, Literal, final

from pydantic import ValidationError

from latentarm.tasks.mishap import MishapKind
from latentarm.web.protocol.notice import Message, Notice
from latentarm.web.protocol.orders import HelpLevel, ModeName

HeldBack = Literal["clearance", "freshness", "workspace", "joint_position", "zone"]
Phase = Literal["disengaged", "neutral_needed", "ready", "moving", "stopping"]
Guiding = Literal["offered", "on", "own"]
"""*own*: guiding by hand is a mode of the arm's own, which is switched on at the arm."""

Point = tuple[float, float, float]
PoseRow = tuple[float, float, float, float, float, float, float]
"""x, y, z (m) and a quaternion w, x, y, z."""


@final
class Ghosts(Message):
    """Where each full deflection would take the tool over the next second: all of it, or nothing at all.

    Attributes:
        up: points of the path, m; empty, like all the others, before they are known.
        ring: the tool at the end of that second, for directions all round the stick, counter-clockwise from
            the right.
    """

    up: tuple[Point, ...]
    down: tuple[Point, ...]
    left: tuple[Point, ...]
    right: tuple[Point, ...]
    ring: tuple[PoseRow, ...]


NO_GHOSTS: Final = Ghosts(up=(), down=(), left=(), right=(), ring=())


@final
class Recording(Message):
    """A recording under way or done.

    Attributes:
        on: whether an episode is under way.
        samples: of this episode so far.
        episodes: complete ones in the journal.
        problem: why the last episode was broken off, or None.
    """

    on: bool
    samples: int
    episodes: int
    problem: Notice | None
    journal: str


@final
class GripperState(Message):
    """The gripper; ``closing``: whether the last command was to close, None before the first."""

    width_m: float
    holding: bool
    closing: bool | None


@final
class Things(Message):
    """Where things and grains are, in the order of ``/scene.json``.

    Attributes:
        grains: for each kind, x, y, z of one grain after the other, m.
    """

    poses: tuple[PoseRow, ...]
    grains: tuple[tuple[float, ...], ...]


@final
class Why(Message):
    """Why a run of a task has failed; ``thing`` names the thing or the grains concerned."""

    code: MishapKind
    thing: str


@final
class ToGo(Message):
    """The remaining way to where the tool is to be next.

    Attributes:
        shift_m: along the axes of the base frame, m.
        turn_rad: about the tool's own axes, a rotation vector, rad.
        gripper: the action to request now; null for none.
    """

    shift_m: Point
    turn_rad: Point
    gripper: Literal["open", "close"] | None


@final
class Lost(Message):
    """A thing that a step needs, no longer held; ``step`` is the index of the step that takes it again."""

    thing: str
    step: int


@final
class Fill(Message):
    """How full a cup or a bowl is.

    Attributes:
        share: of what is poured, in [0, 1].
        enough: share that must be in it; null for the vessel poured from.
    """

    thing: str
    share: float
    enough: float | None


@final
class TaskState(Message):
    """Progress of a run of the task.

    Attributes:
        choice: index of what is to be done.
        done: number of completed steps.
        outcome: null while it goes on.
        why: why it has failed.
        time_s: since the arm was first enabled in this run, until its outcome, s.
        to_go: for the current step; null where nothing is left to do.
        lost: a thing that slipped or was let go too early: it is to be taken again before the steps go on.
        fills: of the cups and bowls, where something is poured.
        short: whether too little is left to pour.
    """

    choice: int
    done: int
    outcome: Literal["success", "failure"] | None
    why: Why | None
    time_s: float
    to_go: ToGo | None
    lost: Lost | None
    fills: tuple[Fill, ...]
    short: bool


class ArmState(Message):
    """The part of the arm's state that a `Report` and a `State` have in common.

    Attributes:
        nonce: for the driver to echo in the next input.
        phase: ``disengaged``, ``neutral_needed`` (the stick must be let go), ``ready`` (enabled and standing
            still), ``moving``, ``stopping``.
        note: shown for a while instead of the state; None for nothing.
        reason: why the arm may not move; None if it may.
        held_back: why it moves slower than asked; None if it does not.
        zone: name of the zone that slows it down now; None if none does.
        returning: whether it is on its way back to its start, or to a saved pose.
        bound_for: name of that pose; None on the way to the start, and on no way.
        at_start: whether it is there.
        guiding: None if the arm cannot be guided by hand.
        lost: whether the connection to the arm is lost.
        let_go_first: whether the stick does something else now: it must be let go before it moves the arm.
        late_stops: stops because no input came in time, since this driver began to drive this.
        axes: which pair of the end-effector's axes.
        help: level of help with learned motions; None without help.
        profile: whose alignment.
        gripper: as last read; None if the arm has no gripper, or before the first reading.
        things: where they are; None in an empty scene, and if they have not changed.
        ghosts: None, only in a `State`, while the last ones hold.
        alpha: the robot's share, in [0, 1].
        late_share: share of the control loop's deadlines that were missed.
    """

    nonce: str
    tick: int
    phase: Phase
    note: Notice | None
    reason: Notice | None
    held_back: HeldBack | None
    zone: str | None
    returning: bool
    bound_for: str | None
    at_start: bool
    guiding: Guiding | None
    lost: bool
    let_go_first: bool
    late_stops: int
    mode: ModeName
    axes: int
    help: HelpLevel | None
    profile: str | None
    tool: Point
    gripper: GripperState | None
    task: TaskState
    things: Things | None
    ghosts: Ghosts | None
    alpha: float
    late_share: float


@final
class Report(ArmState):
    """Report of the control process in every tick.

    Attributes:
        time_s: the control process's clock.
        driver: number of the driver whose inputs count.
        run: path of the run that is driven; None without one.
        seed: decides where things were placed and where the arm started.
        loading: whether another setup is being loaded; there are no further reports until it is.
        q: (n,), joint positions as last read, rad.
        belief: over the goals; empty for a task without goals.
        bound_rad: the radius of equation 14, if there is help.
        recording: None before the first.
    """

    time_s: float
    driver: int
    run: str | None
    seed: int
    loading: bool
    q: tuple[float, ...]
    belief: tuple[float, ...]
    bound_rad: float | None
    recording: Recording | None


def parse_report(message: bytes) -> Report | None:
    """Parse a report from its slot; None if it is invalid."""
    try:
        return Report.model_validate_json(message)
    except ValidationError:
        return None
