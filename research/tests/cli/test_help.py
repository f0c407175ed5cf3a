import json
import subprocess
import sys
from collections.abc import Callable, Iterable
from importlib.metadata import entry_points, version

import pytest

from latentarm.__main__ import main
from latentarm.assistance.blending import ConfidenceAlpha, FixedAlpha
from latentarm.assistance.catalogue import BELIEFS
from latentarm.commands.catalogue import all_commands
from latentarm_research.measurements.catalogue import MEASUREMENTS
from latentarm_research.studies.alignment import preset as alignment_preset
from latentarm_research.studies.alignment import study as alignment
from latentarm_research.studies.backends import BACKENDS
from latentarm_research.studies.catalogue import load_study
from latentarm_research.studies.properties.preset import PRESETS
from latentarm_research.studies.shared_autonomy import preset as shared_autonomy
from latentarm_research.studies.shared_autonomy.cell import TASKS
from latentarm_research.studies.tasks import moved
from latentarm_research.studies.tasks import preset as tasks_preset
from latentarm_research.tasks.planar.catalogue import MOTIONS

COMMANDS = [
    "import",
    "inspect",
    "train",
    "evaluate",
    "align",
    "teleop",
    "export",
    "replay",
    "report",
    "doctor",
    "arms",
    "calibrate",
    "guide",
    "robots",
    "demo",
    "compare",
    "drive",
    "reproduce",
    "measure",
    "study",
    "bench",
]
STUDIES = ["properties", "shared-autonomy", "alignment", "tasks"]
VERBS = ["list", "show", "run", "power", "preregister", "export", "replay", "delete"]
HEAVY = {
    "torch", "mujoco", "matplotlib", "scipy", "statsmodels", "pyarrow", "sklearn", "joblib", "pandas",
    "ruckig", "mink", "h5py", "pydantic", "starlette", "uvicorn",
}  # fmt: skip
Run = Callable[..., tuple[int, str, str]]


@pytest.mark.parametrize(
    "command",
    [name for name in COMMANDS if name not in ("reproduce", "measure", "study", "arms", "calibrate")]
    + [f"reproduce {study}" for study in STUDIES]
    + [f"measure {name}" for name in MEASUREMENTS]
    + [f"study {verb}" for verb in VERBS]
    + ["arms list", "arms check", "calibrate board", "calibrate intrinsics", "calibrate hand-eye"],
)
def test_every_command_shows_an_example_and_json(run: Run, command: str) -> None:
    code, out, _ = run(*command.split(), "--help")
    assert code == 0
    assert f"For example: latentarm {command}" in " ".join(out.split())
    assert "--json" in out


def test_the_list_of_commands(run: Run) -> None:
    code, out, _ = run("--help")
    assert code == 0
    assert "{" + ",".join(COMMANDS) + "}" in out


@pytest.mark.parametrize("name", all_commands().commands)
def test_the_list_says_of_a_command_what_its_own_help_says(name: str) -> None:
    entry = all_commands().commands[name]
    assert (entry.load().__doc__ or "").splitlines()[0] == entry.summary


def test_the_version(run: Run) -> None:
    assert run("--version") == (0, f"latentarm {version('latentarm')}\n", "")


def test_the_list_of_studies(run: Run) -> None:
    code, out, _ = run("reproduce", "--help")
    assert code == 0
    assert "{" + ",".join(STUDIES) + "}" in out


@pytest.mark.parametrize(
    ("study", "tasks", "presets"),
    [
        ("properties", MOTIONS, PRESETS),
        ("shared-autonomy", TASKS, shared_autonomy.PRESETS),
        ("alignment", alignment.STUDY.tasks, alignment_preset.PRESETS),
        ("tasks", moved.TASKS, tasks_preset.PRESETS),
    ],
)
def test_a_study_offers_what_there_is(
    run: Run, study: str, tasks: Iterable[str], presets: dict[str, object]
) -> None:
    assert (list(tasks), presets) == (list(load_study(study).tasks), load_study(study).presets)
    _, out, _ = run("reproduce", study, "--help")
    offered = "".join(out.replace("│", " ").split())  # a long list of names goes on in the next line
    for names in (["all", *tasks], presets, BACKENDS):
        assert "{" + ",".join(names) + "}" in offered


def test_a_drive_offers_every_belief_and_says_the_usual_alphas(run: Run) -> None:
    _, out, _ = run("drive", "--help")
    assert ",".join(BELIEFS) in out
    usual = f"By default {FixedAlpha().value:g}, with confidence {ConfidenceAlpha().most:g}."
    assert usual in " ".join(out.replace("│", " ").split())


def test_no_help_loads_anything_heavy() -> None:
    known = all_commands()
    asked = [[*name.split(), "--help"] for name in ("", *known.groups, *known.commands)]
    script = (
        "import sys, latentarm.cli\n"
        f"for words in {asked}:\n"
        "    try: latentarm.cli.main(words)\n"
        "    except SystemExit: pass\n"
        f"    if heavy := {HEAVY} & set(sys.modules): sys.exit(f'{{words}} loaded {{heavy}}')\n"
    )
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr


def test_the_installed_command_is_this_one() -> None:
    (script,) = entry_points(group="console_scripts", name="latentarm")
    assert script.load() is main


def test_robots_lists_and_describes(run: Run) -> None:
    assert "panda" in run("robots")[1]
    (panda,) = json.loads(run("robots", "panda", "--json")[1])
    assert panda["name"] == "panda"
    assert len(panda["joints"]) == 7
    assert panda["joints"][1]["upper"] == pytest.approx(1.7628)
    assert panda["joints"][1]["acceleration"] == pytest.approx(7.5)
