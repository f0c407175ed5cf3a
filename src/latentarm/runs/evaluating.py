"""`latentarm evaluate`: a run measured on the episodes that it never saw."""

import math
import warnings
from collections.abc import Sequence
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import Any, Final

import numpy as np
from threadpoolctl import threadpool_limits

from latentarm.demonstrations.folds import make_folds
from latentarm.demonstrations.split import select_episodes
from latentarm.errors import UserError
from latentarm.metrics.effects import axis_effects, axis_grid
from latentarm.metrics.evaluation import EvaluationConfig, Figures, measure
from latentarm.metrics.latent_effect_figure import latent_effect_figure
from latentarm.metrics.properties_figure import properties_figure
from latentarm.metrics.results import as_document
from latentarm.metrics.samples import ContextKind, moving_episodes, spread_contexts
from latentarm.metrics.summary import Subject, summarise
from latentarm.metrics.verdict import THRESHOLDS, Finding, findings
from latentarm.models.catalogue import load_model
from latentarm.models.model import LatentActionModel
from latentarm.models.scaling import CollapseWarning
from latentarm.parallel.grid import check_processes, run_grid
from latentarm.robots.robot import Robot
from latentarm.runs.advice import FEW_EPISODES, next_step
from latentarm.runs.checks import check_seed
from latentarm.runs.folder import Run, read_run, robot_of, weights_fingerprint
from latentarm.runs.results_folder import refuse_other_results, write_json
from latentarm.runs.training import prepared
from latentarm.style import save_figure
from latentarm.types import Demonstrations, Row
from latentarm.untrusted.documents import read_object
from latentarm.untrusted.opening import is_missing

FOLDS: Final = 5
"""How many where there are few episodes."""

OVER_FOLDS: Final = "over folds"
"""Condition of the rows whose SD is over folds and not over seeds."""

FOLD_STREAM: Final = 3
"""Keeps the choice of folds apart from everything else that is drawn from the same seed."""

DRAWN_STATES = 3
"""States from which the effect of each latent axis is drawn."""


@dataclass(frozen=True)
class Evaluation:
    """A run, measured.

    Attributes:
        rows: mean and SD over the run's seeds on its own split; where it was refitted on folds, the same with
            the condition `OVER_FOLDS`: mean over folds of the mean over seeds, and SD over folds.
        found: thresholds that it misses, judged over folds where there are some.
        advice: what to do next.
    """

    rows: list[Row]
    found: list[Finding]
    advice: str

    @property
    def verdict(self) -> str:
        """One sentence."""
        if not self.found:
            return f"Verdict: within all {len(THRESHOLDS) + 1} thresholds."
        return f"Verdict: {'; '.join(one.said for one in self.found)}."


def evaluate_run(
    folder: Path,
    out: Path,
    seed: int,
    dataset: Path | None = None,
    *,
    folds: int | None = None,
    jobs: int = 1,
    bars: bool = False,
) -> Evaluation:
    """Measure a run and write ``metrics.json`` and two figures.

    With few episodes the split moves the figures more than the seed does, so the model is also refitted with
    other episodes held out, such that each is held out once; the run's own split is one of the folds.

    Args:
        folder: the run.
        out: where to write.
        seed: of the noise on held-out states, and of which episodes go together in a fold.
        dataset: where the run's dataset lies now, if it was moved.
        folds: how many, the run's own split included; 0 measures that alone; where None, `FOLDS` for at most
            `FEW_EPISODES` episodes, else 0.
        jobs: processes that refit side by side; -1 is one per core.
        bars: show on standard error how many folds are done.

    Raises:
        UserError: the folder is not a run, its dataset is gone or does not fit it, its robot is not
            available, there are too few episodes for the folds, or ``out`` holds other results.
    """
    check_seed(seed)
    check_processes(jobs, "joblib")
    run = read_run(folder)
    model = load_model(folder)
    demonstrations = prepared(run.dataset(dataset), run.context)
    robot = robot_of(run)
    if demonstrations.dof != robot.dof:
        raise UserError(
            f"{run.demonstrations} has {demonstrations.dof} joints, but robot {robot.name} has {robot.dof}:"
            " train on a dataset of that robot."
        )
    cells = _folds(run, model, demonstrations, folds, seed)
    about: dict[str, object] = {
        "run": str(folder.resolve()),
        "model": weights_fingerprint(folder),
        "seed": seed,
        "held_out": list(run.held_out),
        "folds": [list(cell.held_out) for cell in cells],
    }
    if not is_missing(out / "metrics.json"):
        earlier = read_object(out / "metrics.json").get("about")
        refuse_other_results(out / "metrics.json", out, earlier if isinstance(earlier, dict) else {}, about)
    config = EvaluationConfig()
    own = measure(model, demonstrations, run.held_out, robot, rng=np.random.default_rng(seed), config=config)
    subject = Subject("evaluate", task=run.demonstrations.name, model=run.model)
    rows = _rows(subject, own)
    judged = rows
    if cells:
        refitted = run_grid(
            _measure_fold, cells, jobs=jobs, backend="joblib", label=_fold_name, bars=bars, unit="folds"
        )
        judged = _rows_over_folds(replace(subject, condition=OVER_FOLDS), [own, *refitted])
        rows = [*rows, *judged]
    found = findings(judged)
    missed = frozenset(one.measure for one in found)
    evaluation = Evaluation(
        rows, found, next_step(run.model, str(folder), str(dataset or run.demonstrations), missed)
    )
    document = as_document([*rows, findings_row(evaluation)], about)
    verdict = {"sentence": evaluation.verdict, "findings": [asdict(one) for one in found]}
    write_json(out / "metrics.json", document | {"verdict": verdict, "next": evaluation.advice})
    _draw(run, model, demonstrations, robot, config, out)
    return evaluation


def findings_row(evaluation: Evaluation) -> Row:
    """How many thresholds are missed, as a row among the others."""
    first = evaluation.rows[0]
    return Row(
        "evaluate", "findings", "1", float(len(evaluation.found)), None, 1, task=first.task, model=first.model
    )


@dataclass(frozen=True, eq=False)
class _FoldCell:
    """The model of a run, to be fitted anew with other episodes held out.

    Attributes:
        run: whose model it is.
        model: for its parameters.
        demonstrations: the run's dataset.
        index: number of the fold; the run's own split is 0.
        held_out: episodes that nothing is fitted to.
        seed: of the noise on held-out states.
    """

    run: Run
    model: LatentActionModel
    demonstrations: Demonstrations
    index: int
    held_out: tuple[int, ...]
    seed: int


def _folds(
    run: Run, model: LatentActionModel, demonstrations: Demonstrations, folds: int | None, seed: int
) -> list[_FoldCell]:
    """The folds beyond the run's own split.

    Raises:
        UserError: there are too few episodes, or the run cannot be refitted.
    """
    episodes = len(demonstrations.episodes)
    rest = [index for index in range(episodes) if index not in run.held_out]
    trained_with_entropy = bool(read_object(run.folder / "config.json").get("goal_entropy"))
    if folds is None:
        usual = 0 if episodes > FEW_EPISODES or trained_with_entropy else min(FOLDS, len(rest) + 1)
        folds = usual if usual > 1 else 0
    if folds == 0:
        return []
    if folds < 2:
        raise UserError(f"The number of folds is {folds}: it must be 0, or at least 2.")
    if trained_with_entropy:
        raise UserError(
            f"{run.folder} was trained with the entropy over goals and is not refitted: use --folds 0."
        )
    if len(rest) < folds - 1 or episodes - max(len(run.held_out), 1) < 2:
        raise UserError(
            f"{run.demonstrations} has {episodes} episodes, too few for {folds} folds: choose fewer, or 0."
        )
    parts = make_folds(len(rest), folds - 1, np.random.default_rng([FOLD_STREAM, seed]))
    return [
        _FoldCell(
            run, model, demonstrations, number, tuple(sorted(rest[index] for index in part.held_out)), seed
        )
        for number, part in enumerate(parts, start=1)
    ]


def _measure_fold(cell: _FoldCell) -> Figures:
    """Fit the model anew without a fold's episodes, and measure it on them."""
    robot = robot_of(cell.run)
    others = [index for index in range(len(cell.demonstrations.episodes)) if index not in set(cell.held_out)]
    parameters: dict[str, Any] = dict(cell.model.get_params())
    with threadpool_limits(limits=1), warnings.catch_warnings():
        # A collapsed axis shows in the figures.
        warnings.simplefilter("ignore", CollapseWarning)
        model = type(cell.model)(**parameters)
        model.fit(select_episodes(cell.demonstrations, others), chain=robot.chain)
        return measure(model, cell.demonstrations, cell.held_out, robot, rng=np.random.default_rng(cell.seed))


def _fold_name(cell: _FoldCell) -> str:
    return f"fold {cell.index}"


def _rows(subject: Subject, figures: Figures) -> list[Row]:
    """Mean and SD over seeds."""
    rows = [summarise(subject, name, values) for name, values in figures.per_seed.items()]
    return [*rows, summarise(subject, "start_distance_m", figures.start_distance_m)]


def _rows_over_folds(subject: Subject, figures: Sequence[Figures]) -> list[Row]:
    """Mean over folds of the mean over seeds, and SD over folds."""
    means = [
        {row.measure: math.nan if row.mean is None else row.mean for row in _rows(subject, one)}
        for one in figures
    ]
    return [summarise(subject, name, [one[name] for one in means]) for name in means[0]]


def _draw(
    run: Run,
    model: LatentActionModel,
    demonstrations: Demonstrations,
    robot: Robot,
    config: EvaluationConfig,
    out: Path,
) -> None:
    """Figures of the first seed: distance against z, and where each axis leads."""
    kind: ContextKind = model.context
    decoder = model.decoder(0)
    episodes = moving_episodes(demonstrations, run.held_out)
    step_s = 1.0 / demonstrations.rate_hz
    grid = axis_grid(config.grid)
    states = spread_contexts(episodes, kind, config.states)
    effects = axis_effects([decoder], states, grid, robot.chain, step_s)[0]
    save_figure(properties_figure(effects, grid, run.model), out / "consistency.png")
    shown = episodes[:1]
    path = robot.chain.forward(shown[0].state).position
    starts = spread_contexts(shown, kind, DRAWN_STATES)
    figure = latent_effect_figure(decoder, starts, robot.chain, step_s, run.model, path)
    save_figure(figure, out / "latent_axes.png")
