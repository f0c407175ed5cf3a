import json
import subprocess
import sys
from collections.abc import Callable
from importlib.metadata import entry_points

import pytest

from latentarm.cli import main

COMMANDS = ["demo", "import", "inspect", "train", "evaluate", "drive", "bench", "robots"]
Run = Callable[..., tuple[int, str, str]]


@pytest.mark.parametrize("command", COMMANDS)
def test_every_command_shows_an_example_and_json(run: Run, command: str) -> None:
    code, out, _ = run(command, "--help")
    assert code == 0
    assert f"For example: latentarm {command}" in " ".join(out.split())
    assert "--json" in out


def test_the_list_of_commands(run: Run) -> None:
    code, out, _ = run("--help")
    assert code == 0
    assert "{" + ",".join(COMMANDS) + "}" in out


def test_help_loads_nothing_heavy() -> None:
    script = (
        "import sys, latentarm.cli\n"
        "try: latentarm.cli.main(['--help'])\n"
        "except SystemExit: pass\n"
        "heavy = {'torch', 'mujoco', 'matplotlib', 'scipy', 'pyarrow', 'sklearn'} & set(sys.modules)\n"
        "sys.exit(f'loaded {heavy}' if heavy else 0)"
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
