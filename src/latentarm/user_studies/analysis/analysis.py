"""The whole analysis of a study: exclusions, claims, models of all trials, and as the paper printed it."""

from collections.abc import Sequence
from dataclasses import asdict, dataclass
from typing import final

from latentarm.user_studies.analysis.anova import Effect, repeated_measures
from latentarm.user_studies.analysis.as_printed import AsPrinted, as_printed
from latentarm.user_studies.analysis.claims import Tested, Verdict, claims_tested, sides_of, verdicts
from latentarm.user_studies.analysis.long_table import long_table
from latentarm.user_studies.analysis.means import tasks_of
from latentarm.user_studies.analysis.mixed import Mixed, mixed_model
from latentarm.user_studies.analysis.paired import effect_interval
from latentarm.user_studies.analysis.randomisation import randomisation_p
from latentarm.user_studies.definition import Definition
from latentarm.user_studies.exclusion import Excluded, counted
from latentarm.user_studies.record import Trial


@final
@dataclass(frozen=True)
class Modelled:
    """A claim in a model of all trials.

    Attributes:
        mixed: the linear mixed model; None where it could not be fitted.
        p: of the randomisation test; None where it could not be made.
        dz_low: lower end of the 95 % interval of dz; None where there is no dz.
        dz_high: upper end.
    """

    mixed: Mixed | None
    p: float | None
    dz_low: float | None
    dz_high: float | None


@final
@dataclass(frozen=True)
class Analysis:
    """What a study says.

    Attributes:
        trials: that count.
        excluded: what does not.
        tested: every claim.
        modelled: every claim in a model of all trials, in the same order.
        verdicts: on every hypothesis.
        effects: of a factorial design, by measure; empty without factors.
        as_printed: the paper's statistics with ours.
    """

    trials: tuple[Trial, ...]
    excluded: Excluded
    tested: tuple[Tested, ...]
    modelled: tuple[Modelled, ...]
    verdicts: tuple[Verdict, ...]
    effects: dict[str, list[Effect]]
    as_printed: tuple[AsPrinted, ...]

    def as_json(self) -> dict[str, object]:
        """Plain mapping."""
        return {
            "excluded_trials": [{"trial": index, "why": why} for index, why in self.excluded.trials],
            "excluded_people": list(self.excluded.people),
            "claims": [
                {**tested.as_json(), "model": asdict(modelled)}
                for tested, modelled in zip(self.tested, self.modelled, strict=True)
            ],
            "hypotheses": [
                {"name": one.hypothesis.name, "text": one.hypothesis.text, "says": one.says, "why": one.why}
                for one in self.verdicts
            ],
            "anova": {
                measure: [asdict(effect) for effect in found] for measure, found in self.effects.items()
            },
            "as_printed": [one.as_json() for one in self.as_printed],
        }


def analyse(definition: Definition, trials: Sequence[Trial]) -> Analysis:
    """Analyse a study's trials; who gave them, simulated or real people, changes nothing.

    Args:
        definition: of the study.
        trials: of all people.
    """
    kept, out = counted(definition.exclusions, trials)
    tested = claims_tested(definition, sides_of(definition, kept))
    return Analysis(
        trials=tuple(kept),
        excluded=out,
        tested=tuple(tested),
        modelled=tuple(_modelled(one, kept) for one in tested),
        verdicts=tuple(verdicts(definition, tested)),
        effects=_effects(definition, kept),
        as_printed=tuple(as_printed(one, kept) for one in definition.printed),
    )


def _modelled(tested: Tested, trials: Sequence[Trial]) -> Modelled:
    table = long_table(trials, tested.claim)
    low, high = (None, None) if tested.paired is None else effect_interval(tested.paired.dz, tested.n)
    return Modelled(mixed_model(table), randomisation_p(table), low, high)


def _effects(definition: Definition, trials: Sequence[Trial]) -> dict[str, list[Effect]]:
    if len(definition.factors) != 2:
        return {}
    first, second = definition.factors
    claims = {claim.measure: claim for claim in definition.claims}
    found = {
        measure: repeated_measures(trials, (first, second), measure, tasks_of(trials, claim))
        for measure, claim in claims.items()
    }
    return {measure: effects for measure, effects in found.items() if effects}
