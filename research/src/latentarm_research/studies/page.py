"""A study's report: Markdown from the Jinja template in its package, one HTML page, and a PDF."""

import os
import shutil
import subprocess
from base64 import b64encode
from collections.abc import Mapping, Sequence
from itertools import pairwise
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING, Any, Final

from jinja2 import Environment, FileSystemLoader, StrictUndefined
from markupsafe import Markup, escape

from latentarm.core.files import written_whole
from latentarm.evaluation.looks import look_of
from latentarm_research.studies.tables import listed, plain, plain_table

if TYPE_CHECKING:
    from markdown_it.token import Token

STUDIES: Final = Path(__file__).parent

SMOKE: Final = "smoke"
"""The preset of every study that only shows that it runs: its hypotheses are not judged."""


def render_page(template: str, preset: Any, **content: Any) -> str:
    """A page from its template.

    Templates have the filters ``label`` (of a model, a condition or a task), ``literal`` (as code),
    ``listed`` (``A, B and C``), ``g`` (a number without trailing zeros), ``image`` (a figure by its name) and
    ``plain`` (see `plain`); ``table`` is `plain_table`.
    """
    # Markdown, not HTML: nothing is to be escaped.
    environment = Environment(  # noqa: S701
        loader=FileSystemLoader((STUDIES, STUDIES.parent), encoding="utf-8"),
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
        keep_trailing_newline=True,
    )
    environment.filters.update(
        label=name_of,
        literal="`{}`".format,
        listed=listed,
        g="{:g}".format,
        image=_image,
        plain=plain,
    )
    judged = preset.name != SMOKE
    page = environment.get_template(template).render(content, table=plain_table, preset=preset, judged=judged)
    return page if judged else page.replace("\n", f" (preset {SMOKE})\n", 1)


def name_of(name: str) -> str:
    """The label of a model, a condition or a task on the pages of simulations."""
    return look_of(name).label


def _image(name: str) -> str:
    return f"![{name.replace('_', ' ')}, simulated]({name}.png)"


WIDE: Final = 7  # columns of a table from which on its text is small


def html_page(
    markdown: str,
    folder: Path,  # where its images are, PNGs
) -> str:
    """The page: images become figures with captions, and the paragraph above a table its caption.

    Markdown may hold HTML, as GitHub's may: strangers' text in it must be escaped. The page runs no scripts.
    """
    from markdown_it import MarkdownIt

    parser = MarkdownIt("commonmark").enable("table")
    parser.add_render_rule("image", _embedded)
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


def _embedded(_: Any, tokens: "Sequence[Token]", index: int, __: Any, env: Mapping[str, Any]) -> str:
    image = tokens[index]
    data = b64encode((env["folder"] / str(image.attrs["src"])).read_bytes()).decode()
    return (
        f'<img alt="{escape(image.content)}" src="data:image/png;base64,{data}">'
        f"<figcaption>{escape(image.content)}</figcaption>"
    )


HTML: Final = "report.html"
PDF: Final = "report.pdf"

NAMES: Final = ("chromium", "chromium-browser", "google-chrome", "google-chrome-stable")
"""Of the programs that print, in the order in which they are looked for."""

LONGEST_S: Final = 120.0

WITHOUT: Final = "There is no PDF, because no Chromium is installed: print the page from a browser."
NOT_PRINTED: Final = "There is no PDF, because Chromium could not print the page: print it from a browser."


def find_browser() -> str | None:
    """The Chromium of this machine, or None."""
    return next((path for name in NAMES if (path := shutil.which(name))), None)


def print_page(page: Path, pdf: Path) -> str:
    """Print a page to a PDF, whole or not at all; on failure return the reason as a sentence."""
    browser = find_browser()
    if browser is None:
        return WITHOUT
    with TemporaryDirectory(ignore_cleanup_errors=True) as folder:
        printed = Path(folder) / PDF
        command = [
            browser,
            "--headless=new",
            "--disable-gpu",
            "--no-first-run",
            f"--user-data-dir={folder}/profile",
            "--no-pdf-header-footer",
            *browser_rights(),
            f"--print-to-pdf={printed}",
            page.resolve().as_uri(),
        ]
        try:
            done = subprocess.run(command, capture_output=True, timeout=LONGEST_S, check=False)
        except (OSError, subprocess.TimeoutExpired):
            return NOT_PRINTED
        if done.returncode != 0 or not printed.is_file():
            return NOT_PRINTED
        with written_whole(pdf) as part:
            shutil.copyfile(printed, part)
    return ""


def browser_rights() -> Sequence[str]:
    """Arguments without which Chromium does not run as root, as in containers: there it has no sandbox."""
    is_root = hasattr(os, "getuid") and os.getuid() == 0
    return ("--no-sandbox",) if is_root else ()
