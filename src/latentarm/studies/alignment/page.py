"""``results.md``: the study as a page that reads by itself."""

from collections.abc import Sequence
from pathlib import Path
from typing import Final

from latentarm.alignment.demonstrated import DURATION_S
from latentarm.alignment.poses import ROTATION_WEIGHT_M
from latentarm.alignment.priors import Priors
from latentarm.files import write_text
from latentarm.metrics.looks import look_of
from latentarm.runs.questions import TOO_FEW
from latentarm.studies.alignment.cell import CellResult
from latentarm.studies.alignment.conditions import (
    ALL_PRIORS,
    FEW_ANSWERS,
    IDEAL,
    MANUAL,
    NO_ALIGN,
    WITHOUT_PRIORS,
)
from latentarm.studies.alignment.curves import AT_RANDOM, BY_DISAGREEMENT, BY_NOVELTY, CurveResult
from latentarm.studies.alignment.drives_comparison import DriveComparison
from latentarm.studies.alignment.drives_page import drives_section
from latentarm.studies.alignment.hypotheses import NEAR, Comparison
from latentarm.studies.alignment.measured import Measured
from latentarm.studies.alignment.preset import Preset
from latentarm.studies.alignment.tables import (
    comparison_table,
    condition_table,
    curve_table,
    stopping_table,
    target_table,
)
from latentarm.studies.alignment.targets import PAPER_MODEL, Target
from latentarm.studies.alignment.verdicts import verdicts
from latentarm.studies.page import listed
from latentarm.studies.pages import shown
from latentarm.studies.statistics import LEVEL
from latentarm.studies.verdicts import Verdict
from latentarm.tasks.pouring.tasks import AT_BOWL_M, BOWL_M
from latentarm.tasks.pouring.tool_path import RATE_HZ, SPEED_M_S, TURN_RAD_S

HYPOTHESES: Final = {
    "H1": "with abundant answers the alignment learns what is meant",
    "H2": "with priors, far fewer answers do",
    "H3": "all priors together are better than one of them",
}


def write_page(
    out: Path,
    measured: Measured,
    tests: Sequence[Comparison],
    drive_tests: Sequence[DriveComparison],
    reached: Sequence[Target],
    preset: Preset,
    command: str,
) -> None:
    """Write ``results.md`` beside the study's other files.

    Args:
        out: the study's folder; the PNGs that are in it are shown.
        measured: everything.
        tests: see `compare_conditions`.
        drive_tests: see `compare_drives`.
        reached: see `targets`.
        preset: sizes of the study.
        command: that does it again.

    Raises:
        UserError: the file cannot be written.
    """
    results, curves, drives = measured.results, measured.curves, measured.drives
    parts = ["# What people mean by their stick\n", _introduction(command)]
    if results:
        parts += [_setup(preset), *_in_short(tests, reached), *shown(_there(out, "conditions.png"))]
        parts += _tables(results)
        parts += shown(_there(out, "conditions_other_models.png"))
    if curves:
        parts += [
            "## How many answers\n",
            _choices(preset),
            *shown(_there(out, "curves.png")),
            *_curves(curves),
        ]
    if drives:
        parts += [drives_section(drives, drive_tests), *shown(_there(out, "drives.png"))]
    if results:
        parts += [_reading(preset), _hypotheses(tests)]
    write_text(out / "results.md", "\n".join(parts))


def _there(out: Path, name: str) -> list[str]:
    return [name] if (out / name).exists() else []


def _introduction(command: str) -> str:
    return f"""Section 8.3 of Losey et al., *Learning Latent Actions to Control Assistive Robots*, done again.
Everything is **simulated**: the arm, the people who demonstrate, those who answer and those who drive. No
person took part.

```sh
{command}
```
"""


def _setup(preset: Preset) -> str:
    """What was done, in numbers."""
    layers = " and ".join(map(str, preset.hidden))
    priors, noises = Priors(), listed(f"{noise:g}" for noise in preset.noises)
    decoder = look_of(PAPER_MODEL).label
    return f"""A Panda's hand is moved by a stick of two axes through a decoder of two latent dimensions. What
a person means by the stick is learned from few answers: for each motion that they are shown, the input by
which they would ask for it. In **Plane** they mean x and y; in **Pour** up and down, and a tilt about the
base's x axis; in **Reach & Pour** the former until the hand is at the bowl, and the latter there.

- {preset.episodes} demonstrations train each decoder, {preset.test_episodes} others judge it: hands that
  wander smoothly at up to {SPEED_M_S:g} m/s and {TURN_RAD_S:g} rad/s, at {RATE_HZ:g} Hz; the bowl is at
  ({BOWL_M[0]:g}, {BOWL_M[1]:g}) m, and *at* it is within {AT_BOWL_M:g} m. At most {preset.epochs} passes,
  hidden layers of {layers} units, noise of {preset.state_noise_rad:g} rad on states. The paper's decoder is
  the {decoder}.
- {preset.answers} answers about motions of {DURATION_S:g} s, drawn at random, a full push for the fastest
  motion; each number of an answer is wrong by a normal factor with a coefficient of variation of {noises}
  ("noise"). {preset.runs} runs with other answers each. {IDEAL} has {preset.ideal_answers} answers and
  {preset.ideal_steps} steps instead of {preset.steps}.
- Priors hold in {preset.unlabelled} contexts without an answer and weigh {priors.proportional:g}
  (proportional), {priors.reversible:g} (reversible) and {priors.consistent:g} (consistent, gamma
  {priors.gamma:g}/rad), here as in `latentarm align`; a single prior weighs what it weighs among all.
- The error is that of the paper, ‖x* - x(t+1)‖² / ‖x* - x(t)‖² over {preset.test_motions} held-out motions,
  each part summed before they are divided; a turn of 1 rad counts as {ROTATION_WEIGHT_M:g} m. 0 is a perfect
  alignment, 1 an arm that does not move.
"""


def _in_short(tests: Sequence[Comparison], reached: Sequence[Target]) -> list[str]:
    """The verdicts, model by model, and the targets."""
    return [
        "## In short\n",
        *(_verdict_lines(verdict) for verdict in verdicts(tests)),
        "Beside the paper's hypotheses, the study set out to reach:\n",
        target_table(reached),
    ]


def _verdict_lines(verdict: Verdict[str]) -> str:
    """A hypothesis with one model, and below it what each task says of it."""
    lines = [f"**{verdict.hypothesis}**, {HYPOTHESES[verdict.hypothesis]}; {look_of(verdict.about).label}:\n"]
    lines += [f"- {look_of(task).label}: {said}" for task, said in verdict.by_task.items()]
    return "\n".join(lines) + "\n"


def _tables(results: Sequence[CellResult]) -> list[str]:
    """A section per task, a table per model."""
    parts: list[str] = []
    for task in dict.fromkeys(result.cell.task for result in results):
        parts.append(f"## {look_of(task).label}\n")
        here = [result for result in results if result.cell.task == task]
        for model in dict.fromkeys(result.cell.model for result in here):
            of_model = [result for result in here if result.cell.model == model]
            beyond = "" if model == PAPER_MODEL else " (beyond the paper)"
            parts += [f"{look_of(model).label}{beyond}:\n", condition_table(of_model)]
    return parts


def _choices(preset: Preset) -> str:
    sizes = preset.curves
    return f"""With {ALL_PRIORS}, the error by the number of answers, and by how the next question is chosen
out of {sizes.candidates} motions:

- *{AT_RANDOM}*;
- *{BY_NOVELTY}*: the longest motion first, then always the one that begins or leads least like all before (a
  motion and its opposite are alike), as `latentarm align` asks;
- *{BY_DISAGREEMENT}*: {TOO_FEW} at random, then where {sizes.ensemble} alignments, learned from bootstrap
  samples of the answers, would move the arm most differently; up to {sizes.disagreement_up_to} answers.

Asking by novelty stops by the rule of `latentarm align`: where such an ensemble nearly agrees, or three more
answers have not made it agree more.
"""


def _curves(curves: Sequence[CurveResult]) -> list[str]:
    parts = ["Where asking stops, mean ± SD over runs:\n", stopping_table(curves)]
    for curve in curves:
        cell = curve.cell.learned.cell
        name = f"{look_of(cell.task).label}, {look_of(cell.model).label}, noise {curve.cell.noise:g}"
        parts.append(f"<details><summary>{name}</summary>\n\n{curve_table(curve)}\n</details>\n")
    return parts


def _reading(preset: Preset) -> str:
    """How the tables are to be read."""
    return f"""## How to read the tables

- Figures are mean ± SD over {preset.runs} runs, which differ in the motions that are asked about, in the
  noise and in f's first weights. Motions are the same for every condition and noise. {NO_ALIGN} (z = u)
  learns nothing and has one figure.
- {listed(FEW_ANSWERS)} are learned from the same {preset.answers} answers.
- *The encoder's own choice* is the error with the latent action that the encoder would choose, which knows
  the wanted motion. It looks for the nearest action in the joints, not at the tool, so that it is no bound: a
  good alignment may come out below it.
- The paper shows its figures as bars without printed numbers, for Plane and Reach & Pour. Its text says that
  single priors do twice as well as {WITHOUT_PRIORS}, that all of them do better still with the lowest mean
  and SD at every noise, and that this almost matches {IDEAL}.
- All runs of a task share one decoder and its demonstrations, so tests and figures speak of these only.
"""


def _hypotheses(tests: Sequence[Comparison]) -> str:
    """The tests and how they were taken."""
    return f"""## Tests of the hypotheses

One-sided tests of the relative error over runs: Welch's, or a one-sample test where one side has no spread.
H1: {IDEAL} and {ALL_PRIORS} are below {NO_ALIGN} and below {MANUAL}. H2: each single prior and {ALL_PRIORS}
are below {WITHOUT_PRIORS}, and {ALL_PRIORS} is below {NEAR:g} times {IDEAL}. H3: {ALL_PRIORS} is below each
single prior. p is corrected by Holm's method over all tests of a hypothesis with one decoder; a test holds
below {LEVEL:g}. Hedges' g is above 0 where the difference has the hypothesis' direction. What cannot be
tested does not hold.

<details><summary>All {len(tests)} tests</summary>

{comparison_table(tests)}
</details>
"""
