"""A person's profile on disk."""

import hashlib
import json
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from safetensors.numpy import save

from latentarm.alignment.demonstrated_directions import DemonstratedDirections
from latentarm.alignment.meaning import Meaning
from latentarm.alignment.poses import pose_vectors
from latentarm.alignment.profile import (
    TRIAL,
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
from latentarm.alignment.tool_space import ToolSpace
from latentarm.assistance.controllers.latent import LatentController
from latentarm.core.errors import UserError
from latentarm.core.types import Context
from latentarm.models.saving import load_decoder
from latentarm.robots.planar import planar
from latentarm_research.alignment.training import FitConfig, fit_alignments

CONFIG = "profiles/ada/config.json"
TENSORS = "profiles/ada/alignment.safetensors"


@pytest.fixture(scope="module")
def known(arm, answered) -> ToolSpace:
    """Of a person with a stick that turns with the place."""
    answers, many = answered(4), answered(4, count=60, seed=1).motions
    place = pose_vectors(arm.chain, answers.motions.start)
    rng = np.random.default_rng(0)
    meaning = Meaning(rng.normal(size=(2, 6)), place, rng.normal(size=len(place)), 0.7)
    return ToolSpace(meaning, DemonstratedDirections.of_motions(many, arm.chain, 2), 0.5)


@pytest.fixture
def run(tmp_path, curved_model, known) -> Path:
    """A saved model, and ada's profile of its seed 1."""
    folder = tmp_path / "run"
    curved_model.save(folder)
    keep(folder, known, "ada")
    return folder


def keep(run, known, name):
    folder = trial_folder(run) if name == TRIAL else new_profile_folder(run, name)
    save_profile(known, model_fingerprint(run, 1), 1, folder, {"person": "simulated"})


def test_a_profile_survives_to_the_last_bit(run, known, curved_model, arm):
    profile = load_profile(run, "ada")
    assert profile.seed_index == 1
    alignments = [one.with_arm(curved_model.decoder(1), arm.chain) for one in (profile.known, known)]
    rng = np.random.default_rng(0)
    u, context = rng.uniform(-1, 1, (20, 2)), rng.uniform(-1, 1, (20, 4))
    np.testing.assert_array_equal(*(alignment(u, context) for alignment in alignments))
    assert json.loads((run / CONFIG).read_text())["person"] == "simulated"


def test_a_profile_stands_between_the_stick_and_the_decoder(run, arm):
    decoder = load_decoder(run, 1)
    alignment = load_profile(run, "ada").alignment(decoder, arm.chain)
    controller = LatentController(decoder, alignment)
    context, u = Context(np.full(4, 0.1), np.empty(0)), np.array([0.5, -1.0])
    z = controller.latent(u, context, 0)
    np.testing.assert_array_equal(z, alignment(u, context.state))
    many = controller.latent(np.stack([u, -u, 0 * u]), context, 0)
    np.testing.assert_allclose(many[0], z, rtol=0, atol=1e-9)


def test_a_profile_for_another_arm_is_refused(run):
    with pytest.raises(UserError, match="align the person again"):
        load_profile(run, "ada").alignment(load_decoder(run, 1), planar(3).chain)


def test_a_profile_of_an_older_version_is_still_read(run, curved_model, arm, answered):
    """Schema 1 held a network."""
    answers = answered(4)
    config = FitConfig(hidden=(8, 8), steps=2)
    (network,) = fit_alignments(curved_model, arm.chain, [answers], answers.motions.context, config)
    content = save({name: np.ascontiguousarray(array) for name, array in network.tensors.items()})
    (run / TENSORS).write_bytes(content)
    sizes = {"latent": 2, "context": 4, "hidden": [8, 8], "sha256": hashlib.sha256(content).hexdigest()}
    change(run / CONFIG, lambda section: section.update(schema=1, **sizes))
    alignment = load_profile(run, "ada").alignment(load_decoder(run, 1), arm.chain)
    u, context = np.array([0.5, -1.0]), np.full(4, 0.1)
    np.testing.assert_array_equal(alignment(u, context), network(u, context))


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
        (lambda section: section.update(answers=6), "bytes"),
        (lambda section: section.update(latent=3), "bytes"),
        (lambda section: section.update(regions=10**9), "too large"),
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


@pytest.mark.parametrize("name", ["", ".", "..", " ", "-", "x" * 65, "ada\n", "a\0b", "\u202egnp"])
def test_what_is_no_name_is_refused(run, name):
    for use in (load_profile, new_profile_folder, profile_folder):
        with pytest.raises(UserError, match="name"):
            use(run, name)


@pytest.mark.parametrize("name", ["Zoë Müller", "李 雷", "../ada", "a/b", "C:\\x", "-x", "名前" * 32])
def test_any_name_has_a_profile_of_its_own(run, known, name):
    folder = new_profile_folder(run, name)
    assert folder.parent == run / "profiles"
    save_profile(known, model_fingerprint(run, 1), 1, folder, {"name": name})
    assert load_profile(run, name).seed_index == 1
    assert profile_names(run).count(name) == 1


def test_a_profile_is_not_overwritten(run, known):
    with pytest.raises(UserError, match="not empty"):
        new_profile_folder(run, "ada")
    before = (run / TENSORS).read_bytes()
    with pytest.raises(UserError):
        save_profile(known, "", 1, run / "profiles" / "ada", {})
    assert (run / TENSORS).read_bytes() == before


def test_there_is_no_such_profile(run):
    with pytest.raises(UserError, match=r"latentarm align .* --name bob"):
        load_profile(run, "bob")


def test_a_profile_that_cannot_be_written_leaves_nothing(run, known):
    with pytest.raises(TypeError):
        save_profile(known, "", 1, new_profile_folder(run, "bob"), {"what JSON does not know": object()})
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
def tried(run, known) -> Path:
    """The run, with a profile that is tried."""
    keep(run, known, TRIAL)
    return run


def test_what_is_tried_is_nobody_s_until_it_is_kept(tried):
    assert profile_names(tried) == ("ada",)
    assert load_profile(tried, TRIAL).seed_index == 1
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


@pytest.mark.parametrize("name", ["ada", TRIAL, "..", ""])
def test_a_name_that_is_taken_or_none_keeps_nothing(tried, name):
    with pytest.raises(UserError):
        keep_trial(tried, name)
    assert trial_folder(tried).exists()


def test_there_may_be_nothing_to_keep(run):
    with pytest.raises(UserError, match="cannot be written"):
        keep_trial(run, "bob")
    assert profile_names(run) == ("ada",)
