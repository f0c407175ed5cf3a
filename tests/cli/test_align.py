"""`latentarm align`, and driving with what it learned."""

import io
import json
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from latentarm.commands import align as aligning
from result_rows import rows_in

Run = Callable[..., tuple[int, str, str]]

ALIGN = ("align", "mine", "--name", "ada")


def errors(document: str) -> dict[str, float]:
    """Relative alignment errors by condition; fails unless the text is one JSON document of rows."""
    return {row["condition"]: row["mean"] for row in json.loads(document)}


def test_a_simulated_person_is_asked_and_drives(run: Run, trained: Path) -> None:
    code, out, err = run(*ALIGN, "--simulated", "--answers", 4)
    assert code == 0, err
    questions = [line for line in out.splitlines() if line.startswith("Question")]
    assert len(questions) == 4
    spoken = [line for line in out.splitlines() if line and line[0].isalpha()]
    assert len(spoken) >= 6
    assert all("simulated" in line for line in spoken)
    assert "latentarm drive mine --profile ada" in out

    folder = trained / "profiles" / "ada"
    assert {path.name for path in folder.iterdir()} == {
        "config.json",
        "alignment.safetensors",
        "align-options.yaml",
    }
    config = json.loads((folder / "config.json").read_text())
    assert (config["name"], config["person"]) == ("ada", "simulated person")
    assert config["judgement"]["refusal"] == "answers_few"
    assert np.array(config["answers"]["u"]).shape == (4, 2)
    assert np.array(config["answers"]["start"]).shape == (4, 7)
    (row,) = [row for row in rows_in(folder / "config.json") if row.condition == "profile, simulated"]
    assert row.mean is not None
    assert 0 <= row.mean < 0.5, "the answers themselves are met"

    drive = ("drive", "mine", "--drives", 1, "--time-limit-s", 0.3)
    assert run(*drive, "--out", "without")[0] in (0, 1)
    assert run(*drive, "--out", "with", "--profile", "ada")[0] in (0, 1)
    about = {
        name: json.loads(Path(name, "drives.json").read_text())["about"]["profile"]
        for name in ("with", "without")
    }
    assert about == {"with": "ada", "without": None}
    driven = {name: rows_in(Path(name, "drives.json")) for name in about}
    assert driven["with"] != driven["without"]


WITHOUT_TRAINING = """
import sys

class Missing:
    def find_spec(self, name, path=None, target=None):
        if name.split(".")[0] in ("torch", "sklearn", "joblib"):
            raise ModuleNotFoundError(f"No module named {name!r}", name=name)

sys.meta_path.insert(0, Missing())
from latentarm.cli import main
sys.exit(main(sys.argv[1:]))
"""


def test_a_person_is_aligned_where_nothing_that_trains_is_installed(run: Run, trained: Path) -> None:
    command = ("align", "mine", "--simulated", "--answers", "3", "--json", "--name")
    words = [sys.executable, "-c", WITHOUT_TRAINING, *command, "bare"]
    bare = subprocess.run(words, capture_output=True, text=True, check=False)
    assert bare.returncode == 0, bare.stderr
    code, out, _ = run(*command, "full")
    assert code == 0
    assert errors(bare.stdout) == errors(out)


def test_json_is_one_document_and_the_same_seed_gives_the_same(run: Run, trained: Path) -> None:
    outs = []
    for name in ("one", "two"):
        command = ("align", "mine", "--name", name, "--simulated", "--answers", 2, "--seed-index", 1)
        code, out, err = run(*command, "--json")
        assert code == 0
        assert "simulated" in err
        outs.append(errors(out))
    assert outs[0] == outs[1]
    assert set(outs[0]) == {"no_align, simulated", "profile, simulated"}
    stored = [(trained / "profiles" / name / "alignment.safetensors").read_bytes() for name in ("one", "two")]
    assert stored[0] == stored[1]
    config = json.loads((trained / "profiles" / "one" / "config.json").read_text())
    assert config["profile"]["seed_index"] == 1
    assert run("drive", "mine", "--profile", "one", "--drives", 1, "--time-limit-s", 0.3)[0] in (0, 1)


def typed(monkeypatch: pytest.MonkeyPatch, *lines: str) -> None:
    monkeypatch.setattr("sys.stdin", io.StringIO("".join(f"{line}\n" for line in lines)))


def test_a_person_answers_in_lines(run: Run, trained: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    typed(monkeypatch, "0.5 -1", "", "left", "2 0", "0.5", "nan 0", "0, 0.25", "\x1b[A\x1b[A\x1b[D")
    code, out, err = run(*ALIGN, "--answers", 3)
    assert code == 0, err
    assert "The page would not keep this person's profile." in out
    assert "so few answers" in out
    assert "simulated" not in out
    for said in ("not a number", "from -1 to 1", "1 of 2 numbers"):
        assert said in out
    # One was skipped, and asked anew with another motion.
    assert [out.count(f"Question {number} of") for number in (1, 2, 3)] == [1, 2, 1]
    config = json.loads((trained / "profiles" / "ada" / "config.json").read_text())
    assert config["person"] == "person"
    assert config["answers"]["u"] == [[0.5, -1.0], [0.0, 0.25], [-0.25, 0.5]]
    assert len(np.unique(config["answers"]["start"], axis=0)) == 3


def test_no_more_is_asked_when_enough_is_known(
    run: Run, trained: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(aligning.StoppingRule, "enough", lambda self, history: len(history) == 2)
    code, out, _ = run(*ALIGN, "--simulated", "--answers", 9)
    assert code == 0
    # After six answers it is first known how much is unknown, after seven again.
    assert out.count("Question ") == 7
    assert "7 answers of a simulated person are enough" in out


def test_an_input_that_ends_saves_nothing(run: Run, trained: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    typed(monkeypatch, "0.5 -1")
    code, _, err = run(*ALIGN)
    assert code == 2
    assert "ended" in err
    assert not (trained / "profiles").exists()


def test_someone_who_skips_everything_has_no_profile(
    run: Run, trained: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    typed(monkeypatch, *[""] * 200)
    code, _, err = run(*ALIGN)
    assert code == 2
    assert "No question was answered" in err
    assert not (trained / "profiles").exists()


def test_ctrl_c_saves_nothing_and_says_so(
    run: Run, trained: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    def interrupted(axes: int) -> str:
        raise KeyboardInterrupt

    monkeypatch.setattr(aligning, "read_line", interrupted)
    with pytest.raises(KeyboardInterrupt):  # which ends the program, see `test_interrupted.py`
        run(*ALIGN)
    assert "Nothing is saved." in capsys.readouterr().err
    assert not (trained / "profiles").exists()


def test_what_cannot_be_aligned_is_refused(run: Run, trained: Path) -> None:
    for words, said in (
        (("align", "nowhere", "--name", "ada"), "nowhere"),
        ((*ALIGN, "--answers", 0), "at least 1"),
        ((*ALIGN, "--seed-index", 2), "no seed index 2"),
        ((*ALIGN, "--seed", -1), "seed"),
        (("align", "mine", "--name", "..."), "has no letter"),
        (("drive", "mine", "--profile", "ada"), "align mine --name ada"),
        (("drive", "mine", "--profile", "ada", "--controller", "end_effector"), "mode switching has none"),
        (("drive", "--profile", "ada"), "mode switching has none"),
    ):
        code, out, err = run(*words)
        assert (code, out) == (2, "")
        assert said in err
        assert err.count("\n") == 1
    assert not (trained / "profiles").exists()


def test_a_name_is_given_once_and_for_one_model(run: Run, trained: Path) -> None:
    assert run(*ALIGN, "--simulated", "--answers", 1)[0] == 0
    code, _, err = run(*ALIGN, "--simulated")
    assert code == 2
    assert "choose another" in err
    (trained / "profiles").rename("profiles")
    command = ("train", "--demonstrations", "table", "--model", "cae", "--epochs", 1, "--out", "other")
    run(*command)
    Path("profiles").rename("other/profiles")
    code, _, err = run("drive", "other", "--profile", "ada")
    assert code == 2
    assert "learned for another model" in err
