"""Two cups before an arm, each to be reached and then grasped from the side or from the top (section 8.2)."""

from abc import ABC, abstractmethod
from functools import cached_property
from typing import final

import numpy as np
from scipy.interpolate import CubicSpline

from latentarm.errors import UserError
from latentarm.robots.catalogue import load_robot
from latentarm.robots.robot import Robot
from latentarm.tasks.demonstrator import Hand, demonstrate
from latentarm.tasks.inverse_kinematics import solve
from latentarm.tasks.task import Task
from latentarm.tasks.tolerance import within
from latentarm.types import Demonstrations, Episode, FloatArray, Goal, Pose

BEFORE = (0.06, 0.0, 0.0)
GRASPS = {"side": (0.0, 0.03, 0.35), "top": (0.0, -0.03, -0.35)}
START_SPREAD_RAD = 0.05
_VIA = 3
SPEED_RAD_S = 0.3
BEARING = 0.5
RADIUS = 0.6
HEIGHT = 0.25
import os
LEFT = float(os.environ.get('LEFT', 0))


class TwoCups(Task, ABC):
    @property
    def manners(self) -> tuple[str, ...]:
        return ("side", "top")

    @property
    def obstacles(self) -> tuple[()]:
        return ()

    @property
    def goals(self) -> tuple[Goal, ...]:
        return self._goals

    @property
    @abstractmethod
    def start(self) -> FloatArray: ...

    @abstractmethod
    def at(self, cup: int, back: float, up: float, pitch: float) -> Pose: ...

    def sample_start(self, goal: int, rng: np.random.Generator) -> FloatArray:
        return self.start + rng.normal(0.0, START_SPREAD_RAD, self.robot.dof)

    def waypoints(self, goal: int, manner: str) -> tuple[Pose, ...]:
        return self.goals[goal].pose, self.robot.chain.forward(self._grasps[goal, manner][-1])

    def reached(self, pose: Pose, waypoint: Pose) -> bool:
        return within(pose, waypoint)

    def demonstrate(self, episodes: int, rng: np.random.Generator) -> Demonstrations:
        hand = Hand()
        return Demonstrations(
            episodes=tuple(self._episode(i, hand, rng) for i in range(episodes)),
            rate_hz=hand.rate_hz,
            joint_names=self.robot.joint_names,
            robot=self.robot.name,
            goals=self.goals,
        )

    def _episode(self, index: int, hand: Hand, rng: np.random.Generator) -> Episode:
        goal, manner = index % 2, self.manners[index // 2 % 2]
        strokes = (self.goals[goal].configuration[None], self._grasps[goal, manner])
        state = demonstrate(self.robot.chain, self.sample_start(goal, rng), strokes, hand, rng)
        way = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(state, axis=0), axis=-1))])
        keep = np.concatenate([[True], np.diff(way) > 1e-9])
        even = np.arange(0.0, way[-1], SPEED_RAD_S / hand.rate_hz)
        state = CubicSpline(way[keep], state[keep])(even)
        action = np.diff(state, axis=0) * hand.rate_hz
        state = state[:-1]
        return Episode(
            state=state,
            action=action,
            timestamp=np.arange(len(state)) / hand.rate_hz,
            task=f"grasp the {self.goals[goal].name} from the {manner}",
        )

    @cached_property
    def _goals(self) -> tuple[Goal, ...]:
        goals = []
        for cup, name in enumerate(("left cup", "right cup")):
            posture = self.start.copy()
            posture[0] += BEARING * (1 - 2 * cup)
            q = solve(self.robot, self.at(cup, *BEFORE), posture)
            goals.append(Goal(name, q, self.robot.chain.forward(q)))
        return tuple(goals)

    @cached_property
    def _grasps(self) -> dict[tuple[int, str], FloatArray]:
        grasps = {}
        for cup in range(2):
            for manner in self.manners:
                via, q = [], self.goals[cup].configuration
                for share in np.linspace(0, 1, _VIA + 1)[1:]:
                    place = (a + share * (b - a) for a, b in zip(BEFORE, GRASPS[manner]))
                    q = solve(self.robot, self.at(cup, *place), q)
                    via.append(q)
                grasps[cup, manner] = np.stack(via)
        return grasps


@final
class PlanarTwoCups(TwoCups):
    @property
    def name(self) -> str:
        return "planar_two_cups"

    @cached_property
    def robot(self) -> Robot:
        return load_robot("planar")

    @cached_property
    def start(self) -> FloatArray:
        return np.array([1.87, -1.6, -1.6, -0.6, 0.7])

    def at(self, cup, back, across, turn):
        b = BEARING * (1 - 2 * cup)
        out, left = np.array([np.cos(b), np.sin(b), 0]), np.array([-np.sin(b), np.cos(b), 0])
        c, s = np.cos(b + turn), np.sin(b + turn)
        return Pose((RADIUS - back) * out + across * left, np.array([[c, -s, 0], [s, c, 0], [0, 0, 1.0]]))


@final
class PandaTwoCups(TwoCups):
    @property
    def name(self) -> str:
        return "panda_two_cups"

    @cached_property
    def robot(self) -> Robot:
        return load_robot("panda")

    @cached_property
    def start(self) -> FloatArray:
        return np.array([0.0, -0.6, 0.0, -2.4, 0.0, 2.2, np.pi / 4])

    def at(self, cup, back, across, turn):
        b = BEARING * (1 - 2 * cup)
        out = np.array([np.cos(b), np.sin(b), 0.0])
        pitch = -1.2 + turn
        points = np.cos(pitch) * out + np.array([0, 0, np.sin(pitch)])
        side = np.array([out[1], -out[0], 0.0])
        rotation = np.stack([np.cross(side, points), side, points], axis=-1)
        left = np.array([-out[1], out[0], 0.0])
        return Pose((RADIUS - back) * out + LEFT * across * left + np.array([0, 0, HEIGHT - across]), rotation)
