"""``results.md``: the study as a page that reads by itself."""

from collections.abc import Sequence
from pathlib import Path
from typing import Final

from latentarm.files import write_text
from latentarm.studies.pages import listed, shown
from latentarm.studies.shared_autonomy.cell import CellResult, Entropy
from latentarm.studies.shared_autonomy.drive import GAIN_PER_S, HELP, INPUTS, LOOK_AHEAD_S, STEP_S
from latentarm.studies.shared_autonomy.hypotheses import REACHED, TRAPPED, Comparison
from latentarm.studies.shared_autonomy.intervals import FEWEST_SEEDS
from latentarm.studies.shared_autonomy.measures import ARRIVED
from latentarm.studies.shared_autonomy.paper import MODEL
from latentarm.studies.shared_autonomy.people import CHANGING_DRIVE_S, DRIVE_S, NEAR_OPTIMAL
from latentarm.studies.shared_autonomy.preset import Preset
from latentarm.studies.shared_autonomy.rows import Figure
from latentarm.studies.shared_autonomy.tables import (
    Found,
    ablation_table,
    by_place,
    comparison_table,
    extra_time_table,
    people_table,
    reconstruction_table,
)
from latentarm.studies.shared_autonomy.verdicts import verdicts
from latentarm.studies.statistics import LEVEL
from latentarm.studies.verdicts import Verdict
from latentarm.style import look_of

HYPOTHESES: Final = {
    "H1": "with shared autonomy people end nearer to their goal, at every rationality between the extremes",
    "H2": "people who change their mind late are trapped without the entropy and not with it",
    "H3": "people who learn end nearer with the entropy",
}

MAIN: Final = ("final_state_error", "time_s")
"""Measures that are shown of the paper's model at once; the others are to be unfolded."""


def write_page(
    out: Path,
    results: Sequence[CellResult],
    found: Sequence[Figure],
    tests: Sequence[Comparison],
    preset: Preset,
    tasks: Sequence[str],
    seed: int,
) -> None:
    """Write ``results.md`` beside the study's other files.

    Args:
        out: the study's folder; the PNGs that are in it are shown.
        results: every cell.
        found: every figure, see `figures`.
        tests: see `compare_methods`.
        preset: sizes of the study.
        tasks: names of the tasks that were run.
        seed: of the study.

    Raises:
        UserError: the file cannot be written.
    """
    drawings = sorted(path.name for path in out.glob("*.png"))
    of_tasks = [name for name in drawings if name.startswith(tuple(tasks))]
    models = list(dict.fromkeys(result.cell.model for result in results))
    places = by_place(found)
    parts = [
        "# Shared autonomy with latent actions\n",
        _introduction(preset, tasks, seed),
        *shown(of_tasks),
        _in_short(tests),
        *shown(name for name in drawings if name not in of_tasks),
    ]
    for task in tasks:
        parts += _task(places, task, models, preset, [one.measure for one in found])
    parts += [
        "## Reconstruction\n",
        reconstruction_table(places, tasks, models),
        *_ablations(places, tasks, preset),
        _reading(preset),
        _hypotheses(tests),
    ]
    write_text(out / "results.md", "\n".join(parts))


def _introduction(preset: Preset, tasks: Sequence[str], seed: int) -> str:
    """What was done, in numbers, and the command that does it again."""
    chosen = f" --task {tasks[0]}" if len(tasks) == 1 else ""
    layers = " and ".join(map(str, preset.hidden))
    weights = listed(f"{weight:g} ({look_of(name).label})" for name, weight in preset.entropy_weights.items())
    slopes = listed(f"{slope:g}" for slope in preset.learners.values())
    return f"""Section 8.2 of Losey et al., *Learning Latent Actions to Control Assistive Robots*, done again.
Everything is **simulated**: the arms, the people who demonstrate and those who drive. No person took part.

```sh
latentarm reproduce shared-autonomy --preset {preset.name}{chosen} --seed {seed}
```

Two cups stand before an arm. One input, left or right, is to say which cup and then which grasp. There are
three methods: latent actions alone (**LA**); with help towards the goals that the robot believes in
(**LA+SA**); and the same with a decoder that was trained to leave every goal open (**LA+SA+Entropy**,
equation 16).

- {preset.demonstrations} demonstrations train every model, {preset.test_demonstrations} more measure
  reconstruction. {preset.seeds} models of each kind; at most {preset.epochs} passes, hidden layers of
  {layers} units, lambda_1 = {preset.kl_weight:g} (cVAE), lambda_2 = {weights}.
- {preset.drives} drives with each model and each person, half of them to each cup; starts and chances are the
  same for every method. A drive lasts {DRIVE_S:g} s, with a change of mind {CHANGING_DRIVE_S:g} s.
- People choose by equation 24 among {len(INPUTS)} inputs every {STEP_S:g} s and look
  {LOOK_AHEAD_S:g} s ahead; beta is in 1/m². Those who learn have beta = m t, m = {slopes} per s. Those who
  change their mind have beta = {NEAR_OPTIMAL:g} and drive to the other cup first.
- alpha = {HELP.value:g}, gain {GAIN_PER_S:g}/s. The belief is updated by equation 9, along the
  demonstrations as online.

The paper leaves these choices open. They are the same for every model and method, with their reasons in the
package's `studies/shared_autonomy/drive.py`.
"""


def _in_short(tests: Sequence[Comparison]) -> str:
    """The verdicts, model by model."""
    return "\n".join(["## In short\n", *(_verdict_lines(verdict) for verdict in verdicts(tests))])


def _verdict_lines(verdict: Verdict[str]) -> str:
    """A hypothesis with one model, and below it what each arm says of it."""
    lines = [f"**{verdict.hypothesis}**, {HYPOTHESES[verdict.hypothesis]}; {look_of(verdict.about).label}:\n"]
    lines += [f"- {look_of(task).label}: {said}" for task, said in verdict.by_task.items()]
    return "\n".join(lines) + "\n"


def _task(
    places: Found, task: str, models: Sequence[str], preset: Preset, measures: Sequence[str]
) -> list[str]:
    """The tables of one arm."""
    people = [person.label for person in preset.people]
    driven = [name for name in dict.fromkeys(measures) if (task, MODEL, f"LA, {people[0]}", name) in places]
    label = look_of(MODEL).label
    others = [model for model in models if model != MODEL]
    parts = [f"## {look_of(task).label.capitalize()}\n"]
    for measure in MAIN:
        parts += [f"{label}:\n", people_table(places, task, MODEL, people, measure)]
    parts.append(extra_time_table(places, task, models, people))
    parts.append(f"<details><summary>{label}: all other measures</summary>\n")
    parts += [people_table(places, task, MODEL, people, name) for name in driven if name not in MAIN]
    parts.append("</details>\n")
    for model in others:
        parts.append(f"<details><summary>{look_of(model).label}: all measures</summary>\n")
        parts += [people_table(places, task, model, people, name) for name in driven]
        parts.append("</details>\n")
    return parts


def _ablations(places: Found, tasks: Sequence[str], preset: Preset) -> list[str]:
    """What is varied about the entropy, where anything was."""
    ablation = preset.ablation
    if ablation is None:
        return []
    people = [person.label for person in preset.varied_people]
    proper = Entropy(preset.entropy_weights[MODEL])
    parts = [
        "## What the entropy is made of\n",
        f"LA+SA+Entropy with the {look_of(MODEL).label}, {ablation.seeds} models and {ablation.drives} drives"
        f" each. One thing is varied at a time from lambda_2 = {proper.weight:g},"
        f" kappa = {proper.sharpness:g}, contexts {proper.where}, progress of joints and tool;"
        " lambda_2 = 0 is LA+SA.\n",
    ]
    for task in tasks:
        parts += [f"{look_of(task).label}:\n", ablation_table(places, task, MODEL, preset, people)]
    return parts


def _reading(preset: Preset) -> str:
    """How the tables are to be read."""
    over = "the models of a kind" if preset.seeds >= FEWEST_SEEDS else "all drives, for want of models"
    return f"""## How to read the tables

- Figures are means with 95 % intervals (Student's t) over {over}.
- *Final state error* is how far the joints are from their goal at the end, *final tool error* how far the
  tool is, both in the distance between the two goals: 0 is at the goal, 1 as far away as the other one. A
  goal is the place before a cup; who goes on to grasp leaves it a little.
- *Time* is until the state error is below {ARRIVED:g} for the first time. A drive that does not get there
  counts all the time it had; *share that arrives* says how many do. *Success* is a tool that ends within half
  the distance between the goals.
- *Entropy over goals* is that of p_c(g) as it is trained, over the inputs, mean over the steps of the drives.
  The true goal is *open* where some input leads towards it at half the demonstrated speed, or it is reached.
- A step is *certified* where the bound says that the error shrinks, whatever the person does: by equation 14,
  by equation 13 and, tighter, with the help known. Without help nothing is certified.
- The paper prints two figures for this study, how much more time LA takes than LA+SA on its Panda; they stand
  beside ours as *(paper: ...)*. Its other results are curves without numbers.
"""


def _hypotheses(tests: Sequence[Comparison]) -> str:
    """The tests and how they were taken."""
    return f"""## Tests of the hypotheses

One-sided tests of the final state error over the models of each kind. Two methods are compared model by model
(paired t), a method and a mark by a one-sample t. H1 also asks that the 95 % intervals lie apart. In H2,
*trapped* is an error above {TRAPPED:g}, *not trapped* one below {REACHED:g}. p is corrected by Holm's method
over all tests of a hypothesis with one model; a test holds below {LEVEL:g}. Hedges' g, of the differences, is
above 0 where they have the hypothesis' direction. What cannot be tested does not hold. The models of a kind
share their demonstrations, so the tests speak of these demonstrations only.

<details><summary>All {len(tests)} tests</summary>

{comparison_table(tests)}
</details>
"""
