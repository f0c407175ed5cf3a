"""Many drives at once: simulated people, latent actions, belief and help (equations 2, 3, 9, 10, 24).

What the paper leaves open is chosen here once, the same for every model and every condition:

- A step of ``s' = s + a dt`` is 0.1 s. People decide anew at every step, but look 0.5 s ahead: over 0.1 s
  an input moves the tool a few millimetres, and even beta = 1000 could not tell good inputs from bad ones.
- The input is continuous in [-1, 1] (see `choice`). A person who lets go stops the arm, whatever the decoder
  makes of z = 0, and the robot does not help.
- alpha grows with the robot's confidence up to 0.8 and fades out below |u| = 0.3 (`ConfidenceAlpha`). Help is
  ``k Σ b(g) (g - s)``, k = 1/s.
- The robot takes people to be Boltzmann-rational with 5/rad². Along a demonstration its belief is then above
  0.9 after one second and 0.99 from two seconds on: open while the arm turns to a cup, certain when it
  grasps. No goal falls below 1 %.
"""

from collections.abc import Sequence
from dataclasses import dataclass, fields
from functools import partial
from typing import Final

import numpy as np

from latentarm.assistance.belief import Belief
from latentarm.assistance.blending import Arbitration, ConfidenceAlpha, FixedAlpha, assistive_action, blend
from latentarm.assistance.boltzmann import BoltzmannBelief
from latentarm.core.types import FloatArray, IntArray
from latentarm.evaluation.contract import DecodesActions
from latentarm.robots.kinematics.chain import Chain
from latentarm_research.studies.shared_autonomy.choice import KNOWN, choose
from latentarm_research.studies.shared_autonomy.preset import Person

STEP_S: Final = 0.1
LOOK_AHEAD_S: Final = 0.5
GAIN_PER_S: Final = 1.0
HELP: Final = ConfidenceAlpha(0.8)
NO_HELP: Final = FixedAlpha(0.0)

RULE: Final = partial(BoltzmannBelief, beta=5.0, horizon_s=0.5, floor=0.01)
"""The belief, online as along demonstrations; it lacks goals and period."""


@dataclass(frozen=True, eq=False)
class Scene:
    """The arm, and the goals it is driven to."""

    chain: Chain  # the arm's kinematics
    belief: Belief  # over the G goals, updated every `STEP_S`

    @property
    def goals(self) -> FloatArray:
        """(G, n), rad."""
        return self.belief.goals


@dataclass(frozen=True, eq=False)
class Moment:
    """One step of P drives."""

    state: FloatArray  # (P, n), before the step, rad
    belief: FloatArray  # (P, G), that the step used
    wanted: IntArray  # (P,), index of the goal that each person has just now
    alpha: FloatArray  # (P,), arbitration
    u: FloatArray  # (P,), what each person presses
    action: FloatArray  # (P, n), what the arm does, rad/s


@dataclass(frozen=True, eq=False)
class Drives:
    """The results of P drives over T steps."""

    moments: Moment  # with a further axis after the drives, (P, T, ...)
    state: FloatArray  # (P, n), at the end, rad
    belief: FloatArray  # (P, G), at the end
    target: IntArray  # (P,), index of the goal that each person has in the end


def drive(
    decoder: DecodesActions,  # sees the context ``c = (s, b)``
    scene: Scene,  # the arm and the goals
    people: Sequence[Person],  # P, how they decide and when they change their mind
    help_by: Arbitration,  # how much the robot helps
    start: FloatArray,  # (P, n), rad
    target: IntArray,  # (P,), index of the goal that each of them has in the end
    # (P, T'), uniform in [0, 1), for at least as many steps as there are: what they choose
    chances: FloatArray,
) -> Drives:
    """Let P simulated people drive, all for the same time."""
    state, belief = start, np.broadcast_to(scene.belief.initial(), (len(start), len(scene.goals)))
    places = scene.chain.forward(scene.goals).position
    changes_at_s = np.array([person.changes_at_s for person in people])
    moments: list[Moment] = []
    for step in range(steps_of(people[0])):
        time_s = step * STEP_S
        beta = np.array([person.rationality(time_s) for person in people])
        wanted = np.where(time_s >= changes_at_s, target, (target + 1) % len(scene.goals))
        context = np.concatenate([state, belief], axis=-1)
        u = _pressed(decoder, scene, context, places[wanted], beta, chances[:, step])
        action_human = np.where(u == 0.0, 0.0, decoder.decode(u, context))
        alpha = help_by.alpha(u, belief)
        action = blend(action_human, assistive_action(state, belief, scene.goals, GAIN_PER_S), alpha)
        moments.append(Moment(state, belief, wanted, alpha, u[:, 0], action))
        belief = scene.belief.update(belief, u, state, lambda v, c=context: decoder.decode(v, c[:, None]))
        state = state + STEP_S * action
    return Drives(_stacked(moments), state, belief, target)


def steps_of(person: Person) -> int:
    """How many steps someone drives."""
    return round(person.drive_s / STEP_S)


def _pressed(
    decoder: DecodesActions,
    scene: Scene,
    context: FloatArray,  # (P, c)
    place: FloatArray,  # (P, 3), where each person wants the tool, m
    beta: FloatArray,  # (P,), rationality, 1/m²
    chance: FloatArray,  # (P,), uniform in [0, 1)
) -> FloatArray:
    """What each of P people presses (equation 24), (P, 1)."""
    state = context[:, None, : scene.goals.shape[-1]]
    known = np.broadcast_to(KNOWN[:, None], (len(context), len(KNOWN), 1))
    reached = state + LOOK_AHEAD_S * decoder.decode(known, context[:, None])
    # The last of them stays where it is: the person lets go.
    tools = scene.chain.forward(np.concatenate([reached, state], axis=1)).position
    cost = np.square(place[:, None] - tools).sum(axis=-1)
    return choose(cost[:, :-1], cost[:, -1], beta, chance)[:, None]


def _stacked(moments: list[Moment]) -> Moment:
    """T moments of (P, ...) as one of (P, T, ...)."""
    names = [field.name for field in fields(Moment)]
    return Moment(**{name: np.stack([getattr(one, name) for one in moments], axis=1) for name in names})
