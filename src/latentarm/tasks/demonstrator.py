"""A simulated person who guides an arm by hand along strokes (kinesthetic demonstrations)."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, final

import numpy as np

from latentarm.core.errors import UserError
from latentarm.core.types import Demonstrations, Episode, FloatArray
from latentarm.robots.kinematics.chain import Chain
from latentarm.tasks.task import Task

if TYPE_CHECKING:
    from scipy.interpolate import CubicSpline

_FINE = 400  # samples for integrating a stroke's timing
_WAVES = 3  # most half-waves in the low-frequency noise along a stroke


@final
@dataclass(frozen=True)
class Hand:
    """The motion of a simulated person: smooth, varied, without tremor."""

    rate_hz: float = 20.0  # of the samples
    joint_speed: float = 0.42  # largest speed of any joint, rad/s
    tool_speed: float = 0.2  # largest speed of the tool, m/s
    slowest: float = 0.7  # least share of those speeds at which a stroke peaks
    deviation: float = 0.02  # SD of the smooth deviation from the straight path, rad in each joint
    spread: float = 0.008  # SD of a stroke's end, rad in each joint
    undershoot: float = 0.15  # largest share of a stroke that its main movement leaves to a correction
    hurry: float = 0.2  # SD of the logarithm of the speed's variation along a stroke
    pause_s: float = 0.4  # longest rest between strokes, s


def demonstrate(
    chain: Chain, start: FloatArray, strokes: Sequence[FloatArray], hand: Hand, rng: np.random.Generator
) -> FloatArray:
    """States (T, n), rad, from a start along strokes, each of configurations (V, n), rad, with rests."""
    parts = [start[None]]
    for via in strokes:
        moved = _stroke(chain, np.concatenate([parts[-1][-1:], via]), hand, rng)
        rest = rng.integers(0, round(hand.pause_s * hand.rate_hz), endpoint=True)
        parts.append(np.concatenate([moved, np.repeat(moved[-1:], rest, axis=0)]))
    return np.concatenate(parts)


def demonstrate_goals(
    task: Task, stroke: Callable[[int], FloatArray], verb: str, episodes: int, rng: np.random.Generator
) -> Demonstrations:
    """Demonstrations of a task, each of one stroke to a goal, the goals in turn.

    ``stroke`` maps a goal's index to the configurations (V, n), rad, on the way to it; ``verb`` is for the
    episodes' texts. Raises UserError where fewer than one episode is asked for.
    """
    hand, goals = Hand(), task.goals

    def episode(index: int) -> Episode:
        goal = index % len(goals)
        state = demonstrate(task.robot.chain, task.sample_start(goal, rng), (stroke(goal),), hand, rng)
        timestamp = np.arange(len(state)) / hand.rate_hz
        return Episode(state=state, timestamp=timestamp, task=f"{verb} {goals[goal].name}")

    return demonstrations_of(task, episode, episodes, hand)


def demonstrations_of(
    task: Task, episode: Callable[[int], Episode], episodes: int, hand: Hand
) -> Demonstrations:
    """Episodes of a task, with its robot and goals; ``episode`` makes the one with an index."""
    if episodes < 1:
        raise UserError(f"Ask for at least one demonstration, not {episodes}.")
    robot = task.robot
    return Demonstrations(
        episodes=tuple(episode(index) for index in range(episodes)),
        rate_hz=hand.rate_hz,
        joint_names=robot.joint_names,
        robot=robot.name,
        goals=task.goals,
        end_effector=robot.end_effector,
        limits=robot.stated_limits,
    )


def _stroke(chain: Chain, via: FloatArray, hand: Hand, rng: np.random.Generator) -> FloatArray:
    """One movement through configurations (V, n), without its first sample: (T, n)."""
    from scipy.interpolate import CubicSpline  # 0.14 s, for which a drive on the page waits

    progress = _progress(hand, rng)
    fine = _path(via, hand, rng)(progress)
    # Per unit of the stroke's own time, which is 1 in total.
    joint_speed = np.abs(np.diff(fine, axis=0)).max() * _FINE
    tool_speed = np.linalg.norm(np.diff(chain.forward(fine).position, axis=0), axis=-1).max() * _FINE
    effort = rng.uniform(hand.slowest, 1.0)
    duration = max(joint_speed / hand.joint_speed, tool_speed / hand.tool_speed) / effort
    samples = max(int(np.ceil(duration * hand.rate_hz)), 2)
    own_time = np.linspace(0.0, 1.0, samples + 1)[1:]
    return CubicSpline(np.linspace(0.0, 1.0, _FINE + 1), fine)(own_time)


def _path(via: FloatArray, hand: Hand, rng: np.random.Generator) -> "CubicSpline":
    from scipy.interpolate import CubicSpline

    knots = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(via, axis=0), axis=-1))])
    progress = np.linspace(0.0, 1.0, 50)
    curve = CubicSpline(knots / knots[-1], via)(progress)
    wave = np.arange(1, _WAVES + 1)
    sway = rng.normal(0.0, hand.deviation / wave, (via.shape[1], _WAVES)) @ np.sin(
        np.pi * np.outer(wave, progress)
    )
    miss = rng.normal(0.0, hand.spread, via.shape[1])
    return CubicSpline(progress, curve + sway.T + progress[:, None] * miss)


def _progress(hand: Hand, rng: np.random.Generator) -> FloatArray:
    """Completed share of a stroke, from 0 to 1, over its own time: (_FINE + 1,).

    A main movement falls a little short, and a correction that begins before it ends does the rest (both of
    minimum jerk); the clock of both runs unevenly.
    """
    own_time = np.linspace(0.0, 1.0, _FINE + 1)
    wave = np.arange(1, _WAVES + 1)
    hurry = np.exp(rng.normal(0.0, hand.hurry / wave, _WAVES) @ np.sin(np.pi * np.outer(wave, own_time)))
    clock = np.concatenate([[0.0], np.cumsum(hurry[1:] + hurry[:-1])])
    clock /= clock[-1]
    short = rng.uniform(0.0, hand.undershoot)
    main_end, correction_start = rng.uniform(0.75, 0.9), rng.uniform(0.5, 0.65)
    main = _minimum_jerk(clock / main_end)
    correction = _minimum_jerk((clock - correction_start) / (1.0 - correction_start))
    return (1.0 - short) * main + short * correction


def _minimum_jerk(share: FloatArray) -> FloatArray:
    """Flash and Hogan's profile from 0 to 1."""
    t = np.clip(share, 0.0, 1.0)
    return t**3 * (10.0 - 15.0 * t + 6.0 * t**2)
