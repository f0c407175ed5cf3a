"""How many people a study needs: studies drawn from people who were sent through it, by its own analysis."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Final, final

import numpy as np

from latentarm.core.errors import UserError
from latentarm_research.user_studies.analysis.analysis import claims_tested, sides_of, verdicts, worded
from latentarm_research.user_studies.analysis.means import Sides
from latentarm_research.user_studies.definition import Definition
from latentarm_research.user_studies.designs import design_of
from latentarm_research.user_studies.exclusion import counted
from latentarm_research.user_studies.record import Trial

NUMBERS: Final = (4, 6, 8, 10, 12, 16, 20, 24, 32, 40)  # of people who meet a condition, that are tried
TARGETS: Final = (0.8, 0.9)  # shares of the studies in which a claim should be found
FEWEST: Final = 3  # people to draw from, at least


@final
@dataclass(frozen=True)
class Power:
    """How often claims and hypotheses hold in studies of so many people."""

    people: int  # whom studies were drawn from
    draws: int  # studies for each number of people
    numbers: tuple[int, ...]  # of people in all
    # share of the studies in which each claim holds, by the claim in words
    claims: Mapping[str, tuple[float, ...]]
    # the same of each hypothesis, by its name; none of those that could not be tested
    hypotheses: Mapping[str, tuple[float, ...]]

    def needed(self, shares: Sequence[float], target: float) -> int | None:
        """The first number of people from which on a share is at least a target; None for none of them."""
        enough = [share >= target for share in shares]
        return next((number for index, number in enumerate(self.numbers) if all(enough[index:])), None)

    def as_json(self) -> dict[str, object]:
        """Plain mapping."""
        return {
            "drawn_from_people": self.people,
            "draws": self.draws,
            "numbers": list(self.numbers),
            "claims": {name: list(shares) for name, shares in self.claims.items()},
            "hypotheses": {name: list(shares) for name, shares in self.hypotheses.items()},
            "needed": {
                name: {f"{target:g}": self.needed(shares, target) for target in TARGETS}
                for name, shares in {**self.hypotheses, **self.claims}.items()
            },
        }


def power_of(definition: Definition, trials: Sequence[Trial], draws: int, seed: int) -> Power:
    """Draw studies of people with replacement, and analyse each as the study itself is analysed.

    In a study between people they are drawn condition by condition, as many of each.

    What it finds is true as far as these people stand for others: simulated ones for simulated people.
    """
    if draws < 1:
        raise UserError(f"The number of draws is {draws}: it must be at least 1.")
    kept, _ = counted(definition.exclusions, trials)
    people: dict[int, set[str]] = {}
    for trial in kept:
        people.setdefault(trial.person, set()).add(trial.condition)
    design, conditions = design_of(definition), len(definition.conditions)
    if design.few_to_draw_from(people, conditions, FEWEST):
        raise UserError(
            f"Power needs {FEWEST} people or more in each condition to draw from: there are {len(people)}"
            f" people for {conditions} conditions."
        )
    both = sides_of(definition, kept)
    rng = np.random.default_rng(seed)
    numbers = tuple(design.number(conditions, each) for each in NUMBERS)
    shares = [_shares(definition, both, people, number, draws, rng) for number in numbers]
    claims = {worded(definition, claim): index for index, claim in enumerate(definition.claims)}
    measured = {name: index for name, index in claims.items() if len(both[index].subject)}
    tested = {
        one.name: index
        for index, one in enumerate(definition.hypotheses)
        if one.claims and all(worded(definition, claim) in measured for claim in one.claims)
    }
    return Power(
        people=len(people),
        draws=draws,
        numbers=numbers,
        claims={name: tuple(one[0][index] for one in shares) for name, index in measured.items()},
        hypotheses={name: tuple(one[1][index] for one in shares) for name, index in tested.items()},
    )


def _shares(
    definition: Definition,
    both: Sequence[Sides],
    people: Mapping[int, set[str]],
    number: int,
    draws: int,
    rng: np.random.Generator,
) -> tuple[list[float], list[float]]:
    """Shares of the drawn studies in which each claim, and each hypothesis, holds."""
    design = design_of(definition)
    claims = np.zeros(len(definition.claims))
    hypotheses = np.zeros(len(definition.hypotheses))
    for _ in range(draws):
        drawn = design.drawn(people, number, rng)
        tested = claims_tested(definition, [design.of_people(one, drawn) for one in both])
        claims += [one.says == "held" for one in tested]
        hypotheses += [one.says == "held" for one in verdicts(definition, tested)]
    return (claims / draws).tolist(), (hypotheses / draws).tolist()
