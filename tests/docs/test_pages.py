"""The documents tell the truth: their snippets run, their links lead somewhere, their packages exist."""

import re
import shlex
import shutil
from pathlib import Path

import pytest

from documentation import PAGES, ROOT, SLOW, commands, name_of, run_page
from latentarm import __version__
from latentarm.cli import main
from study_participant import participant, serving

SHARED = ROOT.parent / "shared" / "demonstrations"

NOT_RUN = {
    "make demo": "tests/simulation runs it in its smallest size",
    "make test": "this is it",
    "make dist": "tests/packaging builds these files",
    'pip install "latentarm[research]"': "tests/packaging builds the wheel",
    'pip install "latentarm[train]"': "tests/packaging installs the wheel",
}
"""Lines of shell blocks that no test runs, each with the reason."""

ON_RECORDED_DEMONSTRATIONS = ["docs/comparison.md", "docs/models.md", "docs/results.md"]
"""Pages whose commands need the recorded demonstrations, and minutes."""

RUN_ELSEWHERE = {*ON_RECORDED_DEMONSTRATIONS, "docs/data.md"}

STUDIES = list(
    dict.fromkeys(
        line for page in PAGES for line in commands(page) if line.startswith("latentarm reproduce ")
    )
)
"""Commands that take minutes, each once, on whichever pages they stand."""

USER_STUDIES = [line for page in PAGES for line in commands(page) if line.startswith("latentarm study ")]
"""The same of the user studies, in their order: a later one reads what an earlier one wrote."""


@pytest.mark.parametrize("page", PAGES, ids=name_of)
def test_links_lead_somewhere(page: Path) -> None:
    links = re.findall(r"\]\(([^)#\s]+)[^)]*\)", page.read_text())
    missing = [link for link in links if "://" not in link and not (page.parent / link).exists()]
    assert not missing


def test_make_targets_exist() -> None:
    targets = set(re.findall(r"^([a-z-]+):", (ROOT / "Makefile").read_text(), flags=re.MULTILINE))
    named = {line.split()[1] for page in PAGES for line in commands(page) if line.startswith("make ")}
    assert {"demo", "test"} <= named <= targets


def test_every_line_of_the_pages_runs_or_has_a_reason_not_to() -> None:
    lines = {line for page in PAGES for line in commands(page)}
    assert {line for line in lines if not line.startswith("latentarm ")} == set(NOT_RUN)


@pytest.mark.parametrize("page", [one for one in PAGES if name_of(one) not in RUN_ELSEWHERE], ids=name_of)
def test_a_page_runs_from_top_to_bottom(
    page: Path, workspace: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    makes = {line.split()[3] for line in commands(page) if line.startswith("latentarm import ")}
    for given in workspace.iterdir():
        if given.name == "runs" and "eat" in makes:
            continue
        if given.name not in makes:
            (shutil.copytree if given.is_dir() else shutil.copyfile)(given, given.name)
    run_page(page, NOT_RUN)


@pytest.mark.slow  # tests/cli/test_reproduce.py runs each study in its smallest size
@pytest.mark.filterwarnings("ignore:.*to learn a way back")  # six demonstrations are too few for some tasks
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
def test_commands_of_the_user_studies_run(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    Path("examples").symlink_to(ROOT / "examples")
    for line in USER_STUDIES:
        if line.startswith("latentarm study serve "):
            with serving(*shlex.split(line)[3:]) as (link, _), participant(link, link) as person:
                person.take_part()
            continue
        small = " --simulated 3 --preset smoke" if line.startswith("latentarm study run ") else ""
        assert main(shlex.split(line + small)[1:]) == 0, line


@pytest.mark.slow
@pytest.mark.skipif(not SHARED.exists(), reason="the recorded demonstrations are not next to this clone")
@pytest.mark.parametrize("page", ON_RECORDED_DEMONSTRATIONS)
def test_commands_on_recorded_demonstrations_run(
    page: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    run = [line for line in commands(ROOT / page) if line.startswith("latentarm ")]
    assert run
    for line in run:
        small = line.replace("../shared", str(SHARED.parent)).replace("--preset paper", "--preset smoke")
        assert main(shlex.split(small)[1:]) in (0, 1), line


def test_slow_commands_stand_only_where_a_slow_test_runs_them() -> None:
    for page in PAGES:
        for line in commands(page):
            if line.startswith("latentarm ") and line.split()[1] in SLOW:
                assert (
                    line in STUDIES or line in USER_STUDIES or name_of(page) in ON_RECORDED_DEMONSTRATIONS
                ), line


def test_architecture_names_every_package() -> None:
    text = (ROOT / "docs" / "architecture.md").read_text()
    packages = [path.name for path in (ROOT / "src/latentarm").iterdir() if (path / "__init__.py").exists()]
    assert [name for name in packages if f"`{name}`" not in text] == []


def test_every_test_that_shows_what_is_expected_of_the_page_is_there() -> None:
    text = (ROOT / "docs/evidence/page_expectations.md").read_text()
    named = re.findall(r"`((?:web|alignment)/[\w/.]+)(?:::(\w+))?`", text)
    assert len(named) >= 30
    for path, test in named:
        assert (
            f"def {test}(" in (ROOT / "tests" / path).read_text()
            if test
            else (ROOT / "tests" / path).exists()
        ), path


def test_pages_written_by_hand_have_at_most_45000_words() -> None:
    by_hand = [page for page in (ROOT / "docs").rglob("*.md") if "evidence" not in page.parts]
    assert sum(len(page.read_text().split()) for page in by_hand) <= 45_000
    assert len((ROOT / "README.md").read_text().split()) <= 600


def test_the_lines_of_the_architecture_are_short() -> None:
    text = (ROOT / "docs" / "architecture.md").read_text()
    assert max(map(len, text.splitlines())) <= 200


def test_every_file_that_the_architecture_names_exists() -> None:
    text = (ROOT / "docs" / "architecture.md").read_text()
    named = set(re.findall(r"`([\w/]+\.(?:py|js|pyi))`", text))
    files = [path.as_posix() for top in ("src", "research", "tests") for path in (ROOT / top).rglob("*")]
    there = [name for name in named if any(path.endswith(f"/{name}") for path in files)]
    assert [name for name in named - set(there) if not (ROOT / name).exists()] == []


def test_no_registry_host_or_absolute_path_is_named() -> None:
    for page in PAGES:
        assert not re.search(r"pypi\.org|/work/|/tmp/|/root/", page.read_text()), page


def test_the_newest_version_of_the_changelog_is_that_of_the_package() -> None:
    versions = re.findall(
        r"^## (\d+\.\d+\.\d+) - \d{4}-\d\d-\d\d$", (ROOT / "CHANGELOG.md").read_text(), re.M
    )
    assert versions[0] == __version__
    assert f"version: {__version__}\n" in (ROOT / "CITATION.cff").read_text()
