"""A later start of a study serves the same study, or is refused and leaves everything as it is."""

import json
import socket
from pathlib import Path

import pytest

from latentarm.cli import main
from latentarm_research.user_studies.serving.store import Store
from study_participant import CONTACT
from study_start import Starts

FIRST = ("--prolific", "5" * 24, "--completion-code", "C0DE", "--away-hours", "2.3", "--preset", "smoke")


@pytest.fixture
def start(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> Starts:
    return Starts(tmp_path, monkeypatch, capsys)


def contents(folder: Path) -> dict[str, bytes]:
    return {path.name: path.read_bytes() for path in folder.rglob("*") if path.is_file()}


def test_options_that_are_left_out_are_those_of_the_first_start(start: Starts) -> None:
    assert start(*FIRST) == 0
    first, sent = json.loads((start.out / "config.json").read_text()), start.codes
    assert "As at the first start" not in start.output
    assert first["places"] == 2
    assert start() == 0
    said = start.output
    assert (
        f"As at the first start: with --contact {CONTACT}, with --prolific {FIRST[1]}, with"
        " --completion-code C0DE, with --away-hours 2.3, with --preset smoke." in said
    )
    assert "{{%SESSION_ID%}}" in said
    assert start(*FIRST) == 0
    assert json.loads((start.out / "config.json").read_text()) == first
    assert start.codes == sent


@pytest.mark.parametrize("contact", [[], ["--contact", " "], ["--contact", "a\nb"], ["--contact", "a" * 201]])
def test_a_study_without_anybody_to_ask_is_not_served(start: Starts, contact: list[str]) -> None:
    assert main(["study", "serve", "eating", "--out", str(start.out), "--port", "0", *contact]) == 2
    assert "Name with --contact whom participants can ask" in start.output
    assert not start.out.exists()


def test_a_folder_of_an_earlier_version_takes_a_contact(start: Starts) -> None:
    assert start() == 0
    config = json.loads((start.out / "config.json").read_text())
    del config["served"]["contact"]
    (start.out / "config.json").write_text(json.dumps(config))
    assert start() == 2
    assert start("--contact", "Bo") == 0
    assert start() == 0
    assert "As at the first start: with --contact Bo" in start.output


@pytest.mark.parametrize(
    ("option", "value", "said"),
    [
        ("--contact", "Bo", f"began with --contact {CONTACT}, and this start is with --contact Bo"),
        ("--prolific", "6" * 24, f"began with --prolific {'5' * 24}, and this start is with --prolific 666"),
        ("--completion-code", "OTHER", "began with --completion-code C0DE"),
        ("--away-hours", "3", "with --away-hours 2.3, and this start is with --away-hours 3.0"),
        ("--database", "postgresql://me:secret@127.0.0.1/other", "began without --database"),
        ("--preset", "paper", "with --preset smoke, and this start is with --preset paper"),
        ("--language", "de", "with --language en, and this start is with --language de"),
        ("--seed", "1", "with --seed 0, and this start is with --seed 1"),
        ("--information", "other.md", "began with --information of SHA-256"),
    ],
)
def test_a_start_with_another_option_is_refused(start: Starts, option: str, value: str, said: str) -> None:
    assert start(*FIRST) == 0
    before = contents(start.out)
    if option == "--information":
        value = str(start.folder / value)
        Path(value).write_text("Something else.")
    assert start(option, value) == 2
    refused = start.output
    assert said in refused
    assert "secret" not in refused
    assert contents(start.out) == before


def test_the_text_that_people_consent_to_stays(start: Starts) -> None:
    own = start.folder / "own.md"
    own.write_text("You drive an arm.")
    assert start("--information", str(own)) == 0
    own.write_text("You drive two arms.")
    assert start("--information", str(own)) == 2
    assert start() == 0
    (kept,) = start.out.glob("information-*.md")
    assert kept.read_text() == "You drive an arm."
    kept.write_text("You drive two arms.")
    assert start() == 2


def test_a_damaged_list_of_options_is_refused(start: Starts) -> None:
    assert start() == 0
    config = json.loads((start.out / "config.json").read_text())
    config["served"]["seed"] = "none"
    (start.out / "config.json").write_text(json.dumps(config))
    assert start() == 2
    assert "served.seed" in start.output


def test_links_that_were_sent_are_not_replaced(start: Starts) -> None:
    assert start() == 0
    sent = (start.out / "links.csv").read_bytes()
    (start.out / "study.sqlite").unlink()
    assert start() == 2
    assert "has links that the study's database does not know" in start.output
    assert (start.out / "links.csv").read_bytes() == sent


def test_the_link_that_is_printed_is_the_first_that_nobody_has_used(start: Starts) -> None:
    assert start() == 0
    first, second = start.codes
    assert f"code={first}" in start.output
    store = Store(start.out / "study.sqlite")
    store.arrive(first, "", 0.0)
    assert start() == 0
    assert f"code={second}" in start.output
    store.arrive(second, "", 0.0)
    store.close()
    assert start() == 0
    assert "All links are in use." in start.output


def test_a_port_that_is_taken_is_refused_before_anything_is_written(start: Starts) -> None:
    with socket.create_server(("127.0.0.1", 0)) as other:
        assert start("--port", str(other.getsockname()[1])) == 2
    assert "cannot be used" in start.output
    assert not start.out.exists()


@pytest.mark.parametrize("command", ["analyse", "export", "replay", "delete"])
def test_a_folder_without_a_study_is_refused(start: Starts, command: str) -> None:
    options = ["--code", "x"] if command == "delete" else []
    assert main(["study", command, str(start.folder / "eating-people"), *options]) == 2
    said = start.output
    assert "No study is in" in said
    assert "latentarm study run eating, or serve eating, makes one." in said
