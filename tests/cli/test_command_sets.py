"""Commands of other distributions join ours, and take nothing away."""

import pytest

from latentarm import cli
from latentarm.cli import main
from latentarm.commands import catalogue
from latentarm.commands.catalogue import OWN, CommandEntry, CommandSet, all_commands
from latentarm.core.plugins import PluginWarning

THEIRS = CommandEntry("theirs:run", "Theirs.")


class Registered:
    def __init__(self, commands: dict[str, CommandEntry], groups: dict[str, str]) -> None:
        self.added = CommandSet(commands, groups)

    def usable(self) -> dict[str, CommandSet]:
        return {"theirs": self.added}


def test_a_command_in_a_group_of_its_own_joins(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(catalogue, "COMMAND_SETS", Registered({"lab walk": THEIRS}, {"lab": "Of a lab."}))
    found = all_commands()
    assert found.commands == {**OWN.commands, "lab walk": THEIRS}
    assert found.groups["lab"] == "Of a lab."


@pytest.mark.parametrize("words", ["train", "lab walk"])
def test_a_command_that_is_taken_or_lacks_its_group_is_left_out(
    monkeypatch: pytest.MonkeyPatch, words: str
) -> None:
    monkeypatch.setattr(catalogue, "COMMAND_SETS", Registered({words: THEIRS}, {}))
    with pytest.warns(PluginWarning, match=f"'{words}'"):
        assert all_commands() == OWN


def test_a_command_of_the_research_names_what_to_install(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(cli, "COMMAND_SETS", ())
    monkeypatch.setattr(catalogue, "COMMAND_SETS", Registered({}, {}))
    assert main(["study", "serve", "eating"]) == 2
    said = capsys.readouterr().err
    assert "no command 'study'" in said
    assert "latentarm[research]" in said
