"""``results.md``: the comparison as a page that reads by itself."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from latentarm.demonstrations.folds import FEW, MANY
from latentarm.files import write_text
from latentarm.metrics.looks import look_of
from latentarm.metrics.measures import label_of
from latentarm.metrics.undone import NEAR_M
from latentarm.studies.compare.measures import MEASURED, meaning_of
from latentarm.studies.compare.preset import REFERENCE, Preset
from latentarm.studies.compare.rows import condition
from latentarm.studies.compare.tables import CORNER, drive_table, page_table, target_table
from latentarm.studies.compare.targets import Verdict
from latentarm.studies.page import listed
from latentarm.types import Row


@dataclass(frozen=True)
class Content:
    """What the page is about.

    Attributes:
        command: the words that do it again.
        preset: sizes.
        datasets: names.
        episodes: of each dataset.
        ours: the model that is judged.
        rows: see `rows_of`.
        fewer: models that were trained on fewer demonstrations.
        counts: numbers of demonstrations, rising.
        verdicts: on `ours`.
        drives: rows of the drives.
        seed: of everything random.
    """

    command: str
    preset: Preset
    datasets: Sequence[str]
    episodes: Sequence[int]
    ours: str
    rows: Sequence[Row]
    fewer: Sequence[str]
    counts: Sequence[int]
    verdicts: Sequence[Verdict]
    drives: Sequence[Row]
    seed: int


def write_page(out: Path, content: Content) -> None:
    """Write ``results.md`` beside the figures.

    Raises:
        UserError: the file cannot be written.
    """
    preset = content.preset
    parts = ["# Latent action models on demonstrations\n", _introduction(content), _targets(content)]
    parts += ["![Error against reversal and reach](pareto.png)\n", "## Every model\n", _definitions()]
    parts += [
        f"### {dataset}, {condition(noise_rad)}\n\n{page_table(content.rows, dataset, noise_rad)}"
        for dataset in content.datasets
        for noise_rad in preset.noises_rad
    ]
    if content.fewer:
        parts.append(_fewer(content))
    if content.drives:
        parts.append(_drives(content))
    write_text(out / "results.md", "\n".join(parts))


def _introduction(content: Content) -> str:
    preset = content.preset
    sizes = listed(
        f"{name} ({episodes} episodes)"
        for name, episodes in zip(content.datasets, content.episodes, strict=True)
    )
    epochs = "its own number of epochs" if preset.epochs is None else f"{preset.epochs} epochs"
    return f"""{listed(look_of(name).label for name in preset.models)} on {sizes}.

```sh
{content.command}
```

- {preset.folds} folds: every episode is held out exactly once; nothing is fitted to it. Of a fold's other
  episodes some are for validation, which stops the training early (two of {MANY} or more, one of {FEW} or
  more), and the rest train. The
  folds are the same for every model.
- Models of each kind in each fold: {preset.seeds}; PCA has no seeds. d = 2; batches of {preset.batch_size},
  hidden layers of {" and ".join(map(str, preset.hidden))} units, else every model's own parameters, with
  {epochs} at most.
- Noise is on the states that the decoder sees, in training and for the noisy error; actions come from the
  states before it.
- {CORNER}: the mean over folds is taken for each seed, and its mean and SD are
  over the seeds; in brackets, the SD over folds of the mean over seeds. Folds mostly differ more than seeds.
- Seed {content.seed}. Every figure of every seed is in `seeds.json`.
"""


def _targets(content: Content) -> str:
    ours = look_of(content.ours).label
    if not content.verdicts:
        reference = look_of(REFERENCE).label
        return f"No targets are judged: {ours} and {reference} must be among the models for that.\n"
    met = sum(one.met for one in content.verdicts)
    return f"""## What {ours} is held against

Means of {ours}, on each dataset under each noise: {met} of {len(content.verdicts)} targets met.

{target_table(content.verdicts)}"""


def _definitions() -> str:
    lines = [f"- *{label_of(name)}*: {meaning_of(name)}." for name in MEASURED]
    return "What is measured, on the held-out episodes of each fold:\n\n" + "\n".join(lines) + "\n"


def _fewer(content: Content) -> str:
    return f"""## With fewer demonstrations

{listed(look_of(name).label for name in content.fewer)} with {listed(map(str, content.counts))} training
demonstrations, on the same folds; fewer are some of the more. Validation episodes are
among them: two of {MANY} or more, one of {FEW} or more. With fewer than that none is held back, and the
training stops where its own loss falls no further. Percentages are of the same PCA throughout, fitted to all
that a fold does not hold out.

![Error, reach and reversal by training demonstrations](fewer.png)
"""


def _drives(content: Content) -> str:
    tables = "\n".join(
        f"### Drives of {dataset}\n\n{drive_table(content.drives, dataset)}" for dataset in content.datasets
    )
    names = listed(look_of(name).label for name in dict.fromkeys(row.model or "" for row in content.drives))
    return f"""## Simulated drives along held-out episodes

A **simulated** operator drives the way of held-out episodes in simulation, through poses every 0.25 m (a
radian counts as 0.2 m) that must each be met within 30 mm and 20°, with {names}: always
through the same loop and safety filters. One model per fold, trained under
{condition(content.preset.noises_rad[0])}. A drive that is not done after {content.preset.drive_limit_s:g} s
has failed; time, input and path are over all drives, failed ones too.

The operator of equation 24 looks one step ahead and gets stuck within a few poses of latent actions. So here,
with every controller, they plan up to 4 s ahead where no single input brings the tool 4 mm nearer, by
imagining the controller exactly. That is more than a person can do: it says what the latent actions allow.

*Undone* is the share of the tool's path that is later gone back over, within {1e3 * NEAR_M:g} mm and more
than 120° against it; the demonstrations go back over some of their own way too.

{tables}"""
