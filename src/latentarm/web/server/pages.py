"""The pages as NiceGUI serves them: semantic HTML, to whose ids the modules in ``pages/`` attach."""

import re
from dataclasses import dataclass
from html import escape
from importlib.resources import files
from typing import Final, final

from nicegui import ui

_STATIC: Final = files("latentarm.web").joinpath("pages")
_PART: Final = re.compile(r"\{([a-z_/]+\.html)\}")
"""Where a page holds what others hold too: the name of a file in ``pages/``."""


@final
@dataclass(frozen=True)
class Page:
    """One page of the site.

    Attributes:
        path: where it is served.
        title: its name in the navigation and in the browser's title.
        fragment: the file in ``pages/`` that holds its body.
        script: its module in ``pages/``.
        styles: its style sheets in ``pages/``, besides the common ones.
    """

    path: str
    title: str
    fragment: str
    script: str
    styles: tuple[str, ...] = ()


PAGES = (
    Page("/", "Drive", "drive/drive.html", "drive/drive.js", ("layout/controls.css", "drive/drive.css")),
    Page(
        "/personalise",
        "Personalise",
        "personalise/personalise.html",
        "personalise/personalise.js",
        ("layout/controls.css", "personalise/personalise.css"),
    ),
    Page("/teach", "Teach", "teach/teach.html", "teach/teach.js", ("layout/controls.css", "teach/teach.css")),
)

_COMMON_STYLES = ("layout/tokens.css", "layout/page.css")


def add_pages(pages: tuple[Page, ...] = PAGES) -> None:
    """Register every page with NiceGUI. ``/static`` must serve the package's ``pages`` folder."""
    for page in pages:
        _add_page(page, pages)


def _add_page(page: Page, pages: tuple[Page, ...]) -> None:
    @ui.page(page.path, title=f"{page.title} · latentarm", language="en-US", dark=None)
    def build() -> None:  # pyright: ignore[reportUnusedFunction]
        for style in (*_COMMON_STYLES, *page.styles):
            ui.add_head_html(f'<link rel="stylesheet" href="/static/{style}">')
        # Beside NiceGUI's own application and not inside it: nobody may redraw a page that drives.
        ui.add_body_html(body_of(page, pages))
        ui.add_body_html(f'<script type="module" src="/static/{page.script}"></script>')


def body_of(page: Page, pages: tuple[Page, ...]) -> str:
    """A page's HTML, with the navigation that leads to the others.

    Args:
        page: this page.
        pages: all of them, in the order of the navigation.

    Returns:
        What goes into the body.
    """
    links = "".join(
        f'<a href="{escape(other.path)}"{_current(other is page)}>{escape(other.title)}</a>'
        for other in pages
    )
    return _PART.sub(lambda name: _text(name[1]), _text(page.fragment)).replace("{pages}", links)


def _text(fragment: str) -> str:
    return _STATIC.joinpath(fragment).read_text(encoding="utf-8")


def _current(is_this: bool) -> str:
    return ' aria-current="page"' if is_this else ""
