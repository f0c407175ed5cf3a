"""What the report says in words: the methods, from the definition, and figures as people read them."""

from typing import Final

from latentarm.evaluation.table import ABSENT, format_figure
from latentarm_research.studies.means_test import MeansTest
from latentarm_research.studies.statistics import format_p
from latentarm_research.studies.tables import listed
from latentarm_research.user_studies.analysis.analysis import Modelled
from latentarm_research.user_studies.analysis.claims import Tested, worded
from latentarm_research.user_studies.definition import Condition, Definition, StudyTask

CONTROLS: Final = {
    "modes": "two axes of the end-effector at a time; a button switches which",
    "two_sticks": "two sticks for the end-effector; a button toggles linear and angular motion",
    "retargeting": "the stick retargeted to the twist of the end-effector; a button switches which two axes",
    "latent": "latent actions",
}
ASSISTS: Final = {
    "none": "no assistance",
    "interpolation": "assistance by interpolation",
    "blending": "shared autonomy of Algorithm 1",
}
ALIGNS: Final = {
    "none": "z = u",
    "no_priors": "alignment learned from answers alone",
    "all_priors": "alignment learned from answers and priors",
}


def condition_parts(condition: Condition) -> tuple[str, str, str, str]:
    """Controls, model, assistance and alignment of a condition, in words."""
    model = f"{condition.model}, sees {listed(condition.context)}" if condition.model else ABSENT
    helps = ASSISTS[condition.assists]
    if condition.assists == "interpolation":
        helps = f"{helps}, weight {condition.weight:.2g}"
    return CONTROLS[condition.controls], model, helps, ALIGNS[condition.aligns] if condition.model else ABSENT


def task_words(task: StudyTask) -> str:
    """How a task goes, in a sentence or two."""
    trials = f"{task.trials} trial{'s' if task.trials > 1 else ''} in each condition"
    parts = [f"{task.label}: {trials}"]
    if task.all_choices:
        parts.append("each of all parts one after the other, their figures summed")
    if task.trial_s:
        parts.append(
            f"after a failure everything is set up anew and people begin again, for {task.trial_s:g} s"
            f" {'per part' if task.all_choices else 'in all'}"
        )
    if task.queries:
        parts.append(f"{task.queries} alignment queries before it")
    if task.demonstrations_min:
        parts.append(f"a model from at most {task.demonstrations_min:g} minutes of demonstrations")
    if task.trained_with:
        parts.append("with the model of the other task")
    return "; ".join(parts) + "."


def exclusion_words(definition: Definition) -> list[str]:
    """Each rule in a sentence."""
    side = {"less": "below", "more": "above"}
    return [
        f"A trial with {definition.label(rule.measure)} {side[rule.side]} {rule.limit:g} does not count:"
        f" {rule.why}."
        for rule in definition.exclusions
    ]


def claim_line(definition: Definition, tested: Tested, modelled: Modelled) -> list[str]:
    """One claim as a line of a table."""
    test, mixed = tested.test, modelled.mixed
    people = f"{test.n} + {test.n_against}" if test is not None and test.n_against else str(tested.n)
    head = [tested.hypothesis, worded(definition, tested.claim), people]
    means = [format_figure(tested.mean, tested.sd), format_figure(tested.mean_against, tested.sd_against)]
    if test is None:
        return [*head, *means, *[ABSENT] * 6, f"{tested.says} ({tested.why_not})"]
    low, high = test.interval
    p = f"{format_p(tested.p)} / {format_p(tested.p_holm)}"
    return [
        *head,
        *means,
        f"{test.difference:.3g} [{low:.3g}, {high:.3g}]",
        f"{'TOST' if tested.claim.margin else f't({test.dof:.3g}) = {test.t:.2f}'}",
        p,
        _effect_words(test),
        ABSENT if mixed is None else f"{mixed.estimate:.3g} ± {mixed.se:.2g}",
        format_p(modelled.p),
        tested.says,
    ]


def _effect_words(test: MeansTest) -> str:
    low, high = test.effect_interval
    g, interval = _two(test.g), f"[{low:.2f}, {high:.2f}]"
    return f"{g} {interval}" if test.n_against else f"{test.d:.2f} {interval}; g {g}"


def yes_no(value: bool | None) -> str:
    """Yes, no, or a dash."""
    return ABSENT if value is None else "yes" if value else "no"


def _two(value: float | None) -> str:
    return ABSENT if value is None else f"{value:.2f}"
