"""A run works without its dataset and its robot's files, and opens no file outside its folder for them."""

import json
import re
import shutil
import sys
from pathlib import Path

import numpy as np
import pytest

from latentarm.cli import main
from latentarm.core.errors import UserError
from latentarm.demonstrations.dataset import write_dataset
from latentarm.robots.catalogue import load_robot
from latentarm.runs.folder import read_run, robot_of
from latentarm.runs.options import TrainOptions
from latentarm.runs.tasks import task_of_run
from latentarm.runs.training import train_run
from latentarm.tasks.reach import Reach
from latentarm.tasks.table_top import TableTop
from latentarm.web.arm_process.drive_setup import Spec, load_setup

KEPT = ("robot_model", "task", "goals", "routes", "samples")
"""Keys that older runs lack."""

ARM = """<mujoco><compiler angle="radian" meshdir="meshes"/>
<asset><mesh name="wedge" file="wedge.obj"/></asset>
<worldbody><body name="first"><joint name="turn" axis="0 0 1" range="-2 2"/>
<geom type="capsule" fromto="0 0 0 0.4 0 0" size="0.03"/>
<body name="second" pos="0.4 0 0"><joint name="fold" axis="0 0 1" range="-2 2"/>
<geom type="mesh" mesh="wedge" pos="0.15 0 0"/><site name="tip" pos="0.3 0 0"/></body></body></worldbody>
</mujoco>
"""
WEDGE = (
    "v -0.1 -0.02 -0.02\nv 0.1 -0.02 -0.02\nv 0 0.04 -0.02\nv 0 0 0.04\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n"
)


@pytest.fixture(scope="module")
def made(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Runs for the table and for an arm of a model file, with their datasets and the model."""
    folder = tmp_path_factory.mktemp("made")
    (folder / "meshes").mkdir()
    (folder / "meshes" / "wedge.obj").write_text(WEDGE)
    (folder / "arm.xml").write_text(ARM)
    rng = np.random.default_rng(0)
    arm = load_robot(str(folder / "arm.xml"))
    for name, task in (("table", TableTop()), ("arm", Reach(arm))):
        write_dataset(task.demonstrate(6, rng), folder / f"data-{name}")
        train_run(TrainOptions((folder / f"data-{name}",), "pca", out=folder / name, seeds=1))
    return folder


@pytest.fixture(params=["table", "arm"])
def alone(request: pytest.FixtureRequest, made: Path, tmp_path: Path) -> Path:
    """A copy of a run, which names a dataset and a model that are not there."""
    run = tmp_path / "run"
    shutil.copytree(made / request.param, run)
    config = (run / "config.json").read_text().replace(str(made), str(tmp_path / "gone"))
    (run / "config.json").write_text(config)
    return run


def forget(run: Path) -> None:
    """Make a run one of an earlier version."""
    config = json.loads((run / "config.json").read_text())
    (run / "config.json").write_text(json.dumps({key: config[key] for key in config.keys() - set(KEPT)}))
    (run / "samples.safetensors").unlink()
    shutil.rmtree(run / "robot", ignore_errors=True)


def test_all_four_commands_work_without_the_dataset(
    alone: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["evaluate", str(alone)]) == 0
    assert "errors of reconstruction and the folds are left out" in capsys.readouterr().out
    measured = {row["measure"] for row in json.loads((alone / "metrics.json").read_text())["rows"]}
    assert {"controllability_m", "r2", "disentanglement_deg", "drift", "reversal"} <= measured
    assert "error" not in measured
    assert main(["align", str(alone), "--name", "ada", "--simulated", "--answers", "3"]) == 0
    drive = ["drive", str(alone), "--profile", "ada", "--drives", "1", "--time-limit-s", "1", "--jobs", "1"]
    assert main([*drive, "--out", str(tmp_path / "driven")]) in (0, 1)  # 1: 1 s is too short to reach a goal
    assert (tmp_path / "driven" / "drives.json").exists()
    setting = load_setup(Spec(alone, "ada"))  # what `latentarm teleop` loads
    assert setting.latent_dim == 2
    assert setting.task.goals
    capsys.readouterr()
    assert main(["evaluate", str(alone), "--folds", "2", "--out", str(tmp_path / "folds")]) == 2
    assert "say where with --demonstrations" in capsys.readouterr().err


def test_a_kept_task_and_robot_are_those_of_the_dataset(made: Path, tmp_path: Path) -> None:
    shutil.copytree(made / "arm", tmp_path / "older")
    forget(tmp_path / "older")
    kept, read = read_run(made / "arm"), read_run(tmp_path / "older")
    assert read.task is None
    tasks = task_of_run(kept), task_of_run(read)
    for goal in range(len(tasks[1].goals)):
        ways = [task.waypoints(goal, "follow") for task in tasks]
        assert len(ways[0]) == len(ways[1])
        np.testing.assert_array_equal(ways[0][-1].position, ways[1][-1].position)
        starts = [task.sample_start(goal, np.random.default_rng(0)) for task in tasks]
        np.testing.assert_array_equal(*starts)
    copy, original = robot_of(kept), robot_of(read)
    assert copy.name == str((made / "arm" / "robot" / "model.xml").resolve())
    q = np.random.default_rng(0).uniform(-1, 1, (20, 2))
    np.testing.assert_array_equal(copy.chain.forward(q).position, original.chain.forward(q).position)
    np.testing.assert_array_equal(copy.capsules.radius, original.capsules.radius)


def test_an_older_run_says_what_is_missing(
    alone: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    forget(alone)
    with pytest.raises(UserError, match=r"does not keep its task, and its dataset is not at .*: put it back"):
        load_setup(Spec(alone))
    for command in (
        ["drive", str(alone), "--out", str(tmp_path / "driven")],
        ["align", str(alone), "--name", "ada", "--simulated"],
        ["evaluate", str(alone)],
    ):
        assert main(command) == 2
        said = capsys.readouterr().err
        assert said.count("\n") == 1
        assert re.search("say where with --demonstrations|Robot|robot|cannot be read", said)


def test_loading_a_run_opens_nothing_outside_its_folder(alone: Path) -> None:
    """The dataset and the model that it names are traps here; the libraries' own files do not count."""
    gone = alone.parent / "gone"
    opened: list[str] = []
    hearing = True

    def heard(event: str, arguments: tuple[object, ...]) -> None:
        if hearing and event == "open":
            opened.append(str(arguments[0]))

    sys.addaudithook(heard)
    load_setup(Spec(alone)).step()
    hearing = False
    assert any(name.startswith(str(alone)) for name in opened)
    assert not [name for name in opened if name.startswith(str(gone))]


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ('file="0-wedge.obj"', 'file="../wedge.obj"'),
        ('file="0-wedge.obj"', 'file="/wedge.obj"'),
        ("<compiler ", '<compiler meshdir="/" '),
        ("</mujoco>", '<include file="0-wedge.obj"/></mujoco>'),
    ],
)
def test_a_copy_that_names_files_elsewhere_is_refused(made: Path, tmp_path: Path, old: str, new: str) -> None:
    shutil.copytree(made / "arm", tmp_path / "run")
    model = tmp_path / "run" / "robot" / "model.xml"
    assert old in model.read_text()
    model.write_text(model.read_text().replace(old, new, 1))
    with pytest.raises(UserError, match=r"does not lie beside it|names other models or folders"):
        robot_of(read_run(tmp_path / "run"))


def test_links_out_of_a_run_are_refused(made: Path, tmp_path: Path) -> None:
    shutil.copytree(made / "arm", tmp_path / "run")
    for name in ("0-wedge.obj", "model.xml"):
        file = tmp_path / "run" / "robot" / name
        file.rename(tmp_path / name)
        file.symlink_to(tmp_path / name)
        with pytest.raises(UserError, match="does not lie beside it"):
            robot_of(read_run(tmp_path / "run"))


@pytest.mark.parametrize(
    ("key", "value", "said"),
    [
        ("robot_model", "../../arm.xml", "'robot_model' must be one of"),
        ("task", "anything", "'task' must be one of"),
        (
            "goals",
            [{"name": "cup", "configuration": [0.0], "position": [0], "rotation": 1}],
            "goal 0 must be",
        ),
        ("goals", [3], "its goals are damaged"),
        ("routes", [[[0.0, 0.0]]], "has no waypoint"),
        ("routes", [[[0.0, 0.0], [1.0]]], "must be a list of numbers"),
        ("routes", 5, "must be a list"),
        ("open_at", [[1.0]] * 9, "'open_at' has 9 entries for"),
        ("open_at", 5, "must be a list"),
    ],
)
def test_what_a_run_keeps_is_checked(made: Path, tmp_path: Path, key: str, value: object, said: str) -> None:
    shutil.copytree(made / "arm", tmp_path / "run")
    config = json.loads((tmp_path / "run" / "config.json").read_text())
    (tmp_path / "run" / "config.json").write_text(json.dumps(config | {key: value}))
    with pytest.raises(UserError, match=said):
        read_run(tmp_path / "run")
