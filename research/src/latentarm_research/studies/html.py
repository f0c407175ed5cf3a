"""A report's Markdown as one HTML page, which holds everything that it shows."""

from base64 import b64encode
from collections.abc import Mapping, Sequence
from itertools import pairwise
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

from jinja2 import Environment, FileSystemLoader, StrictUndefined
from markupsafe import Markup, escape

if TYPE_CHECKING:
    from markdown_it.token import Token

WIDE: Final = 7
"""Columns of a table from which on its text is small."""


def html_page(
    markdown: str,
    folder: Path,  # where its images are, PNGs
) -> str:
    """The page: images become figures with captions, and the paragraph above a table its caption.

    Markdown may hold HTML, as GitHub's may: strangers' text in it must be escaped. The page runs no scripts.
    """
    from markdown_it import MarkdownIt

    parser = MarkdownIt("commonmark").enable("table")
    parser.add_render_rule("image", _image)
    tokens = _captioned(parser.parse(markdown))
    body = parser.renderer.render(tokens, parser.options, {"folder": folder})
    heading = next((one for before, one in pairwise(tokens) if before.tag == "h1"), None)
    title = "" if heading is None else "".join(one.content for one in heading.children or ())
    environment = Environment(
        loader=FileSystemLoader(Path(__file__).parent, encoding="utf-8"),
        undefined=StrictUndefined,
        autoescape=True,
        keep_trailing_newline=True,
    )
    return environment.get_template("page.html").render(title=title, body=Markup(body))  # noqa: S704


def _captioned(tokens: "Sequence[Token]") -> "list[Token]":
    """The same page with figures and captions of tables."""
    found: list[Token] = []
    for token in tokens:
        if token.type == "table_open" and found and found[-1].type == "paragraph_close":
            before, text, after = found[-3:]
            before.tag = after.tag = "caption"
            found[-3:] = [token, before, text, after]
        else:
            found.append(token)
        if token.type == "thead_close":
            opened = max(place for place, one in enumerate(found) if one.type == "table_open")
            if sum(one.type == "th_open" for one in found[opened:]) >= WIDE:
                found[opened].attrSet("class", "wide")
    for before, text, after in zip(found, found[1:], found[2:], strict=False):
        if [one.type for one in text.children or ()] == ["image"]:
            before.tag = after.tag = "figure"
    return found


def _image(_: Any, tokens: "Sequence[Token]", index: int, __: Any, env: Mapping[str, Any]) -> str:
    image = tokens[index]
    data = b64encode((env["folder"] / str(image.attrs["src"])).read_bytes()).decode()
    return (
        f'<img alt="{escape(image.content)}" src="data:image/png;base64,{data}">'
        f"<figcaption>{escape(image.content)}</figcaption>"
    )
