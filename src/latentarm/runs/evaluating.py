"""`latentarm evaluate`: a run measured on its held-out episodes."""

import math
import warnings
from collections.abc import Sequence
from dataclasses import asdict, dataclass, replace
from functools import partial
from pathlib import Path
from typing import Any, Final

import numpy as np
from threadpoolctl import threadpool_limits

from latentarm.assistance.annotation import prepared
from latentarm.core.errors import UserError
from latentarm.core.figure_style import save_figure
from latentarm.core.parallel import check_jobs, run_grid
from latentarm.core.types import Demonstrations, FloatArray, Row
from latentarm.core.untrusted.documents import read_object
from latentarm.core.untrusted.opening import is_missing
from latentarm.demonstrations.gripper import told_by
from latentarm.demonstrations.split import make_folds, select_episodes
from latentarm.evaluation.effects import axis_effects, axis_grid
from latentarm.evaluation.evaluation import (
    GRID,
    Probe,
    PropertyFigures,
    measure,
    measure_behaviour,
    take_probe,
)
from latentarm.evaluation.figures import latent_effect_figure, properties_figure
from latentarm.evaluation.results import as_document
from latentarm.evaluation.samples import evenly_spread, moving_episodes, spread_contexts
from latentarm.evaluation.search import nearest_latents
from latentarm.evaluation.summary import Subject, summarise
from latentarm.evaluation.verdict import THRESHOLDS, Finding, findings
from latentarm.models.decoder import Decoder
from latentarm.models.estimators import load_model
from latentarm.models.model import LatentActionModel
from latentarm.models.scaling import CollapseWarning
from latentarm.robots.robot import Robot
from latentarm.runs.advice import FEW_EPISODES, next_step
from latentarm.runs.folder import Run, read_run, robot_of, weights_fingerprint
from latentarm.runs.options import EvaluateOptions
from latentarm.runs.results_folder import refuse_other_results, write_json
from latentarm.runs.samples import load_samples

FOLDS: Final = 5  # number of folds where there are few episodes
OVER_FOLDS: Final = "over folds"  # condition of the rows whose SD is over folds and not over seeds
FOLD_STREAM: Final = 3  # stream of the seed that chooses the folds
DRAWN_STATES = 3  # states from which the effect of each latent axis is drawn


@dataclass(frozen=True)
class Evaluation:
    """A run, measured.

    ``rows`` are mean and SD over the run's seeds on its own split; where it was refitted on folds, the same
    with the condition `OVER_FOLDS`: mean over folds of the mean over seeds, and SD over folds.
    """

    rows: list[Row]
    found: list[Finding]  # thresholds that it misses, judged over folds where there are some
    advice: str
    missing: str = ""  # one sentence on the measures that could not be taken, or ""

    @property
    def verdict(self) -> str:
        """One sentence."""
        if not self.found and self.missing:
            return "Verdict: within the thresholds of all that was measured."
        if not self.found:
            return f"Verdict: within all {len(THRESHOLDS) + 1} thresholds."
        return f"Verdict: {'; '.join(one.said for one in self.found)}."


def evaluate_run(options: EvaluateOptions) -> Evaluation:
    """Measure a run and write ``metrics.json`` and two figures.

    With few episodes the split matters more than the seed, so the model is also refitted on folds that hold
    each episode out once; the run's own split is one of the folds.

    Without the dataset all is measured but the errors of reconstruction, on the samples that the run keeps.

    Raises UserError where the folder is not a run, its dataset is gone or does not fit it, its robot is not
    available, there are too few episodes for the folds, or the folder for metrics holds other results.
    """
    folder, out, dataset, seed = options.run, options.folder, options.demonstrations, options.seed
    check_jobs(options.jobs)
    run = read_run(folder)
    model = load_model(folder)
    robot = robot_of(run)
    samples = load_samples(folder)
    probe = None if samples is None else samples.probe
    missing = ""
    if probe is not None and dataset is None and is_missing(run.demonstrations) and not options.folds:
        demonstrations = None
        missing = (
            f"The dataset is not at {run.demonstrations} any more: the errors of reconstruction and the folds"
            " are left out. Say where it is with --demonstrations."
        )
        take = partial(_measure_kept, model, probe, robot)
    else:
        demonstrations = prepared(run.dataset(dataset), run.context)
        demonstrations = told_by(demonstrations, model.decoder(0).layout.gripper)
        take = partial(_measure_all, run, model, demonstrations, robot, seed)
    dof = model.decoder(0).action_dim if demonstrations is None else demonstrations.dof
    if dof != robot.dof:
        raise UserError(
            f"{run.demonstrations} has {dof} joints, but robot {robot.name} has {robot.dof}:"
            " train on a dataset of that robot."
        )
    cells = [] if demonstrations is None else _folds(run, model, demonstrations, options.folds, seed)
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
    measured = take()
    subject = Subject("evaluate", task=run.demonstrations.name, model=run.model)
    rows = measured.figures.rows(subject)
    judged = rows
    if cells:
        refitted = run_grid(
            _measure_fold, cells, jobs=options.jobs, label=_fold_name, bars=options.bars, unit="folds"
        )
        judged = _rows_over_folds(replace(subject, condition=OVER_FOLDS), [measured.figures, *refitted])
        rows = [*rows, *judged]
    found = findings(judged)
    missed = frozenset(one.measure for one in found)
    way_back = model.decoder(0).way_back is not None
    advice = next_step(run.model, way_back, str(folder), str(dataset or run.demonstrations), missed)
    evaluation = Evaluation(rows, found, advice, missing)
    document = as_document([*rows, findings_row(evaluation)], about)
    verdict = {"sentence": evaluation.verdict, "findings": [asdict(one) for one in found]}
    more = {"verdict": verdict, "next": advice} | ({"missing": missing} if missing else {})
    write_json(out / "metrics.json", document | more)
    _draw(run.model, model.decoder(0), measured, robot, out)
    return evaluation


def findings_row(evaluation: Evaluation) -> Row:
    """The number of missed thresholds, as a row among the others."""
    first = evaluation.rows[0]
    return Row(
        "evaluate", "findings", "1", float(len(evaluation.found)), None, 1, task=first.task, model=first.model
    )


@dataclass(frozen=True, eq=False)
class _Measured:
    """A run on its own split, and the input of its figures."""

    figures: PropertyFigures
    probe: Probe
    starts: FloatArray  # (N, c), contexts from which the effects of the axes are drawn
    path: FloatArray | None = None  # (T, n), an episode to draw behind them, rad, or None


def _measure_all(
    run: Run, model: LatentActionModel, demonstrations: Demonstrations, robot: Robot, seed: int
) -> _Measured:
    figures = measure(model, demonstrations, run.held_out, robot, rng=np.random.default_rng(seed))
    shown = moving_episodes(demonstrations, run.held_out)[:1]
    starts = spread_contexts(shown, model.context, DRAWN_STATES)
    return _Measured(figures, take_probe(model, demonstrations, run.held_out), starts, shown[0].state)


def _measure_kept(model: LatentActionModel, probe: Probe, robot: Robot) -> _Measured:
    decoders = [model.decoder(index) for index in range(model.seeds)]
    codes = model.encode(probe.context, probe.action)
    z = nearest_latents(decoders, probe.context, probe.action, codes)
    figures = measure_behaviour(decoders, z, probe, robot)
    return _Measured(figures, probe, probe.states[evenly_spread(DRAWN_STATES, len(probe.states))])


@dataclass(frozen=True, eq=False)
class _FoldCell:
    """The model of a run, to be fitted anew with other episodes held out."""

    run: Run
    model: LatentActionModel
    demonstrations: Demonstrations  # the run's dataset
    index: int  # number of the fold; the run's own split is 0
    held_out: tuple[int, ...]
    seed: int


def _folds(
    run: Run, model: LatentActionModel, demonstrations: Demonstrations, folds: int | None, seed: int
) -> list[_FoldCell]:
    """The folds beyond the run's own split."""
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
        _FoldCell(run, model, demonstrations, number, tuple(sorted(rest[one] for one in part.held_out)), seed)
        for number, part in enumerate(parts, start=1)
    ]


def _measure_fold(cell: _FoldCell) -> PropertyFigures:
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


def _rows_over_folds(subject: Subject, figures: Sequence[PropertyFigures]) -> list[Row]:
    """Mean over folds of the mean over seeds, and SD over folds."""
    means = [
        {row.measure: math.nan if row.mean is None else row.mean for row in one.rows(subject)}
        for one in figures
    ]
    return [summarise(subject, name, [one[name] for one in means]) for name in means[0]]


def _draw(name: str, decoder: Decoder, measured: _Measured, robot: Robot, out: Path) -> None:
    """Figures of one seed: distance against z, and where each axis leads."""
    chain, step_s = robot.chain, measured.probe.step_s
    grid = axis_grid(GRID)
    effects = axis_effects([decoder], measured.probe.states, grid, chain, step_s)[0]
    save_figure(properties_figure(effects, grid, name), out / "consistency.png")
    behind = None if measured.path is None else chain.forward(measured.path).position
    figure = latent_effect_figure(
        decoder, measured.starts, chain, step_s, name, behind, way_back=decoder.way_back
    )
    save_figure(figure, out / "latent_axes.png")
