"""The types that the page's JavaScript is checked against are those of the messages."""

import runpy
from pathlib import Path

SCRIPT = Path(__file__).parents[2] / "scripts" / "message_types.py"


def test_the_types_of_the_messages_are_current():
    script = runpy.run_path(str(SCRIPT))
    current = script["TARGET"].read_text(encoding="utf-8")
    assert current == script["message_types"](), "run: make message-types"
