"""`--config FILE.yaml`: strict, overridden by the command line, and written back beside the results."""

from collections.abc import Callable
from contextlib import suppress
from pathlib import Path

import pytest
import yaml
from hypothesis import given
from hypothesis import strategies as st

from latentarm.commands.catalogue import all_commands
from latentarm.commands.configuration import read_options
from latentarm.commands.train import train
from latentarm.core.errors import UserError

Run = Callable[..., tuple[int, str, str]]


@pytest.mark.parametrize("name", all_commands().commands)
def test_every_command_takes_a_file_and_refuses_what_it_does_not_know(
    run: Run, workplace: Path, name: str
) -> None:
    Path("o.yaml").write_text("jsno: true\n")
    code, out, err = run(*name.split(), "--config", "o.yaml")
    assert (code, out) == (2, "")
    assert f"`latentarm {name}` has no option 'jsno'; the nearest one is 'json'" in err
    assert "--config FILE.yaml" in run(*name.split(), "--help")[1]


REFUSED = {
    "text for a number": ("seed: '1'", "'seed' is '1'. Input should be a valid integer"),
    "a fraction of a seed": ("seed: 1.5", "integer"),
    "truth for a number": ("seeds: true", "integer"),
    "an unknown choice": ("model: gan", "'pca', 'ae'"),
    "one for a list": ("hidden: 30", "list"),
    "an option twice": ("seed: 1\nseed: 2", "'seed' is given twice"),
    "an option in two spellings": ("latent-dim: 1\nlatent_dim: 2", "given twice"),
    "an alias": ("a: &a [1]\nb: *a", "alias"),
    "a tag": ("a: !!python/object/apply:os.system [ls]", "line 1"),
    "a mapping": ("seed: {a: 1}", "'seed' must be"),
    "no mapping": ("- seed", "one option a line"),
    "no YAML": ("seed: [1", "line"),
    "deep": ("a: " + "[" * 20_000, "too deep"),
    "a date": ("seed: 2026-01-01", "'seed' must be"),
    "a number as a name": ("1: 2", "not the name"),
    "large": ("a: " + "b" * 70_000, "too large"),
    "no text": (b"\xff\xfe\x00", "not a YAML file"),
}


@pytest.mark.parametrize("case", REFUSED)
def test_a_file_is_refused_in_one_sentence(tmp_path: Path, case: str) -> None:
    content, said = REFUSED[case]
    path = tmp_path / "o.yaml"
    path.write_bytes(content if isinstance(content, bytes) else content.encode())
    with pytest.raises(UserError, match=r"o\.yaml") as refused:
        read_options(path, train, "train")
    assert said in str(refused.value)
    assert "\n" not in str(refused.value)


@given(st.binary(max_size=200))
def test_any_bytes_are_options_or_refused(tmp_path_factory: pytest.TempPathFactory, content: bytes) -> None:
    path = tmp_path_factory.getbasetemp() / "any.yaml"
    path.write_bytes(content)
    with suppress(UserError):
        read_options(path, train, "train")


def test_values_are_of_the_types_of_the_options(tmp_path: Path) -> None:
    path = tmp_path / "o.yaml"
    path.write_text(
        "demonstrations: eat\nhidden: [30, 20]\ncontext: state_belief\nstate-noise-rad: 1e-2\n"
        "epochs: null\nresume: true\n"
    )
    assert read_options(path, train, "train") == {
        "demonstrations": (Path("eat"),),
        "hidden": (30, 20),
        "context": ("state_belief",),
        "state_noise_rad": 0.01,
        "epochs": None,
        "resume": True,
    }


def test_an_empty_file_changes_nothing(tmp_path: Path) -> None:
    (tmp_path / "o.yaml").write_text("# nothing\n")
    assert read_options(tmp_path / "o.yaml", train, "train") == {}


def test_a_run_is_repeated_from_what_it_wrote(run: Run, workplace: Path, recording: Path) -> None:
    run("import", recording, "eat")
    assert yaml.safe_load(Path("eat/import-options.yaml").read_text())["destination"] == "eat"
    Path("mine.yaml").write_text("demonstrations: eat\nmodel: pca\nseed: 1\n")
    assert run("train", "--config", "mine.yaml", "--seed", 2)[0] == 0
    kept = Path("runs/eat-pca/train-options.yaml")
    resolved = yaml.safe_load(kept.read_text())
    assert (resolved["model"], resolved["seed"], resolved["window"]) == ("pca", 2, 5)
    assert resolved["out"] == "runs/eat-pca"
    assert not {"json", "config", "resume"} & resolved.keys()
    assert run("train", "--config", kept)[0] == 2  # the run is there already
    assert run("train", "--config", kept, "--out", "again")[0] == 0
    one, two = (Path(name, "model.safetensors").read_bytes() for name in ("runs/eat-pca", "again"))
    assert one == two


def test_a_drive_writes_what_its_choices_came_to(run: Run, workplace: Path) -> None:
    drive = ("drive", "--robot", "planar", "--jobs", 1, "--drives", 1, "--time-limit-s", 0.5)
    assert run(*drive)[0] in (0, 1)
    kept = Path("drives/drive-options.yaml")
    resolved = yaml.safe_load(kept.read_text())
    assert (resolved["controller"], resolved["operator"], resolved["task"]) == (
        "end_effector",
        "greedy",
        "reach",
    )
    before = Path("drives/drives.csv").read_bytes()
    assert run("drive", "--config", kept)[0] in (0, 1)
    assert Path("drives/drives.csv").read_bytes() == before
