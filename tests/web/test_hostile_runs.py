"""Runs that were made to end the page or to keep it loading: refused in a sentence, and driving goes on."""

import asyncio
import json
import multiprocessing
import os
import shutil
from collections.abc import Callable
from pathlib import Path

import pytest

from latentarm.web.arm_process.drive_setup import Spec
from latentarm.web.server import run_check
from latentarm.web.server.run_check import why_not_drivable

from .conftest import said


def config(**changes: object) -> Callable[[Path], None]:
    def change(run: Path) -> None:
        path = run / "config.json"
        path.write_text(json.dumps(json.loads(path.read_text()) | changes))

    return change


def content(text: str) -> Callable[[Path], None]:
    return lambda run: (run / "config.json").write_text(text) and None


def replaced(name: str, make: Callable[[Path], None]) -> Callable[[Path], None]:
    def change(run: Path) -> None:
        (run / name).unlink()
        make(run / name)

    return change


HOSTILE = {
    "a pipe": replaced("config.json", os.mkfifo),
    "endless": replaced("config.json", lambda path: path.symlink_to("/dev/zero")),
    "deep": content('{"a":' * 100_000),
    "infinite": config(held_out=[float("inf")]),
    "weights of a pipe": replaced("model.safetensors", os.mkfifo),
    "endless weights": replaced("model.safetensors", lambda path: path.symlink_to("/dev/zero")),
}


@pytest.fixture(scope="module")
def among_hostile(serve, trained, tmp_path_factory):
    """A server that lists a run of each kind, and drives one that has a hostile profile."""
    folder = tmp_path_factory.mktemp("hostile")
    run = Path(shutil.copytree(trained, folder / "mine"))
    (run / "profiles" / "ada").mkdir(parents=True)
    os.mkfifo(run / "profiles" / "ada" / "config.json")
    for kind, spoil in HOSTILE.items():
        spoil(Path(shutil.copytree(trained, folder / "runs" / kind.replace(" ", "-"))))
    with serve(Spec(run, out=folder)) as site:
        yield site


@pytest.mark.parametrize("kinds", [["deep"], pytest.param(list(HOSTILE), marks=pytest.mark.slow)])
def test_a_hostile_run_is_refused_and_driving_goes_on(among_hostile, kinds):
    names = [kind.replace(" ", "-") for kind in kinds]
    with among_hostile.page() as page:
        # A pipe named config.json is listed by name alone: nothing is opened before somebody picks it.
        assert set(names) <= set(page.learning["runs"])
        for name in names:
            page.send(type="run", run=name)
            page.wait(lambda state, name=name: f"Checking {name}" in said(state), within_s=20.0)
            page.wait(lambda state: "Checking" not in said(state), within_s=60.0)
            why = said(page.state)
            assert why.count("\n") == 0
            assert "\x1b" not in why
            assert any(word in why for word in ("config.json", "model.safetensors")), (name, why)
        assert among_hostile.control.alive
        assert page.welcome["run"] == "mine"
        page.drive(1.0, 0.0)


@pytest.mark.slow
@pytest.mark.parametrize(
    "dataset", ["a pipe", "x" * 60_000, "\x1b]0;owned\x07", "a\0b"], ids=["pipe", "long", "escape", "no path"]
)
def test_a_run_is_driven_without_its_dataset(serve, trained, tmp_path, dataset):
    shutil.copytree(trained, tmp_path / "mine")
    run = Path(shutil.copytree(trained, tmp_path / "runs" / "other"))
    if dataset == "a pipe":
        os.mkfifo(run / dataset)
        dataset = str(run / dataset)
    config(demonstrations=dataset)(run)
    with serve(Spec(tmp_path / "mine", out=tmp_path)) as site, site.page() as page:
        page.send(type="run", run="other")
        page.wait(lambda _: page.welcome["run"] == "other", within_s=60.0)
        assert "\x1b" not in said(page.state)
        page.enable()


def test_while_the_arm_moves_no_run_is_tried(among_hostile):
    with among_hostile.page() as page:
        page.enable()
        page.send(type="run", run="deep")
        page.wait(lambda state: "Stop the arm first" in said(state))
        assert page.state["phase"] == "ready"


def test_a_run_that_loads_for_ever_is_given_up(tmp_path, trained, monkeypatch):
    monkeypatch.setattr(run_check, "WITHIN_S", 0.0)
    failure = asyncio.run(why_not_drivable(Spec(trained, out=tmp_path), "mine"))
    assert failure is not None
    assert failure.code == "run_too_slow"
    assert "loading a run" not in {child.name for child in multiprocessing.active_children()}


def test_a_hostile_profile_is_refused(among_hostile):
    with among_hostile.page() as page:
        page.send(type="profile", name="ada")
        page.wait(lambda state: "is a named pipe" in said(state), within_s=20.0)
        assert page.state["profile"] is None
        page.enable()
