"""What a simulated person is like, and who that makes at the stick."""

from collections.abc import Mapping
from dataclasses import asdict, dataclass
from typing import Final, final

from latentarm.core.types import FloatArray
from latentarm_research.people.boltzmann import BoltzmannConfig
from latentarm_research.people.lapses import LapseConfig
from latentarm_research.people.linear_guess import LinearGuessConfig
from latentarm_research.people.motor_noise import HandConfig
from latentarm_research.people.own_directions import OwnDirections, OwnSpeed
from latentarm_research.people.page_rates import PAGE
from latentarm_research.people.person import Person
from latentarm_research.people.planning import PlanningConfig

UNSURE_M_S: Final = 0.05
UNSURE_RAD_S: Final = 0.25
"""How unsure people are of what they expect of the stick: half of `LinearGuessConfig`'s, which expects
nothing in particular. Chosen."""

TREMOR_HZ: Final = (8.0, 12.0)
"""Band of physiological tremor (Elble and Randall, J. Neurophysiol. 39:370, 1976), Hz."""

TRIAL_S: Final = 60.0
"""Practice of so long teaches as much as a trial, s. Chosen: about as long as the studies' trials last."""


def time_share(
    exponent: float,  # how fast they learn, 0 or more; at 0 they never do
    trial: int,  # number of trials before this one
    practice_s: float = 0.0,  # practised before the first trial, s
) -> float:
    """Effort in a trial, as a share of that in the first trial without practice.

    The power law of practice: times shrink as ``N^-exponent`` (Newell and Rosenbloom 1981). N counts this
    trial, those before it and what was practised before all of them. Practice of several minutes thus leaves
    little to learn in the trials. Averages over people follow this law; single people rather follow an
    exponential (Heathcote, Brown and Mewhort 2000), which is not modelled.
    """
    return (1.0 + trial + practice_s / TRIAL_S) ** -exponent


@final
@dataclass(frozen=True)
class Traits:
    """What one simulated person is like. Nothing here depends on a study or its conditions.

    `latentarm_research.people.population.TRAITS` says where each figure comes from. Times and
    rationality are those of the first trial without practice.
    """

    number: int  # of the person among those drawn from the same seed, from 0
    reaction_s: float  # time from what can be seen to the input that answers it, s
    tremor: float  # RMS of each axis's tremor as a share of full deflection
    push_variation: float  # SD of each axis of a push about what was meant, as a share of its length
    rationality: float  # beta of equation 24, 1/m²
    look_ahead_s: float  # how far ahead they imagine an input, the dt of equation 24, s
    plan_s: float  # how far ahead they plan where one input leads no nearer, s
    decision_s: float  # time from decision to decision, s
    switch_s: float  # time that a mode switch takes, s
    switch_cost_m: float  # how much nearer a mode switch must bring the tool to be worth it, m
    lapses_per_min: float  # how often attention lapses
    lapse_s: float  # mean duration of a lapse, s
    learning: float  # exponent of the power law of practice
    own_speed: float  # share of the speed of somebody who pushes as far as it takes
    turn_rad: float  # how far their own directions of the stick are turned, rad
    mirrored: bool  # whether the second axis is upside down for them
    answer_variation: float  # coefficient of variation of their answers to alignment queries

    @property
    def directions(self) -> OwnDirections:
        """Where they push the stick, before anything is aligned to them."""
        return OwnDirections(self.turn_rad, self.mirrored)

    def person(self, trial: int, practice_s: float = 0.0) -> Person:
        """Who they are in a trial on the page, with a stick whose effect they have been shown.

        They know what each input does, plan, and make up for their reaction time. ``trial`` counts those
        before this one, ``practice_s`` the practice before the first, s.
        """
        plans = PlanningConfig()
        pieces = max(round(self.plan_s / plans.piece_s), 1)
        return Person(
            decides=self._decides(trial, practice_s),
            plans=PlanningConfig(pieces=pieces),
            hand=self._hand,
            speed=OwnSpeed(self.own_speed),
            lapses=self._lapses,
            anticipates=True,
            page=PAGE,
        )

    def newcomer(self, usual: FloatArray, trial: int, practice_s: float = 0.0) -> Person:
        """Who they are in a trial, with a stick whose effect nobody has shown to them; see `person`.

        They push by what the directions of the stick mean to themselves, where ``usual`` (6, 2) is the twist
        that people expect of a full push of each axis, m/s and rad/s. They learn from what they see; from
        one drive to the next they keep nothing of that.
        """
        expected = tuple(tuple(twist) for twist in self.directions.expected(usual).T.tolist())
        return Person(
            decides=self._decides(trial, practice_s),
            imagines=LinearGuessConfig(speed_m_s=UNSURE_M_S, turn_rad_s=UNSURE_RAD_S, expected=expected),
            hand=self._hand,
            speed=OwnSpeed(self.own_speed),
            lapses=self._lapses,
            page=PAGE,
        )

    def as_json(self) -> Mapping[str, object]:
        """Every figure by its name, ready for ``json.dumps``."""
        return asdict(self)

    @property
    def _hand(self) -> HandConfig:
        return HandConfig(self.reaction_s, self.tremor, *TREMOR_HZ, self.push_variation)

    @property
    def _lapses(self) -> LapseConfig:
        return LapseConfig(self.lapses_per_min, self.lapse_s)

    def _decides(self, trial: int, practice_s: float) -> BoltzmannConfig:
        """How they decide: faster and surer with practice.

        The spread of their pushes shrinks as times do: beta is one over its square.
        """
        share = time_share(self.learning, trial, practice_s)
        return BoltzmannConfig(
            beta=self.rationality / share**2,
            horizon_s=self.look_ahead_s,
            decision_s=self.decision_s * share,
            switch_s=self.switch_s * share,
            switch_cost=self.switch_cost_m,
        )
