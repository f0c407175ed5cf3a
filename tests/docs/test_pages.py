"""The documents tell the truth: their commands run, their links lead somewhere, their packages exist."""

import re
import shlex
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from latentarm.cli import main
from latentarm.tasks.table_top import TableTop

ROOT = Path(__file__).parents[2]
PAGES = [ROOT / "README.md", ROOT / "CONTRIBUTING.md", *sorted((ROOT / "docs").glob("*.md"))]
SHARED = ROOT.parent / "shared" / "demonstrations"


def commands(page: Path) -> list[str]:
    """The lines of a page's shell blocks."""
    blocks = re.findall(r"```sh\n(.*?)```", page.read_text(), flags=re.DOTALL)
    lines = [line.split("#")[0].strip() for block in blocks for line in block.splitlines()]
    return [line for line in lines if line]


STUDIES = list(
    dict.fromkeys(
        line for page in PAGES for line in commands(page) if line.startswith("latentarm reproduce ")
    )
)
"""Commands that take minutes, each once, on whichever pages they stand."""

QUICKLY = {
    "train": {"--epochs": "1", "--seeds": "1"},
    "drive": {"--drives": "1", "--time-limit-s": "2"},
    "align": {"--answers": "2"},
}
"""Options that make a command short where the page does not give them."""


def quickly(line: str) -> list[str]:
    """The words of a command after ``latentarm``, of a size for a test."""
    words = shlex.split(line)[1:]
    for option, value in QUICKLY.get(words[0], {}).items():
        if option not in words:
            words += [option, value]
    return words


@pytest.mark.parametrize("page", PAGES, ids=lambda path: path.name)
def test_links_lead_somewhere(page: Path) -> None:
    links = re.findall(r"\]\(([^)#\s]+)[^)]*\)", page.read_text())
    missing = [link for link in links if "://" not in link and not (page.parent / link).exists()]
    assert not missing


def test_make_targets_exist() -> None:
    targets = set(re.findall(r"^([a-z-]+):", (ROOT / "Makefile").read_text(), flags=re.MULTILINE))
    named = {line.split()[1] for page in PAGES for line in commands(page) if line.startswith("make ")}
    assert {"demo", "test"} <= named <= targets


def test_every_command_of_the_pages_is_one_of_ours() -> None:
    """What is in a shell block is either run by a test below, or a target of make, or a named script."""
    for page in PAGES:
        for line in commands(page):
            assert line.startswith(("make ", "latentarm ", "python scripts/")), f"{page.name}: {line}"


def test_readme_commands_run(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, record_on_the_page: Callable[[Path], None]
) -> None:
    monkeypatch.chdir(tmp_path)
    demonstrations = TableTop().demonstrate(6, np.random.default_rng(0))
    states = [episode.state[::4] for episode in demonstrations.episodes]
    ends = np.cumsum([len(state) for state in states])
    np.savez("recording.npz", q=np.concatenate(states), episode_ends=ends, rate_hz=5.0)
    record_on_the_page(Path("teleop/journal.sqlite"))
    run = [line for line in commands(ROOT / "README.md") if line.startswith("latentarm ")]
    assert run
    for line in run:
        if line not in STUDIES:
            assert main(quickly(line)) in (0, 1), line


@pytest.mark.slow  # tests/cli/test_reproduce.py runs each study in its smallest size
@pytest.mark.parametrize("line", STUDIES)
def test_commands_of_the_study_run(line: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """With the small sizes; on another backend one task is enough, since all give the same bytes."""
    assert line in STUDIES
    monkeypatch.chdir(tmp_path)
    small = line.replace("--preset paper", "--preset smoke") + (" --task sine" if "--backend" in line else "")
    assert main(shlex.split(small)[1:]) == 0
    (page,) = tmp_path.rglob("results.md")
    assert list(page.parent.glob("*.png"))


@pytest.mark.slow
@pytest.mark.skipif(not SHARED.exists(), reason="the recorded demonstrations are not beside this clone")
@pytest.mark.parametrize("page", ["comparison.md", "models.md", "results.md"])
def test_commands_on_recorded_demonstrations_run(
    page: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    run = [line for line in commands(ROOT / "docs" / page) if line.startswith("latentarm ")]
    assert run
    for line in run:
        small = line.replace("../shared", str(SHARED.parent)).replace("--preset paper", "--preset smoke")
        assert main(shlex.split(small)[1:]) in (0, 1), line


def test_architecture_names_every_package() -> None:
    text = (ROOT / "docs" / "architecture.md").read_text()
    packages = [path.name for path in (ROOT / "src/latentarm").iterdir() if (path / "__init__.py").exists()]
    assert [name for name in packages if f"`{name}`" not in text] == []


def test_no_registry_host_or_absolute_path_is_named() -> None:
    for page in PAGES:
        assert not re.search(r"pypi\.org|/work/|/tmp/|/root/", page.read_text()), page
