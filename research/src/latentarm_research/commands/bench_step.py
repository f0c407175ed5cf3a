"""What `latentarm bench` times: the online step, torch's decoder beside it, and fits."""

import statistics
import time
from collections.abc import Callable, Sequence
from dataclasses import replace
from itertools import pairwise
from typing import final

import numpy as np

from latentarm.arms.catalogue import DEFAULT_ARM, make_simulated_arm
from latentarm.assistance.blending import FixedAlpha
from latentarm.assistance.boltzmann import BoltzmannBelief
from latentarm.assistance.controllers.latent import LatentController
from latentarm.assistance.goal_blending import GoalBlending
from latentarm.control.clock import SimulatedClock
from latentarm.control.step import Step
from latentarm.core.types import Demonstrations, Episode, FloatArray, Goal, Input, Row
from latentarm.models.autoencoders.training import CVAE
from latentarm.models.decoder import Decoder
from latentarm.models.saved_chain import chain_tensors
from latentarm.models.training import epoch_bar
from latentarm.models.way_back.runtime import pull_shapes
from latentarm.models.way_back.training import HIDDEN
from latentarm.robots.kinematics.obstacles import Sphere
from latentarm.runs.checks import check_count, check_seed
from latentarm.safety.config import SafetyConfig
from latentarm.tasks.table_top import TableTop
from latentarm_research.commands.bench_training import time_training

PAIRS = 10_000
SEEDS = 10
EPOCHS = 10
PLAIN_PAIRS = 26_000  # pairs for the comparison with a plain loop: 65 of its batches
PLAIN_RUNS = 3
RATE_HZ = 1000.0
WARM_UP = 500
TORCH_EVERY = 10  # the torch decoder is timed between two steps, once in this many steps
INPUT_TICKS = 100  # an input is held for this many steps

TURN_TICKS = 1000
"""Steps before switching to the other number of goals: enough for each to run with a warm cache."""

MANY_GOALS = 50
WAY_BACK = "way back"
SPREAD_RAD = 0.1  # further goals surround the task's own, so that the arm moves through the same region


def run_bench(repeats: int, seed: int, progress: bool, pairs: int = PAIRS) -> list[Row]:
    """Time the online step and the batched fit: a row per figure, with the number of times."""
    check_count("timed steps", repeats)
    check_seed(seed)
    task = TableTop()
    demonstrations = task.demonstrate(12, np.random.default_rng(seed))
    fits, model = _time_fits(_about(demonstrations, pairs), seed, progress)
    plain = time_training(_about(demonstrations, PLAIN_PAIRS * pairs // PAIRS), SEEDS, EPOCHS, PLAIN_RUNS)
    return [*_time_step(task, model, repeats, seed), *fits, *plain]


def _time_step(task: TableTop, model: CVAE, repeats: int, seed: int) -> list[Row]:
    """The whole step with 3 goals, with 50 and with a way back, alternating, and torch's decoder."""
    rng = np.random.default_rng(seed)
    decoder = model.decoder(0)
    few, many = _TimedStep(task, decoder, task.goals), _TimedStep(task, decoder, _many_goals(task, seed))
    led = _TimedStep(task, _led_back(task, model, rng), task.goals)
    decode = _torch_decoder(model, task.robot.dof)
    every_tick = range(repeats + WARM_UP)
    inputs = rng.uniform(-1.0, 1.0, (len(every_tick) // INPUT_TICKS + 1, 2))
    torch_s: list[tuple[float, float]] = []
    for first in range(0, len(every_tick), TURN_TICKS):
        ticks = every_tick[first : first + TURN_TICKS]
        for tick in ticks:
            u = inputs[tick // INPUT_TICKS]
            state = few.tick(u, tick)
            if tick % TORCH_EVERY == 0:
                torch_s.append(decode(u, state))
        for timed in (many, led):
            for tick in ticks:
                timed.tick(inputs[tick // INPUT_TICKS], tick)
    torch_us = 1e6 * np.array(torch_s[WARM_UP // TORCH_EVERY :])
    torch_median, layers_median = (float(value) for value in np.median(torch_us, axis=0))
    median, others = few.median_us(), f"{MANY_GOALS} goals"
    return [
        *few.rows(None),
        _row("torch_decoder_median_us", "us", torch_median, len(torch_us)),
        _row("torch_layers_median_us", "us", layers_median, len(torch_us)),
        _row("online_step_over_torch_decoder", "1", median / torch_median, repeats),
        _row("online_step_over_torch_layers", "1", median / layers_median, repeats),
        *many.rows(others),
        _row("online_step_over_3_goals", "1", many.median_us() / median, repeats, others),
        *led.rows(WAY_BACK),
        _row("online_step_over_torch_layers", "1", led.median_us() / layers_median, repeats, WAY_BACK),
        _row("online_step_over_no_way_back", "1", led.median_us() / median, repeats, WAY_BACK),
    ]


@final
class _TimedStep:
    """The whole step (7 DoF, 2-D z, help, all filters, a table and an obstacle), and how long it took."""

    def __init__(self, task: TableTop, decoder: Decoder, goals: Sequence[Goal]) -> None:
        dt_s = 1.0 / RATE_HZ
        configurations = np.stack([goal.configuration for goal in goals])
        obstacle = Sphere("cup", np.array([0.35, 0.45, 0.2]), 0.06)
        self._step = Step(
            task.robot,
            LatentController(decoder),
            SafetyConfig(obstacles=(*task.obstacles, obstacle)),
            goals=goals,
            # The belief updates in every step; the bound, computed 20 times a second, shows in p99.
            belief=BoltzmannBelief(configurations, period_s=dt_s),
            assistance=GoalBlending(configurations, FixedAlpha()),
            dt_s=dt_s,
        )
        self._clock = SimulatedClock()
        self._arm = make_simulated_arm(DEFAULT_ARM, task.robot, task.robot.home, self._clock.now_s)
        self._took_s: list[float] = []
        self._arm.connect()
        reading = self._arm.read()
        self._step.reset(reading.q)
        self._step(Input(np.zeros(2)), 0.0, reading, self._clock.now_s())
        self._arm.enable()
        self._step.enable()

    def tick(self, u: FloatArray, tick: int) -> FloatArray:
        """One step, timed; then the arm moves. Returns the state that the step saw."""
        self._clock.wait_until((tick + 1) * self._step.dt_s)
        reading, given = self._arm.read(), Input(u)
        began = time.perf_counter()
        record = self._step(given, 0.0, reading, self._clock.now_s())
        self._took_s.append(time.perf_counter() - began)
        if record.command.stop is not None:
            raise RuntimeError(f"the timed arm was stopped: {record.command.stop.reason}")
        self._arm.send(record.command)
        return reading.q

    def median_us(self) -> float:
        """The median after the warm-up, µs."""
        return float(np.median(self._after_warm_up_us()))

    def rows(self, condition: str | None) -> list[Row]:
        """Median and 99th percentile after the warm-up."""
        took_us = self._after_warm_up_us()
        p99 = float(np.percentile(took_us, 99))
        return [
            _row("online_step_median_us", "us", self.median_us(), len(took_us), condition),
            _row("online_step_p99_us", "us", p99, len(took_us), condition),
        ]

    def _after_warm_up_us(self) -> FloatArray:
        return 1e6 * np.array(self._took_s[WARM_UP:])


def _led_back(task: TableTop, model: CVAE, rng: np.random.Generator) -> Decoder:
    """The model's decoder with an untrained way back: how long that takes does not depend on its weights."""
    trained, chain = model.trained_, task.robot.chain
    dimensions = replace(trained.dimensions, tools=len(chain.tools), way_back=HIDDEN)
    drawn = {
        name: np.abs(rng.normal(0.0, 0.05, shape))
        for name, shape in pull_shapes(dimensions, trained.layout).items()
    }
    tensors = {**trained.tensors, **chain_tensors(chain), **drawn}
    return Decoder(replace(trained, dimensions=dimensions, tensors=tensors))


def _many_goals(task: TableTop, seed: int) -> list[Goal]:
    """The task's goals and others around them."""
    rng = np.random.default_rng(seed)
    robot, goals = task.robot, list(task.goals)
    for number in range(len(goals), MANY_GOALS):
        near = task.goals[number % len(task.goals)].configuration + rng.normal(0, SPREAD_RAD, robot.dof)
        configuration = np.clip(near, robot.limits.lower, robot.limits.upper)
        goals.append(Goal(f"goal {number}", configuration, robot.chain.forward(configuration)))
    return goals


def _torch_decoder(model: CVAE, dof: int) -> Callable[[FloatArray, FloatArray], tuple[float, float]]:
    """``phi(u, c)`` in torch eager; a call returns how long all of it and its layers alone took, s.

    All of it is what the NumPy decoder does: scale the latent action, normalise the context, run the
    layers, scale the action. How long that takes does not depend on the figures. Making tensors of
    the input, which a loop in torch would have to do as well, is not timed.
    """
    import torch

    modules: list[torch.nn.Module] = []
    for inputs, outputs in pairwise((model.latent_dim + dof, *model.hidden, dof)):
        modules += [torch.nn.Linear(inputs, outputs), torch.nn.SiLU()]
    network = torch.nn.Sequential(*modules[:-1])
    latent_centre, latent_scale = torch.zeros(model.latent_dim), torch.ones(model.latent_dim)
    context_centre, context_scale = torch.zeros(dof), torch.ones(dof)
    action_scale = torch.ones(1)

    def timed(u: FloatArray, state: FloatArray) -> tuple[float, float]:
        z = torch.tensor(u, dtype=torch.float32)[None]
        context = torch.tensor(state, dtype=torch.float32)[None]
        with torch.no_grad():
            began = time.perf_counter()
            latent = latent_centre + latent_scale * z
            inputs = torch.cat([latent, (context - context_centre) / context_scale], dim=-1)
            layers_began = time.perf_counter()
            outputs = network(inputs)
            layers_ended = time.perf_counter()
            _ = action_scale * outputs
            return time.perf_counter() - began, layers_ended - layers_began

    return timed


def _time_fits(demonstrations: Demonstrations, seed: int, progress: bool) -> tuple[list[Row], CVAE]:
    """Ten seeds in one fit compared with the same ten in turn: the same pairs, steps and final losses.

    The joint fit runs before, between and after the ten single fits, and its median counts.
    """
    alone = [_model(1, seed + offset) for offset in range(SEEDS)]
    together = [_model(SEEDS, seed) for _ in range(3)]
    batched_s = [_fit_s(together[0], demonstrations, progress)]
    sequential_s = sum(_fit_s(model, demonstrations, progress) for model in alone[: SEEDS // 2])
    batched_s.append(_fit_s(together[1], demonstrations, progress))
    sequential_s += sum(_fit_s(model, demonstrations, progress) for model in alone[SEEDS // 2 :])
    batched_s.append(_fit_s(together[2], demonstrations, progress))
    batched = statistics.median(batched_s)
    loss = np.concatenate([model.validation_loss_ for model in alone])
    rows = [
        _row("batched_fit_s", "s", batched, len(batched_s)),
        _row("sequential_fit_s", "s", sequential_s, 1),
        _row("sequential_over_batched", "1", sequential_s / batched, 1),
        _loss_row("batched_fit_loss", together[0].validation_loss_),
        _loss_row("sequential_fit_loss", loss),
    ]
    return rows, together[0]


def _fit_s(model: CVAE, demonstrations: Demonstrations, progress: bool) -> float:
    """How long a fit takes, s."""
    began = time.perf_counter()
    with epoch_bar(progress) as report:
        model.fit(demonstrations, report=report)
    return time.perf_counter() - began


def _model(seeds: int, seed: int) -> CVAE:
    # With this patience nothing stops early: both ways take the same number of steps.
    return CVAE(seeds=seeds, seed=seed, data_seed=0, epochs=EPOCHS, patience=EPOCHS)


def _about(demonstrations: Demonstrations, count: int) -> Demonstrations:
    """Whole episodes with about this many context-action pairs left for training."""
    validation = CVAE.validation_fraction
    per_sample = 2 * CVAE.window
    kept: list[Episode] = []
    for episode in demonstrations.episodes:
        kept.append(episode)
        if len(kept) > 1 and sum(len(one.state) for one in kept) * per_sample * (1 - validation) >= count:
            break
    return replace(demonstrations, episodes=tuple(kept))


def _loss_row(measure: str, loss: FloatArray) -> Row:
    return Row("bench", measure, "1", float(loss.mean()), float(loss.std(ddof=1)), len(loss))


def _row(measure: str, unit: str, value: float, count: int, condition: str | None = None) -> Row:
    return Row("bench", measure, unit, value, None, count, condition=condition)
