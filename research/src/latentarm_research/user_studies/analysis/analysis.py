"""The whole analysis of a study: exclusions, claims, models of all trials, and as the paper printed it."""

from collections.abc import Sequence
from dataclasses import asdict, dataclass, replace
from typing import final

from latentarm_research.user_studies.analysis.anova import Effect
from latentarm_research.user_studies.analysis.as_printed import AsPrinted, as_printed
from latentarm_research.user_studies.analysis.claims import Tested, Verdict, claims_tested, sides_of, verdicts
from latentarm_research.user_studies.analysis.means import Sides, tasks_of
from latentarm_research.user_studies.analysis.mixed import Mixed, mixed_model
from latentarm_research.user_studies.definition import Definition
from latentarm_research.user_studies.designs import StudyDesign, design_of
from latentarm_research.user_studies.exclusion import Excluded, counted
from latentarm_research.user_studies.record import Trial


@final
@dataclass(frozen=True)
class Modelled:
    """A claim in a model of all trials."""

    mixed: Mixed | None  # the linear mixed model; None where it could not be fitted
    p: float | None  # of the randomisation test; None where it could not be made


@final
@dataclass(frozen=True)
class TestedClaim:
    """A claim, tested on people's means and in a model of all trials."""

    tested: Tested  # on people's means
    modelled: Modelled  # in a model of all trials

    def as_json(self) -> dict[str, object]:
        """Plain mapping."""
        test = self.tested.test
        low, high = (None, None) if test is None else test.effect_interval
        model = {**asdict(self.modelled), "d_low": low, "d_high": high}
        return {**self.tested.as_json(), "model": model}


@final
@dataclass(frozen=True)
class Analysis:
    """What a study says."""

    trials: tuple[Trial, ...]  # that count
    excluded: Excluded  # what does not
    claims: tuple[TestedClaim, ...]  # every claim, tested
    verdicts: tuple[Verdict, ...]  # on every hypothesis
    effects: dict[str, list[Effect]]  # of a factorial design, by measure; empty without factors
    as_printed: tuple[AsPrinted, ...]  # the paper's statistics with ours

    def as_json(self) -> dict[str, object]:
        """Plain mapping of everything but the claims."""
        return {
            "excluded_trials": [{"trial": index, "why": why} for index, why in self.excluded.trials],
            "excluded_people": list(self.excluded.people),
            "hypotheses": [
                {"name": one.hypothesis.name, "text": one.hypothesis.text, "says": one.says, "why": one.why}
                for one in self.verdicts
            ],
            "anova": {
                measure: [asdict(effect) for effect in found] for measure, found in self.effects.items()
            },
            "as_printed": [one.as_json() for one in self.as_printed],
        }


def analyse(
    definition: Definition, trials: Sequence[Trial], ratings: Sequence[Trial] = (), not_judged: str = ""
) -> Analysis:
    """Analyse a study's trials; who gave them, simulated or real people, changes nothing.

    Args:
        definition: of the study.
        trials: of all people.
        ratings: their scores on the questionnaire's scales; rules of exclusion do not see these, but who is
            excluded is excluded here too.
        not_judged: why no claim is tested; empty where claims are.
    """
    design = design_of(definition)
    kept, out = counted(definition.exclusions, trials)
    every = [*kept, *(one for one in ratings if one.person not in out.people)]
    both = sides_of(definition, every)
    tested = claims_tested(definition, both)
    if not_judged:
        tested = [replace(one, test=None, p=None, p_holm=None, why_not=not_judged) for one in tested]
    return Analysis(
        trials=tuple(kept),
        excluded=out,
        claims=tuple(
            TestedClaim(one, _modelled(design, one, sides, every))
            for one, sides in zip(tested, both, strict=True)
        ),
        verdicts=tuple(verdicts(definition, tested)),
        effects={} if not_judged else _effects(definition, every),
        as_printed=() if not_judged else tuple(as_printed(one, every) for one in definition.printed),
    )


def _modelled(design: StudyDesign, tested: Tested, both: Sides, trials: Sequence[Trial]) -> Modelled:
    table = design.table(trials, tested.claim)
    return Modelled(mixed_model(table), design.randomisation_p(both, table))


def _effects(definition: Definition, trials: Sequence[Trial]) -> dict[str, list[Effect]]:
    if len(definition.factors) != 2:
        return {}
    design, (first, second) = design_of(definition), definition.factors
    claims = {claim.measure: claim for claim in definition.claims}
    found = {
        measure: design.effects(trials, (first, second), measure, tasks_of(trials, claim))
        for measure, claim in claims.items()
    }
    return {measure: effects for measure, effects in found.items() if effects}
