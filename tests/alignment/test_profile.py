"""A person's profile on disk."""

import json
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from latentarm.alignment.profile import (
    TRIAL,
    Profile,
    discard_trial,
    keep_trial,
    load_profile,
    model_fingerprint,
    new_profile_folder,
    profile_folder,
    profile_names,
    save_profile,
    trial_folder,
)
from latentarm.alignment.runtime import LearnedAlignment
from latentarm.alignment.training import FitConfig, fit_alignments
from latentarm.controllers.latent import LatentController
from latentarm.errors import UserError
from latentarm.models.saving import load_decoder
from latentarm.types import Context

CONFIG = "profiles/ada/config.json"
TENSORS = "profiles/ada/alignment.safetensors"


@pytest.fixture(scope="module")
def alignment(curved_model, arm, answered) -> LearnedAlignment:
    answers = answered(4)
    config = FitConfig(hidden=(8, 8), steps=5)
    return fit_alignments(curved_model, arm.chain, [answers], answers.motions.context, config).best


@pytest.fixture
def run(tmp_path, curved_model, alignment) -> Path:
    """A saved model, and ada's profile of its seed 1."""
    folder = tmp_path / "run"
    curved_model.save(folder)
    profile = Profile(alignment, model_fingerprint(folder, 1), seed_index=1)
    save_profile(profile, new_profile_folder(folder, "ada"), {"person": "simulated"})
    return folder


def test_a_profile_survives_to_the_last_bit(run, alignment):
    profile = load_profile(run, "ada")
    assert profile.seed_index == 1
    assert profile.alignment.tensors.keys() == alignment.tensors.keys()
    for name, array in alignment.tensors.items():
        assert profile.alignment.tensors[name].tobytes() == array.tobytes()
    rng = np.random.default_rng(0)
    u, context = rng.uniform(-1, 1, (20, 2)), rng.uniform(-1, 1, (20, 4))
    np.testing.assert_array_equal(profile(u, context), alignment(u, context))
    assert json.loads((run / CONFIG).read_text())["person"] == "simulated"


def test_a_profile_stands_between_the_stick_and_the_decoder(run):
    profile, decoder = load_profile(run, "ada"), load_decoder(run, 1)
    controller = LatentController(decoder, profile)
    context, u = Context(np.full(4, 0.1), np.empty(0)), np.array([0.5, -1.0])
    z = controller.latent(u, context, 0)
    np.testing.assert_array_equal(z, profile.alignment(u, context.state))
    np.testing.assert_array_equal(
        controller.action(z, context, 0), decoder.decode(profile(u, context.state), context.state)
    )
    many = controller.latent(np.stack([u, -u, 0 * u]), context, 0)
    np.testing.assert_allclose(many[0], z, rtol=0, atol=1e-12)


def test_the_profile_of_another_model_is_refused(run, curved_model, swings):
    replace(curved_model, seed=5).fit(swings).save(run)
    with pytest.raises(UserError, match=r"'ada' was learned for another model than .*run"):
        load_profile(run, "ada")


def test_the_fingerprint_knows_the_seed(run):
    assert model_fingerprint(run, 0) != model_fingerprint(run, 1)
    change(run / CONFIG, lambda section: section.update(seed_index=0))
    with pytest.raises(UserError, match="another model"):
        load_profile(run, "ada")


def change(path, how):
    document = json.loads(path.read_text())
    how(document["profile"])
    path.write_text(json.dumps(document))


@pytest.mark.parametrize(
    ("how", "said"),
    [
        (lambda section: section.update(schema=99), "schema 99"),
        (lambda section: section.pop("fingerprint"), "fingerprint"),
        (lambda section: section.update(seed_index=-1), "seed_index"),
        (lambda section: section.update(hidden=[9, 8]), "bytes"),
        (lambda section: section.update(latent=3), "bytes"),
        (lambda section: section.update(hidden=[10**9, 10**9]), "bytes of weights"),
        (lambda section: section.update(sha256="0" * 64), "SHA-256"),
    ],
)
def test_a_changed_config_is_refused(run, how, said):
    change(run / CONFIG, how)
    with pytest.raises(UserError, match=said):
        load_profile(run, "ada")


def test_damaged_files_are_refused(run):
    whole = (run / TENSORS).read_bytes()
    for content in (b"", whole[:-1], whole[:-1] + b"x", b"\x80\x04pickle"):
        (run / TENSORS).write_bytes(content)
        with pytest.raises(UserError, match=r"alignment\.safetensors"):
            load_profile(run, "ada")
    (run / TENSORS).unlink()
    with pytest.raises(UserError, match="cannot be read"):
        load_profile(run, "ada")
    (run / CONFIG).write_text("{")
    with pytest.raises(UserError, match="not a JSON document"):
        load_profile(run, "ada")


@pytest.mark.parametrize("name", ["", ".", "..", "a/b", "../ada", "-x", "a b", "x" * 65, "ada\n"])
def test_a_name_that_is_no_folders_is_refused(run, name):
    for use in (load_profile, new_profile_folder, profile_folder):
        with pytest.raises(UserError, match="is not a profile name"):
            use(run, name)


def test_a_profile_is_not_overwritten(run):
    with pytest.raises(UserError, match="not empty"):
        new_profile_folder(run, "ada")
    profile = load_profile(run, "ada")
    before = (run / TENSORS).read_bytes()
    with pytest.raises(UserError):
        save_profile(profile, run / "profiles" / "ada", {})
    assert (run / TENSORS).read_bytes() == before


def test_there_is_no_such_profile(run):
    with pytest.raises(UserError, match=r"latentarm align .* --name bob"):
        load_profile(run, "bob")


def test_a_profile_that_cannot_be_written_leaves_nothing(run):
    profile = load_profile(run, "ada")
    with pytest.raises(TypeError):
        save_profile(profile, new_profile_folder(run, "bob"), {"what JSON does not know": object()})
    assert [path.name for path in (run / "profiles").iterdir()] == ["ada"]


def test_a_profile_needs_no_torch(run):
    code = (
        "import sys; from pathlib import Path; from latentarm.alignment.profile import load_profile;"
        f"load_profile(Path({str(run)!r}), 'ada');"
        "print([name for name in ('torch', 'mujoco', 'scipy', 'pyarrow') if name in sys.modules])"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"


@pytest.fixture
def tried(run, alignment) -> Path:
    """The run, with a profile that is tried."""
    profile = Profile(alignment, model_fingerprint(run, 1), seed_index=1)
    save_profile(profile, trial_folder(run), {"person": "simulated"})
    return run


def test_what_is_tried_is_nobody_s_until_it_is_kept(tried, alignment):
    assert profile_names(tried) == ("ada",)
    assert load_profile(tried, TRIAL).alignment.latent_dim == alignment.latent_dim
    keep_trial(tried, "bob")
    assert profile_names(tried) == ("ada", "bob")
    assert load_profile(tried, "bob").seed_index == 1
    with pytest.raises(UserError, match="no profile"):
        load_profile(tried, TRIAL)


def test_what_is_discarded_is_gone(tried):
    discard_trial(tried)
    discard_trial(tried)
    assert not trial_folder(tried).exists()
    assert profile_names(tried) == ("ada",)


@pytest.mark.parametrize("name", ["ada", TRIAL, "..", "a b", ""])
def test_a_name_that_is_taken_or_none_keeps_nothing(tried, name):
    with pytest.raises(UserError):
        keep_trial(tried, name)
    assert trial_folder(tried).exists()


def test_there_may_be_nothing_to_keep(run):
    with pytest.raises(UserError, match="cannot be written"):
        keep_trial(run, "bob")
    assert profile_names(run) == ("ada",)
