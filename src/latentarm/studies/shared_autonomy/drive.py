"""Many drives at once: simulated people, latent actions, belief and help (equations 2, 3, 9, 10, 24).

What the paper leaves open is chosen here once, the same for every model and every condition:

- A step of ``s' = s + a dt`` is 0.1 s. People decide anew at every step, but look 0.5 s ahead: over 0.1 s
  an input moves the tool a few millimetres, and even beta = 1000 could not tell good inputs from bad ones.
- People choose among 21 inputs, evenly spaced in [-1, 1]. One of them is 0: a person who lets go stops the
  arm, and the robot does not help (`FixedAlpha` fades out below ‖u‖ = 0.3).
- alpha = 0.5, the paper's own example: person and robot count alike. Help is ``k Σ b(g) (g - s)``, k = 1/s.
- The robot takes people to be Boltzmann-rational with 5/rad². Along a demonstration its belief is then 0.8
  after one second, 0.97 after two and 0.99 at the goal: open while the arm reaches, certain when it begins to
  grasp. No goal falls below 1 %.
"""

from collections.abc import Sequence
from dataclasses import dataclass, fields
from functools import partial
from typing import Final

import numpy as np
import torch

from latentarm.assistance.belief import Belief
from latentarm.assistance.blending import Arbitration, FixedAlpha, assistive_action, blend
from latentarm.assistance.boltzmann import BoltzmannBelief
from latentarm.assistance.entropy import entropy_over_goals, goal_probabilities, goal_progress
from latentarm.kinematics.chain import Chain
from latentarm.kinematics.torch_chain import TorchChain
from latentarm.metrics.contract import DecodesActions
from latentarm.operators.rationality import boltzmann
from latentarm.studies.shared_autonomy.preset import Person
from latentarm.types import FloatArray, IntArray

STEP_S: Final = 0.1
LOOK_AHEAD_S: Final = 0.5
INPUTS: Final = np.linspace(-1.0, 1.0, 21)[:, None]
"""(K, 1), what a person may press."""

REST: Final = len(INPUTS) // 2
"""Index of the input that lets go."""

GAIN_PER_S: Final = 1.0
HELP: Final = FixedAlpha(0.5)
NO_HELP: Final = FixedAlpha(0.0)

RULE: Final = partial(BoltzmannBelief, beta=5.0, horizon_s=0.5, floor=0.01)
"""The belief, online as along demonstrations; it lacks goals and period."""


@dataclass(frozen=True, eq=False)
class Scene:
    """The arm, and the goals it is driven to.

    Attributes:
        chain: the arm's kinematics.
        belief: over the G goals, updated every `STEP_S`.
        speed: root mean square of the demonstrated ‖a‖, rad/s.
    """

    chain: Chain
    belief: Belief
    speed: float

    @property
    def goals(self) -> FloatArray:
        """(G, n), rad."""
        return self.belief.goals


@dataclass(frozen=True, eq=False)
class Moment:
    """One step of P drives.

    Attributes:
        state: (P, n), before the step, rad.
        belief: (P, G), that the step used.
        wanted: (P,), index of the goal that each person has just now.
        alpha: (P,), arbitration.
        action: (P, n), what the arm does, rad/s.
        sigma_h: (P,), largest ‖a_h‖ that any input would have decoded to, rad/s.
        goal_entropy: (P,), entropy of ``p_c(g)`` (equation 15) over the inputs, nats.
        progress: (P, G), of the input that leads fastest to each goal, of the demonstrated speed.
    """

    state: FloatArray
    belief: FloatArray
    wanted: IntArray
    alpha: FloatArray
    action: FloatArray
    sigma_h: FloatArray
    goal_entropy: FloatArray
    progress: FloatArray


@dataclass(frozen=True, eq=False)
class Drives:
    """What became of P drives over T steps.

    Attributes:
        moments: with a further axis after the drives, (P, T, ...).
        state: (P, n), at the end, rad.
        belief: (P, G), at the end.
        target: (P,), index of the goal that each person has in the end.
    """

    moments: Moment
    state: FloatArray
    belief: FloatArray
    target: IntArray


def drive(
    decoder: DecodesActions,
    scene: Scene,
    people: Sequence[Person],
    help_by: Arbitration,
    start: FloatArray,
    target: IntArray,
    chances: FloatArray,
) -> Drives:
    """Let P simulated people drive, all for the same time.

    Args:
        decoder: sees the context ``c = (s, b)``.
        scene: the arm and the goals.
        people: P, how they decide and when they change their mind.
        help_by: how much the robot helps.
        start: (P, n), rad.
        target: (P,), index of the goal that each of them has in the end.
        chances: (P, T'), uniform in [0, 1), for at least as many steps as there are: what they choose.
    """
    state, belief = start, np.broadcast_to(scene.belief.initial(), (len(start), len(scene.goals)))
    places = scene.chain.forward(scene.goals).position
    changes_at_s = np.array([person.changes_at_s for person in people])
    moments: list[Moment] = []
    for step in range(steps_of(people[0])):
        time_s = step * STEP_S
        beta = np.array([person.rationality(time_s) for person in people])
        wanted = np.where(time_s >= changes_at_s, target, (target + 1) % len(scene.goals))
        context = np.concatenate([state, belief], axis=-1)
        decoded = decoder.decode(np.broadcast_to(INPUTS, (len(state), *INPUTS.shape)), context[:, None])
        commanded = np.where(np.arange(len(INPUTS))[:, None] == REST, 0.0, decoded)
        likely = _likely(scene, state, commanded, places[wanted], beta)
        chosen = _drawn(likely, chances[:, step])
        u, action_human = INPUTS[chosen], commanded[np.arange(len(state)), chosen]
        alpha = help_by.alpha(u, belief)
        action_assist = assistive_action(state, belief, scene.goals, GAIN_PER_S)
        action = blend(action_human, action_assist, alpha)
        entropy, progress = _openness(scene, state, decoded)
        sigma_h = np.sqrt(np.vecdot(decoded, decoded)).max(axis=-1)
        moments.append(Moment(state, belief, wanted, alpha, action, sigma_h, entropy, progress))
        belief = scene.belief.update(belief, u, state, lambda v, c=context: decoder.decode(v, c[:, None]))
        state = state + STEP_S * action
    return Drives(_stacked(moments), state, belief, target)


def steps_of(person: Person) -> int:
    """How many steps someone drives."""
    return round(person.drive_s / STEP_S)


def _likely(
    scene: Scene, state: FloatArray, commanded: FloatArray, place: FloatArray, beta: FloatArray
) -> FloatArray:
    """How likely each input is (equation 24), (P, K).

    Args:
        scene: the arm.
        state: (P, n), rad.
        commanded: (P, K, n), what each input commands, rad/s.
        place: (P, 3), where each person wants the tool, m.
        beta: (P,), rationality, 1/m².
    """
    reached = scene.chain.forward(state[:, None] + LOOK_AHEAD_S * commanded).position
    return boltzmann(np.square(place[:, None] - reached).sum(axis=-1), beta)


def _drawn(probability: FloatArray, chance: FloatArray) -> IntArray:
    """Options drawn with probabilities (P, K) by chances (P,) in [0, 1): (P,)."""
    below = np.cumsum(probability, axis=-1) <= chance[:, None]
    return np.minimum(below.sum(axis=-1), probability.shape[-1] - 1)


def _openness(scene: Scene, state: FloatArray, decoded: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Entropy of ``p_c(g)`` (P,), nats, and the fastest progress to each goal (P, G)."""
    states, actions, goals = (torch.tensor(values) for values in (state, decoded, scene.goals))
    progress = goal_progress(states, actions, goals, scene.speed, TorchChain(scene.chain))
    entropy = entropy_over_goals(goal_probabilities(progress))
    return entropy.numpy(), progress.amax(dim=-2).numpy()


def _stacked(moments: list[Moment]) -> Moment:
    """T moments of (P, ...) as one of (P, T, ...)."""
    names = [field.name for field in fields(Moment)]
    return Moment(**{name: np.stack([getattr(one, name) for one in moments], axis=1) for name in names})
