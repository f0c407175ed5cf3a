"""``results.md``: the study as a page that reads by itself."""

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Final

from latentarm.files import write_text
from latentarm.studies.pages import shown
from latentarm.studies.properties.hypotheses import CLAIMS, LINEAR, Comparison
from latentarm.studies.properties.preset import Preset
from latentarm.studies.properties.tables import (
    OURS,
    UNIT_NOT_STATED,
    as_good_as_paper,
    comparison_table,
    noise_table,
    paper_table,
)
from latentarm.studies.properties.verdicts import verdicts
from latentarm.studies.statistics import LEVEL
from latentarm.studies.verdicts import Verdict
from latentarm.style import look_of
from latentarm.tasks.planar.motion import SAMPLES, STEP_S
from latentarm.types import Row

if TYPE_CHECKING:
    from latentarm.studies.properties.cell import CellResult

HYPOTHESES: Final = {
    "H1": "only latent action models conditioned on the context reconstruct actions accurately",
    "H2": "conditioned models learn a latent space that is controllable, consistent and scalable",
}

TASKS: Final = {
    "sine": "One arm of 5 joints moves its tool along a sine wave; 1-D latent action.",
    "rotate": "Two arms of 5 joints hold a box and turn it about its middle; 1-D latent action. R² is of the "
    "turning of both grippers.",
    "circle": "One arm of 5 joints moves its tool along circles and between them; 2-D latent action.",
    "reach": "One arm of 5 joints moves its tool from a start into a goal region; 1-D latent action.",
}


def write_page(
    out: Path,
    results: Sequence["CellResult"],
    rows: Sequence[Row],
    tests: Sequence[Comparison],
    preset: Preset,
    tasks: Sequence[str],
    seed: int,
) -> None:
    """Write ``results.md`` beside the study's other files.

    Args:
        out: the study's folder; the PNGs that are in it are shown.
        results: every cell.
        rows: the study's figures with the paper's, see `with_paper`.
        tests: see `compare_models`.
        preset: sizes of the study.
        tasks: names of the tasks that were run.
        seed: of the study.

    Raises:
        UserError: the file cannot be written.
    """
    figures = sorted(path.name for path in out.glob("*.png"))
    parts = [
        "# Do learned latent actions capture the user-friendly properties?\n",
        _introduction(preset, tasks, seed),
        _in_short(rows, tests, tasks),
        *shown([name for name in figures if not name.startswith(tuple(tasks))]),
    ]
    for task in tasks:
        parts += [
            f"## {task.capitalize()}\n",
            f"{TASKS[task]}\n",
            paper_table(rows, task),
            *shown([name for name in figures if name.startswith(task)]),
        ]
    parts += [_reading(), *_noise(results, rows, tasks), _hypotheses(tests)]
    write_text(out / "results.md", "\n".join(parts))


def _introduction(preset: Preset, tasks: Sequence[str], seed: int) -> str:
    """What was done, in numbers, and the command that does it again."""
    chosen = f" --task {tasks[0]}" if len(tasks) == 1 else ""
    layers = " and ".join(map(str, preset.hidden))
    return f"""Section 8.1 of Losey et al., *Learning Latent Actions to Control Assistive Robots*, done again.
Everything is **simulated**: planar arms, and the people who demonstrate. No person took part.

```sh
latentarm reproduce properties --preset {preset.name}{chosen} --seed {seed}
```

- For each task a simulated person gives {preset.episodes} demonstrations of {SAMPLES} state-action pairs
  ({preset.episodes * SAMPLES} pairs), and {preset.test_episodes} more to measure on (drives into the goal
  region have starts and goals of their own); every model has the same ones. A fifth of the training
  demonstrations is not fitted to: it says which epoch was best.
- {preset.seeds} models of each kind; at most {preset.epochs} passes over the pairs, hidden layers of
  {layers} units, KL weight {preset.kl_weight:g}.
- Controllability: {preset.reach_pairs} pairs of start and goal (reach: {preset.reach_goals} goals in the
  region); a solver with z in [-1, 1] goes there greedily; how near the tool comes.
- Consistency and scalability: {preset.states} states, {preset.grid} values of z in [-1, 1].
- The transition is s' = s + a dt with dt = {STEP_S:g} s.
- Figures are mean ± SD over the models of a kind; PCA has no seeds.
"""


def _in_short(rows: Sequence[Row], tests: Sequence[Comparison], tasks: Sequence[str]) -> str:
    """The verdicts, and how our model fares."""
    lines = ["## In short\n", *(_verdict_lines(verdict) for verdict in verdicts(tests))]
    counts = {task: as_good_as_paper(rows, task) for task in tasks}
    if any(of for _, of in counts.values()):
        said = ", ".join(f"{good} of {of} on {task}" for task, (good, of) in counts.items() if of)
        lines.append(
            f"In this many measures {look_of(OURS).label} is at least as good as the best of the paper's "
            f"models: {said}.\n"
        )
    return "\n".join(lines)


def _verdict_lines(verdict: Verdict[bool]) -> str:
    """A hypothesis, and below it what each task says of it."""
    of = "the paper's models" if verdict.about else "conditioned models that the paper does not have"
    lines = [f"**{verdict.hypothesis}**, {HYPOTHESES[verdict.hypothesis]}; {of}:\n"]
    return "\n".join([*lines, *(f"- {task}: {said}" for task, said in verdict.by_task.items())]) + "\n"


def _reading() -> str:
    """How the tables are to be read."""
    return f"""## How to read the tables

- *(paper: ...)* is what the paper prints, mean ± SD over its 10 models. It says neither how large its
  tasks are nor how they are demonstrated: the same order of models is to be expected, equal figures are
  not.
- {UNIT_NOT_STATED} marks a length of the paper, whose unit it does not state. Compare only the rows in
  percent of PCA's or of the VAE's; sine's controllability and reach's lengths in percent are ratios of
  the means that the paper prints, and so have no SD.
- On rotate the paper prints R² twice for cVAE (0.995 ± 0.004, then 0.996 ± 0.002) and not for cAE; the
  second is read as cAE.
- *At least as good* compares means, and names the best of the paper's models (PCA, AE, VAE, cAE, cVAE), as
  measured here, where that is better.
- A path's length says nothing alone: an arm that stops early has a short path.
"""


def _noise(results: Sequence["CellResult"], rows: Sequence[Row], tasks: Sequence[str]) -> list[str]:
    """The noise sweep, where there was one."""
    levels = sorted({result.cell.noise_rad for result in results})
    if len(levels) < 2:
        return []
    said = ", ".join(f"{level:g}" for level in levels)
    parts = [
        "## Noise on the states\n",
        f"The states in training carry noise of SD {said} rad; actions are taken before it. The error is on "
        "test states with the same noise, the noise-free error on clean ones.\n",
    ]
    for task in tasks:
        parts += [f"### {task.capitalize()}, under noise\n", noise_table(rows, task)]
    return parts


def _hypotheses(tests: Sequence[Comparison]) -> str:
    """The tests and how they were taken."""
    measures = ", ".join(dict.fromkeys(claim.measure for claim in CLAIMS if claim.threshold is None))
    return f"""## Tests of the hypotheses

One-sided tests over the seeds of each model, without noise: {measures} of each conditioned model against
each unconditioned one (Welch's t), and R² against {LINEAR:g}. The paper calls 0.94 ± 0.04 "roughly
linear", the lowest that it prints; {LINEAR:g} is one SD below. A model whose seeds do not differ, such
as PCA, is a fixed figure (one-sample t). p is corrected by Holm's method over all tests of a hypothesis,
separately for the paper's models and for further ones; a test holds below {LEVEL:g}. Hedges' g is above
0 where the difference has the hypothesis' direction. What cannot be tested does not hold. The seeds of a
kind share their demonstrations, so the tests speak of these demonstrations only.

<details><summary>All {len(tests)} tests</summary>

{comparison_table(tests)}
</details>
"""
