"""Tables and progress in a terminal, with text that this program may not have written."""

from typing import TYPE_CHECKING, Any, final

from rich.console import Console
from rich.text import Text

from latentarm.core.untrusted.terminal import visible

if TYPE_CHECKING:
    from rich.style import Style


@final
class VisibleConsole(Console):
    """A rich console without markup, emoji codes or escape sequences, which untrusted text may hold."""

    def __init__(self, *, stderr: bool = False, quiet: bool = False) -> None:
        super().__init__(stderr=stderr, quiet=quiet, markup=False, emoji=False)

    def render_str(self, text: str, *, style: "str | Style" = "", **options: Any) -> Text:
        """Rich calls this for every string in a table, heads and titles included."""
        options |= {"markup": False, "emoji": False}
        return super().render_str(visible(text), style=style, **options)
