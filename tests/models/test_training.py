"""The training loop: many seeds as one, stopping, and going on after a kill."""

import json
import math
import pickle
import resource
import signal
import subprocess
import sys
import time
from dataclasses import replace

import numpy as np
import pytest
import torch
from torch.optim.adam import adam

from latentarm.core.errors import UserError
from latentarm.models import training
from latentarm.models.batches import seed_generator
from latentarm.models.checkpoint import TrainingState
from latentarm.models.estimators import MODELS
from latentarm.models.optimiser import FlatAdam
from latentarm.models.replay import RecordedStep
from latentarm.models.training import epoch_bar

NEURAL = [name for name in MODELS if name != "pca"]
SMALL = {"epochs": 2, "hidden": (8, 8), "window": 2}


@pytest.mark.usefixtures("double_precision")
@pytest.mark.parametrize("name", NEURAL)
def test_a_seeds_result_depends_neither_on_the_seeds_beside_it_nor_on_replays(
    name, few, samples, monkeypatch
):
    context, z = samples
    alone = MODELS[name](seeds=1, seed=13, **SMALL).fit(few)
    replayed, replay = [], RecordedStep.__call__
    monkeypatch.setattr(training, "REPLAYED_STEPS", 0)
    monkeypatch.setattr(RecordedStep, "__call__", lambda self: (replayed.append(self), replay(self)))
    together = MODELS[name](seeds=5, seed=10, **SMALL).fit(few)
    assert len(replayed) > 1, "no step was replayed"
    np.testing.assert_allclose(alone.decode(z, context)[0], together.decode(z, context)[3], rtol=0, atol=1e-9)
    np.testing.assert_allclose(alone.validation_loss_[0], together.validation_loss_[3], rtol=1e-9)


@pytest.mark.usefixtures("double_precision")
def test_a_seed_that_stalls_early_is_not_changed_by_those_that_go_on(demonstrations, samples):
    settings = {"epochs": 25, "hidden": (8,), "window": 1, "patience": 1, "learning_rate": 0.1}
    context, z = samples
    together = MODELS["cae"](seeds=4, **settings).fit(demonstrations)
    ends = []
    for seed in range(4):
        alone = MODELS["cae"](seeds=1, seed=seed, **settings).fit(demonstrations)
        np.testing.assert_allclose(
            alone.decode(z, context)[0], together.decode(z, context)[seed], rtol=0, atol=1e-9
        )
        ends.append(len(alone.history_))
    assert len(set(ends)) > 1, "the seeds should stall at different epochs for this test to say anything"
    assert len(together.history_) == max(ends) < settings["epochs"]


def test_training_lowers_the_loss_and_keeps_the_best_epoch(demonstrations):
    model = MODELS["cvae"](seeds=3, epochs=15, hidden=(16, 16), window=2).fit(demonstrations)
    np.testing.assert_array_equal(model.validation_loss_, model.history_.min(axis=0))
    np.testing.assert_array_equal(model.trained_.summary.best_epoch, model.history_.argmin(axis=0) + 1)
    assert (model.validation_loss_ < 0.7 * model.history_[0]).all()


class KilledError(Exception):
    pass


@pytest.mark.parametrize("name", ["cvae", "homogeneous"])  # noise; a start and a look ahead
def test_resuming_gives_what_an_uninterrupted_training_gives(name, few, samples, tmp_path, monkeypatch):
    context, z = samples
    settings = {**SMALL, "epochs": 3, "seeds": 2, "checkpoint_interval_s": 0.0}
    whole = MODELS[name](**settings).fit(few)
    path = tmp_path / "checkpoint.safetensors"
    write, calls = training.write_checkpoint, []

    def write_then_die(*arguments):
        write(*arguments)
        calls.append(1)
        if len(calls) == 2:
            raise KilledError

    with monkeypatch.context() as patch:
        patch.setattr(training, "write_checkpoint", write_then_die)
        with pytest.raises(KilledError):
            MODELS[name](**settings).fit(few, checkpoint=path)
    resumed = MODELS[name](**settings).fit(few, checkpoint=path)
    np.testing.assert_array_equal(resumed.decode(z, context), whole.decode(z, context))
    np.testing.assert_array_equal(resumed.history_, whole.history_)


def test_a_finished_training_is_not_run_again(few, tmp_path, monkeypatch):
    path = tmp_path / "checkpoint.safetensors"
    first = MODELS["cae"](**SMALL).fit(few, checkpoint=path)
    monkeypatch.setattr(FlatAdam, "step", lambda *_: pytest.fail("stepped"))
    again = MODELS["cae"](**SMALL).fit(few, checkpoint=path)
    np.testing.assert_array_equal(first.validation_loss_, again.validation_loss_)


KILLED_SCRIPT = """
import pickle, sys, time
from pathlib import Path
import torch
torch.set_num_threads(1)
from latentarm.models.estimators import MODELS
demonstrations = pickle.load(sys.stdin.buffer)
# A moment between epochs: it must not be over before it is killed.
MODELS["cvae"](epochs={epochs}, hidden=(8, 8), window=2, checkpoint_interval_s=0.0, patience=1000).fit(
    demonstrations, report=lambda *_: time.sleep(0.1), checkpoint=Path(sys.argv[1]))
"""


def test_a_training_killed_outright_goes_on(few, samples, tmp_path):
    context, z = samples
    epochs = 8
    path = tmp_path / "checkpoint.safetensors"
    script = KILLED_SCRIPT.format(epochs=epochs)
    process = subprocess.Popen([sys.executable, "-c", script, str(path)], stdin=subprocess.PIPE)
    with process.stdin as given:
        given.write(pickle.dumps(few))
    deadline = time.monotonic() + 60
    while not path.exists() and process.poll() is None and time.monotonic() < deadline:
        time.sleep(0.002)
    process.send_signal(signal.SIGKILL)
    assert process.wait() == -signal.SIGKILL, "it was over before it could be killed"
    settings = {"epochs": epochs, "hidden": (8, 8), "window": 2, "patience": 1000}
    resumed = MODELS["cvae"](**settings).fit(few, checkpoint=path)
    whole = MODELS["cvae"](**settings).fit(few)
    np.testing.assert_array_equal(resumed.decode(z, context), whole.decode(z, context))


@pytest.mark.parametrize(
    "change", [{"seed": 1}, {"learning_rate": 1e-3}, {"hidden": (8, 7)}, {"data_seed": 1}]
)
def test_the_checkpoint_of_another_training_is_refused(few, tmp_path, change):
    path = tmp_path / "checkpoint.safetensors"
    MODELS["cae"](**SMALL).fit(few, checkpoint=path)
    with pytest.raises(UserError, match="checkpoint of another training"):
        MODELS["cae"](**{**SMALL, **change}).fit(few, checkpoint=path)


@pytest.mark.parametrize("content", [b"", b"not a checkpoint", b"\xff" * 100])
def test_a_broken_checkpoint_is_refused(few, tmp_path, content):
    path = tmp_path / "checkpoint.safetensors"
    path.write_bytes(content)
    with pytest.raises(UserError, match="not a whole training checkpoint"):
        MODELS["cae"](**SMALL).fit(few, checkpoint=path)


def test_a_truncated_checkpoint_is_refused(few, tmp_path):
    path = tmp_path / "checkpoint.safetensors"
    MODELS["cae"](**SMALL).fit(few, checkpoint=path)
    path.write_bytes(path.read_bytes()[:-100])
    with pytest.raises(UserError, match="not a whole training checkpoint"):
        MODELS["cae"](**SMALL).fit(few, checkpoint=path)


def test_divergence_is_said(few):
    with pytest.raises(UserError, match="diverged for seed 0"):
        MODELS["ae"](**{**SMALL, "learning_rate": 1e30}).fit(few)


@pytest.mark.skipif(not torch.cuda.is_available(), reason="this machine has no CUDA")
@pytest.mark.parametrize("name", ["cvae", "homogeneous"])
def test_on_cuda_the_losses_are_those_of_the_cpu(name, demonstrations):
    settings = {"epochs": 8, "hidden": (8, 8), "window": 2, "seeds": 3}
    reference = MODELS[name](**settings).fit(demonstrations)
    first, again = (MODELS[name](**settings, device="cuda").fit(demonstrations) for _ in range(2))
    np.testing.assert_allclose(first.history_[0], reference.history_[0], rtol=1e-3)
    np.testing.assert_allclose(first.validation_loss_, reference.validation_loss_, rtol=0.1)
    np.testing.assert_allclose(first.history_, again.history_, rtol=1e-3)


@pytest.mark.skipif(torch.cuda.is_available(), reason="this machine has CUDA")
def test_cuda_without_cuda_is_said_and_auto_takes_the_cpu(few):
    with pytest.raises(UserError, match="no CUDA on this machine"):
        MODELS["cae"](**SMALL, device="cuda").fit(few)
    MODELS["cae"](**SMALL, device="auto").fit(few)


def test_the_number_of_threads_is_as_before(few):
    torch.set_num_threads(2)
    try:
        MODELS["cae"](**SMALL).fit(few)
        assert torch.get_num_threads() == 2
    finally:
        torch.set_num_threads(1)


def test_the_progress_bar_stays_off_standard_output(few, capsys):
    with epoch_bar(True) as report:
        MODELS["cae"](**SMALL).fit(few, report=report)
    assert capsys.readouterr().out == ""


def test_every_epoch_is_reported(few):
    heard = []
    model = MODELS["cae"](**SMALL).fit(few, report=lambda *said: heard.append(said))
    epochs, best = len(model.trained_.summary.history), model.validation_loss_.mean()
    assert [epoch for epoch, _, _ in heard] == list(range(epochs + 1))
    assert {most for _, most, _ in heard} == {model.epochs}
    assert heard[0][2] == math.inf
    assert heard[-1][2] == pytest.approx(best)


def test_adam_is_torchs_adam():
    generator = torch.Generator().manual_seed(0)
    ours = torch.randn(3, 7, generator=generator)
    theirs, first, second = ours.clone(), torch.zeros(3, 7), torch.zeros(3, 7)
    ahead, steps = FlatAdam(ours), torch.zeros(())
    for rate in map(float, np.linspace(0.02, 0.001, 50)):
        gradient = torch.randn(3, 7, generator=generator)
        # The function of torch.optim.Adam, whose class imports torch's compiler, which takes seconds.
        adam(
            [theirs],
            [gradient],
            [first],
            [second],
            [],
            [steps],
            foreach=False,
            amsgrad=False,
            beta1=0.9,
            beta2=0.999,
            lr=rate,
            weight_decay=0.0,
            eps=1e-8,
            maximize=False,
        )
        ahead.step(ours, gradient, rate)
    np.testing.assert_allclose(ours, theirs, rtol=1.3e-6, atol=1e-5)


def test_epochs_of_one_seed_are_shuffled_differently_and_reproducibly():
    first, again, other = (seed_generator(5, epoch) for epoch in (1, 1, 2))
    order = torch.randperm(100, generator=first)
    assert torch.equal(order, torch.randperm(100, generator=again))
    assert not torch.equal(order, torch.randperm(100, generator=other))


def test_the_checkpoint_holds_no_pickle(few, tmp_path):
    path = tmp_path / "checkpoint.safetensors"
    MODELS["cae"](**SMALL).fit(few, checkpoint=path)
    content = path.read_bytes()
    header = json.loads(content[8 : 8 + int.from_bytes(content[:8], "little")])
    assert set(header) == {"__metadata__", "values", "first", "second", "best"}
    assert [entry.name for entry in tmp_path.iterdir()] == ["checkpoint.safetensors"]


def test_a_full_disk_under_a_checkpoint_is_said_in_one_sentence(few, tmp_path):
    path = tmp_path / "checkpoint.safetensors"
    limits = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (1024, limits[1]))
    try:
        with pytest.raises(UserError, match=r"checkpoint\.safetensors cannot be written: File too large"):
            MODELS["cae"](**SMALL).fit(few, checkpoint=path)
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, limits)
    assert not list(tmp_path.iterdir())


def test_seeds_that_could_not_be_loaded_or_held_in_memory_are_refused(few):
    last = 2**31 - 1
    assert MODELS["pca"](seed=last, seeds=1).fit(few).seed_numbers == (last,)
    with pytest.raises(UserError, match="2 seeds from 2147483647 on end beyond"):
        MODELS["pca"](seed=last, seeds=2).fit(few)
    with pytest.raises(UserError, match="seeds is 1001; it must be less than or equal to 1000"):
        MODELS["pca"](seeds=1001).fit(few)


def test_pairs_that_cannot_span_the_latent_space_are_refused(demonstrations):
    short = [replace(one, **_first(one, 2)) for one in demonstrations.episodes[:2]]
    few = replace(demonstrations, episodes=tuple(short))
    with pytest.raises(UserError, match="2 context-action pairs do not span 3 latent dimensions"):
        MODELS["pca"](latent_dim=3, window=1).fit(few)


def test_recorded_actions_that_are_all_zero_are_refused(few):
    still = tuple(replace(one, action=np.zeros_like(one.state)) for one in few.episodes)
    with pytest.raises(UserError, match="Every recorded action is zero"):
        MODELS["pca"](actions="recorded").fit(replace(few, episodes=still))


def test_a_seed_stops_after_exactly_so_many_epochs_without_improvement(demonstrations):
    settings = {"epochs": 40, "hidden": (8,), "window": 1, "learning_rate": 0.1}
    for patience in (1, 3):
        model = MODELS["cae"](patience=patience, **settings).fit(demonstrations)
        assert len(model.history_) < settings["epochs"], "it should stall for this test to say anything"
        assert len(model.history_) == model.trained_.summary.best_epoch[0] + patience


def test_a_stalled_seed_takes_no_later_improvement():
    """Alone, its training would have ended there; the other seed's goes on."""
    values = torch.arange(2.0)[:, None].clone()
    state = TrainingState.start(values, FlatAdam(values))
    for epoch, loss in enumerate(([1.0, 1.0], [2.0, 0.9], [2.0, 0.8], [0.5, 0.7])):
        values[:] = 10.0 * (epoch + 1)
        state.record(np.array(loss), steps=epoch, patience=2)
    assert state.best_loss.tolist() == [1.0, 0.7]
    assert state.best_epoch.tolist() == [1, 4]
    assert state.best.ravel().tolist() == [10.0, 40.0]


def test_the_learning_rate_falls_along_half_a_cosine(few, monkeypatch):
    rates = []
    step = FlatAdam.step

    def watched(self, values, gradient, learning_rate):
        rates.append(learning_rate)
        step(self, values, gradient, learning_rate)

    monkeypatch.setattr(FlatAdam, "step", watched)
    MODELS["cae"](epochs=4, hidden=(8,), window=1, learning_rate=0.01).fit(few)
    per_epoch = list(dict.fromkeys(rates))
    share = (1 + np.cos(np.pi * np.arange(4) / 4)) / 2
    np.testing.assert_allclose(per_epoch, 0.01 * (0.01 + 0.99 * share))


def _first(episode, samples):
    """Fields of an episode cut to its first samples."""
    return {
        "state": episode.state[:samples],
        "timestamp": episode.timestamp[:samples],
        "extras": {name: values[:samples] for name, values in episode.extras.items()},
    }


@pytest.mark.usefixtures("double_precision")
@pytest.mark.parametrize("name", ["cvae", "homogeneous"])  # noise; a start and a look ahead
def test_seeds_with_demonstrations_of_their_own_learn_what_each_learns_alone(name, few, samples):
    context, z = samples
    shown = [few, replace(few, episodes=few.episodes[::-1])]
    together = MODELS[name](seeds=2, seed=7, **SMALL).fit_each(shown, validation=[0])
    for seed, (one, own) in enumerate(zip(together, shown, strict=True), 7):
        alone = MODELS[name](seeds=1, seed=seed, **SMALL).fit(own, validation=[0])
        np.testing.assert_allclose(one.decode(z, context), alone.decode(z, context), rtol=0, atol=1e-9)
    with pytest.raises(UserError, match="1 data sets for 2 seeds"):
        MODELS[name](seeds=2, **SMALL).fit_each(shown[:1])
