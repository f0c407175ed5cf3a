"""Tables show hostile text and obey none of it."""

import pytest
from rich.table import Table

from latentarm.core.untrusted.console import VisibleConsole

HOSTILE = "[/nope] [red]x[/red] :smile: \x1b]0;owned\x07 \u202egnp"


@pytest.mark.parametrize("stderr", [False, True])
def test_hostile_text_is_shown_wherever_a_table_has_it(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch, stderr: bool
) -> None:
    monkeypatch.setenv("COLUMNS", "200")
    table = Table(f"head {HOSTILE}", title=f"title {HOSTILE}", caption=f"caption {HOSTILE}")
    table.add_row(f"cell {HOSTILE}")
    console = VisibleConsole(stderr=stderr)
    console.print(table)
    console.print(f"line {HOSTILE}")
    captured = capsys.readouterr()
    shown = captured.err if stderr else captured.out
    for place in ("head", "title", "caption", "cell", "line"):
        assert f"{place} [/nope] [red]x[/red] :smile: \\x1b]0;owned\\x07 \\u202egnp" in shown
    assert "\x1b]" not in shown


def test_quiet_says_nothing(capsys: pytest.CaptureFixture[str]) -> None:
    VisibleConsole(quiet=True).print("anything")
    assert capsys.readouterr() == ("", "")
