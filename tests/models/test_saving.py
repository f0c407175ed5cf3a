"""A saved model is believed only after it has been checked; each fault has its own sentence."""

import hashlib
import json
import subprocess
import sys
from dataclasses import replace

import numpy as np
import pytest
from safetensors.numpy import load, save

from latentarm.core.errors import UserError
from latentarm.models.estimators import MODELS, load_model
from latentarm.models.saving import load_decoder, write_model

CONFIG, WEIGHTS = "config.json", "model.safetensors"


@pytest.fixture(scope="module")
def fitted(demonstrations):
    return MODELS["cvae"](seeds=2, epochs=1, hidden=(8,), window=1).fit(demonstrations)


@pytest.fixture
def folder(fitted, tmp_path):
    fitted.save(tmp_path, run={"dataset": "ring"})
    return tmp_path


def change_config(folder, change):
    path = folder / CONFIG
    config = json.loads(path.read_text())
    change(config["model"])
    path.write_text(json.dumps(config))


def change_tensors(folder, change):
    """Alter the weights and make the config agree with the altered file."""
    tensors = load((folder / WEIGHTS).read_bytes())
    change(tensors)
    content = save(tensors)
    (folder / WEIGHTS).write_bytes(content)
    change_config(folder, lambda model: model.update(sha256=hashlib.sha256(content).hexdigest()))


def put(name, value):
    return lambda entries: entries.update({name: value})


def put_in(section, name, value):
    return lambda entries: entries[section].update({name: value})


def poisoned(value):
    def change(tensors):
        tensors["encoder.0.weight"][1, 2, 3] = value

    return change


def not_positive(tensors):
    tensors["context.scale"][1] = 0.0


def renamed(tensors):
    tensors["decoder.9.bias"] = tensors.pop("decoder.1.bias")


def transposed(tensors):
    tensors["decoder.1.weight"] = np.ascontiguousarray(tensors["decoder.1.weight"].transpose(0, 2, 1))


def retyped(tensors):
    tensors["decoder.1.weight"] = tensors["decoder.1.weight"].view(np.int64)


FAULTS = {
    "no config": (lambda folder: (folder / CONFIG).unlink(), "config.json cannot be read"),
    "config is not JSON": (lambda folder: (folder / CONFIG).write_text("{"), "is not a JSON document"),
    "config is not text": (
        lambda folder: (folder / CONFIG).write_bytes(b"\xff\xfe\x00"),
        "is not a JSON document",
    ),
    "config is a list": (lambda folder: (folder / CONFIG).write_text("[1]"), "not an object"),
    "config nests without end": (
        lambda folder: (folder / CONFIG).write_text("[" * 100_000),
        "is nested deeper",
    ),
    "config of something else": (lambda folder: (folder / CONFIG).write_text('{"a": 1}'), "has no 'model'"),
    "config is huge": (
        lambda folder: (folder / CONFIG).write_text(" " * (17 * 2**20)),
        "is too large",
    ),
    "another schema": (lambda folder: change_config(folder, put("schema", 1)), "has schema 1"),
    "no schema": (lambda folder: change_config(folder, lambda model: model.pop("schema")), "has no 'schema'"),
    "unknown kind": (lambda folder: change_config(folder, put("kind", "gan")), "names the model 'gan'"),
    "another kind": (lambda folder: change_config(folder, put("kind", "vae")), "is not what its config.json"),
    "negative size": (
        lambda folder: change_config(folder, put_in("dimensions", "seeds", -1)),
        "'seeds' must be a whole number",
    ),
    "absurd size": (
        lambda folder: change_config(folder, put_in("dimensions", "hidden", [2**30])),
        "asks for",
    ),
    "another context": (
        lambda folder: change_config(folder, put_in("dimensions", "context", 5)),
        "its features have 4 entries, and its contexts 5",
    ),
    "unknown feature": (
        lambda folder: change_config(folder, put_in("layout", "features", ["joints", "mood"])),
        "no feature 'mood'",
    ),
    "no tool": (
        lambda folder: change_config(folder, put_in("layout", "features", ["joints", "objects_in_tool"])),
        "need an arm with a tool",
    ),
    "hidden is no list": (
        lambda folder: change_config(folder, put_in("dimensions", "hidden", 8)),
        "'hidden' must be a list",
    ),
    "loss is NaN": (
        lambda folder: change_config(folder, put_in("training", "validation_loss", [float("nan"), 1.0])),
        "holds NaN",
    ),
    "collapsed has another shape": (
        lambda folder: change_config(folder, put("collapsed", [[False]])),
        "'collapsed' must be",
    ),
    "no weights": (lambda folder: (folder / WEIGHTS).unlink(), "model.safetensors cannot be read"),
    "truncated weights": (
        lambda folder: (folder / WEIGHTS).write_bytes((folder / WEIGHTS).read_bytes()[:-1]),
        "is not what its config.json describes",
    ),
    "empty weights": (
        lambda folder: (folder / WEIGHTS).write_bytes(b""),
        "is not what its config.json describes",
    ),
    "huge header": (
        lambda folder: (folder / WEIGHTS).write_bytes(b"\xff" * 8 + (folder / WEIGHTS).read_bytes()[8:]),
        "is not what its config.json describes",
    ),
    "one bit flipped": (
        lambda folder: (folder / WEIGHTS).write_bytes(
            (content := (folder / WEIGHTS).read_bytes())[:-1] + bytes([content[-1] ^ 1])
        ),
        "does not have the SHA-256",
    ),
    "NaN weight": (lambda folder: change_tensors(folder, poisoned(np.nan)), "NaN or an infinity"),
    "infinite weight": (lambda folder: change_tensors(folder, poisoned(np.inf)), "NaN or an infinity"),
    "scale of zero": (lambda folder: change_tensors(folder, not_positive), "not positive"),
    "renamed tensor": (lambda folder: change_tensors(folder, renamed), "lacks tensor 'decoder.1.bias'"),
    "transposed tensor": (lambda folder: change_tensors(folder, transposed), "'decoder.1.weight' is float64"),
    "retyped tensor": (lambda folder: change_tensors(folder, retyped), "'decoder.1.weight' is int64"),
}


@pytest.mark.parametrize("reader", [load_model, load_decoder])
@pytest.mark.parametrize("fault", list(FAULTS))
def test_a_fault_is_refused_in_one_sentence(folder, fault, reader):
    inflict, message = FAULTS[fault]
    inflict(folder)
    before = sorted(entry.name for entry in folder.iterdir())
    with pytest.raises(UserError, match=message) as caught:
        reader(folder)
    sentence = str(caught.value)
    assert "\n" not in sentence
    assert str(folder) in sentence
    assert sorted(entry.name for entry in folder.iterdir()) == before


@pytest.mark.parametrize(
    ("name", "value", "message"),
    [
        ("epochs", -1, "parameter epochs is -1"),
        ("hidden", "wide", "parameter hidden"),
        ("surprise", 1, "unknown parameter 'surprise'"),
        ("latent_dim", 3, "contradicts itself"),
        ("seeds", 7, "contradicts itself"),
    ],
)
def test_parameters_that_were_tampered_with_are_refused(folder, name, value, message):
    change_config(folder, put_in("parameters", name, value))
    with pytest.raises(UserError, match=message):
        load_model(folder)


def test_a_missing_parameter_is_refused(folder):
    change_config(folder, lambda model: model["parameters"].pop("window"))
    with pytest.raises(UserError, match="lacks the parameter 'window'"):
        load_model(folder)


def test_a_model_of_schema_2_loads(folder, fitted, samples):
    """It called the validation episodes held-out ones."""

    def age(model):
        model["schema"] = 2
        del model["layout"]
        model["parameters"]["context"] = "state"
        model["parameters"]["held_out_fraction"] = model["parameters"].pop("validation_fraction")
        model["parameters"]["checkpoint_interval_s"] = 5.0
        for new in ("validation_episodes", "validation_loss"):
            model["training"][new.replace("validation", "held_out")] = model["training"].pop(new)

    change_config(folder, age)
    context, z = samples
    loaded = load_model(folder)
    np.testing.assert_array_equal(loaded.decode(z, context), fitted.decode(z, context))
    assert {**loaded.get_params(), "context": ("joints",)} == fitted.get_params()
    assert loaded.validation_episodes_ == fitted.validation_episodes_
    np.testing.assert_array_equal(loaded.validation_loss_, fitted.validation_loss_)


def test_a_model_whose_plug_in_is_missing_says_what_to_install(folder):
    change_config(folder, lambda model: model.update(kind="theirs", distribution="their-models"))
    for load_it in (load_model, load_decoder):
        with pytest.raises(UserError, match=r"'theirs' of the distribution their-models.*pip install their"):
            load_it(folder)


@pytest.mark.parametrize("kind", ["os:system", "latentarm.models.pca.runtime:PCA", "../pca", ""])
def test_a_config_cannot_name_what_is_imported(folder, kind):
    change_config(folder, lambda model: model.update(kind=kind, distribution="--index-url=x"))
    with pytest.raises(UserError, match="which is not one of pca, ae, vae"):
        load_model(folder)


def test_the_config_says_what_was_done(folder, fitted):
    config = json.loads((folder / CONFIG).read_text())
    assert config["dataset"] == "ring"
    model = config["model"]
    assert model["kind"] == "cvae"
    assert model["seeds"] == [0, 1]
    assert model["parameters"]["kl_weight"] == fitted.kl_weight
    assert model["training"]["validation_episodes"] == list(fitted.validation_episodes_)
    assert model["sha256"] == hashlib.sha256((folder / WEIGHTS).read_bytes()).hexdigest()
    assert set(model["versions"]) >= {"latentarm", "torch", "numpy", "python", "safetensors"}
    assert {name: tuple(entry["shape"]) for name, entry in model["tensors"].items()} == {
        name: array.shape for name, array in load((folder / WEIGHTS).read_bytes()).items()
    }


def test_saving_again_replaces_both_files(folder, fitted, demonstrations, samples):
    context, z = samples
    other = MODELS["ae"](seeds=1, epochs=1, hidden=(8,), window=1).fit(demonstrations)
    other.save(folder)
    np.testing.assert_array_equal(load_model(folder).decode(z, context), other.decode(z, context))
    assert sorted(entry.name for entry in folder.iterdir()) == [CONFIG, WEIGHTS]


def test_the_decoder_loads_without_torch(folder):
    script = (
        "import sys; from pathlib import Path; import numpy as np\n"
        "from latentarm.models.saving import load_decoder\n"
        "decoder = load_decoder(Path(sys.argv[1]))\n"
        "print(decoder.decode(np.zeros(2), np.zeros(4)).shape)\n"
        "print([name for name in ('torch', 'mujoco', 'sklearn', 'pyarrow', 'h5py') if name in sys.modules])"
    )
    done = subprocess.run(
        [sys.executable, "-c", script, str(folder)], capture_output=True, text=True, check=True
    )
    assert done.stdout.split("\n")[:2] == ["(4,)", "[]"]


def test_an_epoch_without_a_loss_does_not_make_the_run_unreadable(fitted, tmp_path):
    """A seed may diverge after its best epoch, which is the one that is kept."""
    history = np.array([[0.5, 0.4], [np.nan, 0.3], [np.inf, 0.2]])
    summary = replace(fitted.trained_.summary, history=history)
    write_model(tmp_path, replace(fitted.trained_, summary=summary), {})
    assert "NaN" not in (tmp_path / CONFIG).read_text()
    read = load_model(tmp_path).history_
    np.testing.assert_array_equal(read, [[0.5, 0.4], [np.nan, 0.3], [np.nan, 0.2]])
