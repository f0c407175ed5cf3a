"""Output of commands: rows as a table or as one JSON document, and messages."""

import json as json_format
import sys
from collections.abc import Sequence
from typing import TYPE_CHECKING

from latentarm.core.untrusted.terminal import visible

if TYPE_CHECKING:
    from rich.console import RenderableType

    from latentarm.core.types import Row


def show(rows: "Sequence[Row]", json: bool, *tables: "RenderableType") -> None:
    """Print rows as one JSON document, or as the tables given, or else as a table of all rows."""
    if json:
        print(json_format.dumps([row.as_json() for row in rows], indent=2))
    elif tables:
        print_renderables(*tables)
    else:
        from latentarm.core.untrusted.console import VisibleConsole
        from latentarm.evaluation.table import rich_tables

        print_renderables(rich_tables(rows, width=VisibleConsole().width))


def say(sentence: str, json: bool) -> None:
    """Print a message at once; with ``--json`` on standard error, to keep standard output one document."""
    print(visible(sentence), file=sys.stderr if json else sys.stdout, flush=True)


def draws_blocks() -> bool:
    """Whether messages go to a terminal that shows block elements, of which QR codes are made."""
    try:
        "▀▄█".encode(sys.stdout.encoding)
    except UnicodeEncodeError:
        return False
    return sys.stdout.isatty()


def note(sentences: "Sequence[str]") -> None:
    """Print a notice on standard error, with ``--json`` too."""
    for sentence in sentences:
        print(f"latentarm: note: {visible(sentence)}", file=sys.stderr)


def refuse(sentences: "Sequence[str]") -> None:
    """Print why something is refused on standard error, with ``--json`` too."""
    for sentence in sentences:
        print(f"latentarm: refused: {visible(sentence)}", file=sys.stderr)


def print_renderables(*renderables: "RenderableType") -> None:
    """Print tables and other things that rich can draw."""
    from latentarm.core.untrusted.console import VisibleConsole

    console = VisibleConsole()
    for renderable in renderables:
        console.print(renderable)
