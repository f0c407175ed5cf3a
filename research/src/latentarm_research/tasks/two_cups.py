"""Two cups before an arm, each to reach and then to grasp from the side or from the top (section 8.2).

One input chooses first the cup and then the grasp. The paper leaves the place open; we chose, once and for
every model:

- The cups stand left and right of the arm's start, equally far, 1 rad apart about the base.

- A goal is the configuration just before a cup, from where both grasps begin.

- The two grasps part to opposite sides and end 0.4 to 0.9 rad from the goal in joint space, less than the
distance between the goals.

- Joint 1 turns the arm to a cup and rests during a grasp, so that inputs then choose the manner and no longer
the goal, as in the paper.

- Every demonstration shows both grasps, out and back: at a cup, either direction of the input has a meaning.

- The simulated person moves at one speed, so that the latent action does not encode speed.
"""

from abc import ABC, abstractmethod
from collections.abc import Callable
from functools import cached_property
from typing import Final, NamedTuple, final

import numpy as np
from scipy.interpolate import CubicSpline

from latentarm.core.errors import UserError
from latentarm.core.types import Demonstrations, Episode, FloatArray, Goal, Pose
from latentarm.robots.catalogue import load_robot
from latentarm.robots.robot import Robot
from latentarm.tasks.demonstrator import Hand, demonstrate, demonstrations_of
from latentarm.tasks.inverse_kinematics import solve
from latentarm.tasks.task import Task, within

CUPS: Final = ("left cup", "right cup")

BEARING_RAD: Final = 0.5
"""Direction from the base to the left cup; the right cup is at its negative."""

DISTANCE_M: Final = 0.6
"""Of the cups from the base's axis."""

SPEED_RAD_S: Final = 0.3
"""Of the simulated person's ‖a‖."""

START_SPREAD_RAD: Final = 0.05
"""SD of where a joint starts."""

_TURN: Final = 0
"""Index of the joint that turns the arm about its base."""

_TURNED: Final = 0.3
"""How far the other joints have come when the arm has turned to a cup, of their way to it."""

_VIA: Final = 3
"""Configurations along a grasp, so that the tool follows a line."""


class Place(NamedTuple):
    """A place of the tool relative to a cup."""

    back: float  # towards the base, m
    left: float  # m
    up: float  # m; unused by a planar arm
    # from the approach orientation, rad: about the vertical for a planar arm, otherwise towards the
    # horizontal
    turn: float


class TwoCups(Task, ABC):
    """Two cups and an arm that grasps one of them; the demonstrator is simulated."""

    manners = ("side", "top")
    obstacles = ()  # the arm may touch the cups
    before: Place = Place(back=0.06, left=0.0, up=0.0, turn=0.0)
    """Where a reach ends and a grasp begins."""

    @property
    @abstractmethod
    def start(self) -> FloatArray:
        """(n,), rad: before both cups and equally far from them."""

    @property
    @abstractmethod
    def posture(self) -> FloatArray:
        """(n,), rad: the approach of a cup straight ahead; joint 1 turns it sideways."""

    @property
    @abstractmethod
    def grasps(self) -> dict[str, Place]:
        """The end of each manner of grasping."""

    @abstractmethod
    def pose(self, bearing_rad: float, place: Place) -> Pose:
        """The tool's pose at a place, seen from a cup at a bearing."""

    @property
    def goals(self) -> tuple[Goal, ...]:
        """Just before each cup."""
        return self._goals

    def sample_start(self, goal: int, rng: np.random.Generator) -> FloatArray:
        """About `start`, (n,), rad."""
        return self.start + rng.normal(0.0, START_SPREAD_RAD, self.robot.dof)

    def waypoints(self, goal: int, manner: str) -> tuple[Pose, ...]:
        """Just before the cup, then the end of the grasp."""
        if not 0 <= goal < len(CUPS) or manner not in self.manners:
            raise UserError(
                f"There are cups 0 and 1, to be grasped from the {' or the '.join(self.manners)}, "
                f"not {goal} from the {manner!r}."
            )
        return self.goals[goal].pose, self.robot.chain.forward(self._strokes[goal, manner][-1])

    def reached(self, pose: Pose, waypoint: Pose) -> bool:
        """Within 0.03 m and 20 degrees."""
        return within(pose, waypoint)

    def demonstrate(self, episodes: int, rng: np.random.Generator) -> Demonstrations:
        """Reach, grasp and let go in both manners, with the actions as taken.

        Cups take turns, and so does the manner that comes first.
        """
        hand = Hand()
        return demonstrations_of(self, lambda index: self._episode(index, hand, rng), episodes, hand)

    def _episode(self, index: int, hand: Hand, rng: np.random.Generator) -> Episode:
        goal = index % len(CUPS)
        first = index // len(CUPS) % len(self.manners)
        manners = (*self.manners[first:], *self.manners[:first])
        start, end = self.sample_start(goal, rng), self.goals[goal].configuration
        turned = start + _TURNED * (end - start)
        turned[_TURN] = end[_TURN]
        grasps = [self._strokes[goal, manner] for manner in manners]
        # The same way back, and then to where the grasp began.
        backs = [np.concatenate([out[-2::-1], end[None]]) for out in grasps]
        grasping = [stroke for out_and_back in zip(grasps, backs, strict=True) for stroke in out_and_back]
        strokes = [np.stack([turned, end]), *grasping]
        led = demonstrate(self.robot.chain, start, strokes, hand, rng)
        state = _at_one_speed(led, SPEED_RAD_S / hand.rate_hz)
        velocity = np.diff(state, axis=0) * hand.rate_hz
        return Episode(
            state=state,
            # Nothing is done at the last state.
            action=np.concatenate([velocity, np.zeros_like(velocity[:1])]),
            timestamp=np.arange(len(state)) / hand.rate_hz,
            task=f"grasp the {CUPS[goal]} from the {' and then from the '.join(manners)}",
        )

    @cached_property
    def _goals(self) -> tuple[Goal, ...]:
        return tuple(self._goal(cup) for cup in range(len(CUPS)))

    def _goal(self, cup: int) -> Goal:
        posture = self.posture.copy()
        posture[0] += _bearing(cup)
        configuration = solve(self.robot, self.pose(_bearing(cup), self.before), posture)
        return Goal(CUPS[cup], configuration, self.robot.chain.forward(configuration))

    @cached_property
    def _strokes(self) -> dict[tuple[int, str], FloatArray]:
        """Configurations along each grasp, by cup and manner, each (_VIA, n), rad."""
        return {
            (cup, manner): self._stroke(cup, end)
            for cup in range(len(CUPS))
            for manner, end in self.grasps.items()
        }

    def _stroke(self, cup: int, end: Place) -> FloatArray:
        via = [self.goals[cup].configuration]
        for share in np.linspace(0.0, 1.0, _VIA + 1)[1:]:
            place = Place(*(a + share * (b - a) for a, b in zip(self.before, end, strict=True)))
            via.append(solve(self.robot, self.pose(_bearing(cup), place), via[-1], held=(_TURN,)))
        return np.stack(via[1:])


@final
class PlanarTwoCups(TwoCups):
    """A planar arm of 5 joints, seen from above; the second grasp mirrors the first, for lack of a top."""

    name = "planar_two_cups"

    @property
    def grasps(self) -> dict[str, Place]:
        """From the left side and, in the place of the top, from the right."""
        return {"side": Place(0.0, 0.03, 0.0, 0.35), "top": Place(0.0, -0.03, 0.0, -0.35)}

    @property
    def robot(self) -> Robot:
        """A planar arm of 5 joints."""
        return self._robot

    @property
    def start(self) -> FloatArray:
        """The tool drawn back along the middle between the cups: (5,), rad."""
        return np.array([2.1, -1.14, -1.83, -0.5, 1.45])

    @property
    def posture(self) -> FloatArray:
        """The elbow to the left: (5,), rad."""
        return np.array([2.1, -1.5, -1.26, -0.28, 0.94])

    def pose(self, bearing_rad: float, place: Place) -> Pose:
        """In the plane, the tool's x axis towards the cup."""
        out, left = _axes(bearing_rad)
        position = (DISTANCE_M - place.back) * out + place.left * left
        pointing, across = _axes(bearing_rad + place.turn)
        return Pose(position, np.stack([pointing, across, np.array([0.0, 0.0, 1.0])], axis=-1))

    @cached_property
    def _robot(self) -> Robot:
        return load_robot("planar")


@final
class PandaTwoCups(TwoCups):
    """A Panda whose hand tilts towards the horizontal for the side and upright for the top."""

    HEIGHT_M: Final = 0.25
    """Of the cups above the base."""

    PITCH_RAD: Final = -1.3
    """Of the hand's pointing direction above the horizontal, where a cup is approached."""

    name = "panda_two_cups"

    @property
    def grasps(self) -> dict[str, Place]:
        """Lower and from the left side; higher, pointing down, and from the right."""
        return {"side": Place(0.0, 0.06, -0.03, 0.25), "top": Place(0.0, -0.06, 0.03, -0.25)}

    @property
    def robot(self) -> Robot:
        """A Panda."""
        return self._robot

    @property
    def start(self) -> FloatArray:
        """Above and before the cups: (7,), rad."""
        return np.array([0.0, -0.6, 0.0, -2.4, 0.0, 2.2, np.pi / 4])

    @property
    def posture(self) -> FloatArray:
        """As at the start: (7,), rad."""
        return self.start

    def pose(self, bearing_rad: float, place: Place) -> Pose:
        """The tool's z axis points outwards and down."""
        out, left = _axes(bearing_rad)
        up = np.array([0.0, 0.0, 1.0])
        position = (DISTANCE_M - place.back) * out + place.left * left + (self.HEIGHT_M + place.up) * up
        pitch = self.PITCH_RAD + place.turn
        pointing = np.cos(pitch) * out + np.sin(pitch) * up
        # The axis across that makes the three a right-handed frame.
        across = np.cos(pitch) * up - np.sin(pitch) * out
        return Pose(position, np.stack([across, -left, pointing], axis=-1))

    @cached_property
    def _robot(self) -> Robot:
        return load_robot("panda")


TWO_CUPS: Final[dict[str, Callable[[], TwoCups]]] = {"planar": PlanarTwoCups, "panda": PandaTwoCups}
"""The task by the arm's name."""


def _bearing(cup: int) -> float:
    return BEARING_RAD if cup == 0 else -BEARING_RAD


def _axes(bearing_rad: float) -> tuple[FloatArray, FloatArray]:
    """Unit vectors outwards and to the left at a bearing, each (3,)."""
    cos, sin = np.cos(bearing_rad), np.sin(bearing_rad)
    return np.array([cos, sin, 0.0]), np.array([-sin, cos, 0.0])


def _at_one_speed(state: FloatArray, step_rad: float) -> FloatArray:
    """The same way (T, n) in equal steps in joint space, without rests."""
    step = np.linalg.norm(np.diff(state, axis=0), axis=-1)
    moving = np.concatenate([[True], step > 1e-9])
    way = np.concatenate([[0.0], np.cumsum(step)])
    return CubicSpline(way[moving], state[moving])(np.arange(0.0, way[-1], step_rad))
