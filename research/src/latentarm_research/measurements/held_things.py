"""Push a cup and a long spoon in a Panda's hand at things, at the arm and through a zone.

In each drive the arm is pushed as in `clearance`, and takes the thing at once or on the way, perhaps inside
something. MuJoCo measures the thing's own shape, finer than the box that the filters know.
"""

from collections.abc import Callable
from dataclasses import replace
from typing import Final

import mujoco
import numpy as np

from latentarm.control.step import Step
from latentarm.core.types import FloatArray, GripperReading, Input, Pose, Reading
from latentarm.robots.held import holding
from latentarm.robots.kinematics.obstacles import Box, HalfSpace, Sphere
from latentarm.robots.panda import panda
from latentarm.robots.parts import add_parts
from latentarm.robots.robot import Robot
from latentarm.robots.scene.thing import Part, Thing
from latentarm.safety.config import SafetyConfig
from latentarm.safety.supports import level_face
from latentarm.safety.zones import Zone
from latentarm.surroundings.held_things import HeldThings
from latentarm_research.measurements.geom_distances import Judge
from latentarm_research.measurements.measurement import Outcome, Work, line
from latentarm_research.measurements.pushing import HARMS, PERIOD_S, TRAY, Pusher, scene

STOOD: Final = Pose(np.zeros(3), np.eye(3))
SPOON: Final = (
    Part("capsule", (0.005, 0.12), (0.0, 0.0, 0.10)),
    Part("box", (0.014, 0.006, 0.025), (0.0, 0.0, 0.25)),
)
THINGS: Final = {
    "cup": Thing("cup", (Part("cylinder", (0.035, 0.045)),), 0.2, STOOD),
    "long spoon": Thing("long spoon", SPOON, 0.06, STOOD),
}
REACHES_OUT_M: Final = 0.018  # the box of such a cup out of the capsules that stand for it, see `holding`
ZONE_M_S: Final = 0.05
ZONE_RADIUS_M: Final = 0.06
ROUNDING_M: Final = 1e-5  # as in `clearance`
PUSH_TICKS: Final = 200
STOPPED_TICKS: Final = 15  # in which an arm at full speed has come to rest
FIGURES: Final[dict[str, Callable[[FloatArray], float]]] = {
    "ticks": np.sum,  # with the thing in the hand
    "taken_near_drives": np.sum,  # it was in something or near it when it was taken
    "least_above_level_mm": np.min,  # of the thing above what is level, where it was not near when taken
    "least_elsewhere_mm": np.min,  # the same, from other obstacles and the arm
    "sank_mm": np.max,  # of its box, into planes that it was taken inside of
    "zone_ticks": np.sum,
    "zone_fastest_m_s": np.max,  # corner of its box in the zone
    "broken_ticks": np.sum,  # something was not kept
}
SIGNS: Final = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)])


def in_hand(name: str) -> tuple[Robot, Box]:
    """A Panda with a thing as its model has it, and what the filters are told of it."""
    thing, robot, held = THINGS[name], panda(), HeldThings([THINGS[name]], ())
    held.update({name: STOOD}, None)
    spec = mujoco.MjSpec.from_string(robot.mjcf)
    site = spec.site(robot.chain.tools[0].name)
    add_parts(site.parent.add_body(name=name, pos=site.pos, quat=site.quat), thing.parts, thing.mass_kg)
    return replace(holding(robot, held.now), mjcf=spec.to_xml()), held.now[0]


def corners(robot: Robot, held: Box, q: FloatArray) -> FloatArray:
    """(8, 3), of the thing's box, m."""
    tool = robot.chain.forward(q)
    return tool.position + (held.centre + SIGNS * held.half_extents) @ tool.rotation.T


def drive(cell: tuple[int, int]) -> tuple[float, ...]:
    """Push, take the thing, and push on; `FIGURES` of the drive."""
    rng, number = np.random.default_rng(cell), cell[1]
    robot, held = in_hand(tuple(THINGS)[number % 2])
    obstacles, judge, q, push = scene(robot, (*HARMS, TRAY)[number // 2 % (len(HARMS) + 1)], rng)
    middle, out = corners(robot, held, q).mean(axis=0), 0.1 * rng.normal(size=3)
    out += 0.0 if push.target is None else push.target - middle
    face = Sphere("face", middle + 0.1 * out / np.linalg.norm(out), ZONE_RADIUS_M)
    zones = (Zone(face, ZONE_M_S),) if number // 12 % 2 else ()
    config = SafetyConfig(obstacles=obstacles, zones=zones)
    controller = Pusher(robot.dof)
    step = Step(panda(), controller, config, dt_s=PERIOD_S)
    step.reset(q)
    rest, open_hand = np.zeros(robot.dof), GripperReading(0.08)
    step(Input(np.zeros(1)), 0.0, Reading(q, rest, 0.0, 0, open_hand), 0.0)
    if (refused := step.enable()) is not None:
        raise RuntimeError(f"the arm could not be enabled: {refused.reason}")
    taken = int(rng.integers(STOPPED_TICKS, PUSH_TICKS // 2)) if rng.uniform() < 0.5 else 0
    at, states = q, list[FloatArray]()
    for tick in range(PUSH_TICKS):
        if tick == taken:
            step.hold(held)
        if tick % 5 == 0:
            away = rng.uniform(-2.0, 2.0, robot.dof)
            controller.wanted = push.towards(at) if rng.uniform() < 0.8 else away
        now_s = (tick + 1) * PERIOD_S
        record = step(Input(np.ones(1)), 0.0, Reading(at, rest, now_s, tick + 1, open_hand), now_s)
        if record.command.stop is not None:
            raise RuntimeError(f"stopped: {record.command.stop.reason}")
        at = at + record.command.velocity * PERIOD_S
        states.append(at)
    # Once the stop that may have been under way is over.
    return judged(robot, held, config, judge, np.array(states[taken + STOPPED_TICKS :]))


def judged(
    robot: Robot, held: Box, config: SafetyConfig, judge: Judge, states: FloatArray
) -> tuple[float, ...]:
    """`FIGURES` of states (T, n), rad, with the thing in the hand."""
    distance = np.array([judge.distances(q) for q in states])
    mine, names = judge.pairs_of(held.name)
    other = np.array(names)
    level = [
        one.name
        for one in config.obstacles
        if isinstance(one, HalfSpace | Box) and level_face(one) is not None
    ]
    on_level = np.isin(other, level)
    for one in np.unique(other[mine]):
        # A thing is as far from another as the nearest of its parts.
        same = mine & (other == one)
        distance[:, same] = distance[:, same].min(axis=1, keepdims=True)
    bound = np.where(mine, np.where(on_level, 0.0, config.clearance - REACHES_OUT_M), config.clearance)
    free = ~mine | (distance[0] >= config.clearance + REACHES_OUT_M)
    placed = np.array([corners(robot, held, q) for q in states])  # (T, 8, 3)
    planes = [one for one in config.obstacles if isinstance(one, HalfSpace)]
    height = np.array([((placed - one.point) @ one.normal).min(axis=1) for one in planes])  # (planes, T)
    sank = np.minimum(height[:, :1], 0.0) - height
    moved = np.linalg.norm(np.diff(placed, axis=0), axis=2) / PERIOD_S
    within = np.zeros(moved.shape, dtype=np.bool_)
    for zone in config.zones:
        if isinstance(zone.shape, Sphere):
            within |= np.linalg.norm(placed[:-1] - zone.shape.centre, axis=2) <= ZONE_RADIUS_M
    fastest = (moved * within).max(axis=1)
    # Of planes that its box began in, `sank` says more.
    on_plane = np.isin(other, [one.name for one in planes])
    lower = np.where(on_plane, -np.inf, distance[0] - REACHES_OUT_M)
    bound = np.where(free, bound, np.minimum(bound, lower))
    near = distance < bound - ROUNDING_M
    broken = near[:-1].any(axis=1) | (sank[:, :-1] > ROUNDING_M).any(axis=0) | (fastest > ZONE_M_S + 1e-9)
    return (
        len(states),
        not free[mine].all(),
        1000 * distance[:, mine & on_level & free].min(initial=np.inf),
        1000 * distance[:, mine & ~on_level & free].min(initial=np.inf),
        1000 * sank.max(initial=0.0),
        within.any(axis=1).sum(),
        fastest.max(),
        broken.sum(),
    )


def measure_held(ticks: int, work: Work) -> Outcome:
    """`FIGURES` of a held cup and a long spoon in about so many ticks."""
    each = PUSH_TICKS - STOPPED_TICKS - PUSH_TICKS // 4  # with the thing, about
    found = np.array(work.each(drive, [(work.seed, number) for number in range(-(-ticks // each))]))
    rows, broken = [], list[str]()
    for index, name in enumerate(THINGS):
        mine = found[index :: len(THINGS)]
        figures = {one: of(mine[:, k]) for k, (one, of) in enumerate(FIGURES.items())}
        rows += line("clearance", f"Panda with a {name}", len(mine), figures, task="held")
        broken += [f"a held {name} was not kept clear or slow"] * bool(figures["broken_ticks"])
    return Outcome(rows, broken)
