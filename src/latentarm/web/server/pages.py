"""The pages: HTML rendered by Jinja2 from the templates in ``pages/``, once per language."""

import hashlib
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass
from typing import Final, final

from jinja2 import Environment, FileSystemLoader, StrictUndefined
from starlette.requests import Request
from starlette.responses import HTMLResponse, Response

from latentarm.core.errors import UserError
from latentarm.models.catalogue import KINDS
from latentarm.web.server.assets import FOLDER, Assets
from latentarm.web.words.catalogue import COOKIE, Words, chosen_language, languages


@final
@dataclass(frozen=True)
class Page:
    """One page of the site."""

    path: str
    name: str  # of its folder in ``pages/``, of the template, script and style sheet there, and of its words

    @property
    def script(self) -> str:
        return f"{self.name}/{self.name}.js"

    @property
    def styles(self) -> tuple[str, ...]:
        """Paths of the style sheets, in the order in which they apply."""
        return "layout/tokens.css", "layout/page.css", "layout/controls.css", f"{self.name}/{self.name}.css"


PAGES: Final = (
    Page("/", "drive"),
    Page("/personalise", "personalise"),
    Page("/fit", "fit"),
    Page("/teach", "teach"),
    Page("/people", "people"),
    Page("/history", "history"),
)
LOCKED: Final = ("personalise", "fit", "teach")


@final
class Pages:
    """Every page in every language.

    ``models`` are names in the catalogue, in the order of the Teach page; ``cameras`` names of the cameras;
    ``locked``: whether the host has locked Set up, which leaves out the pages in `LOCKED`. ``fixed``: whether
    it is decided what is driven and how, as in a study, which leaves the page Drive alone.
    """

    def __init__(
        self,
        assets: Assets,
        models: Sequence[str],
        cameras: Sequence[str] = (),
        *,
        locked: bool = False,
        fixed: bool = False,
    ) -> None:
        found = PAGES[:1] if fixed else PAGES
        self.all = tuple(page for page in found if not (locked and page.name in LOCKED))
        templates = Environment(
            loader=FileSystemLoader(FOLDER), autoescape=True, undefined=StrictUndefined, trim_blocks=True
        )
        self._html = {
            (page.path, words.language): templates.get_template(f"{page.name}/{page.name}.html")
            .render(
                page=page,
                pages=self.all,
                locked=locked,
                fixed=fixed,
                asset=assets.path,
                cameras=cameras,
                modules=assets.modules(page.script),
                language=words.language,
                languages=list(languages().values()),
                models=[_choice(model, words) for model in models],
                say=words.say,
                words=words.texts,
            )
            .encode()
            for page in self.all
            for words in languages().values()
        }

    async def answer(self, request: Request) -> Response:
        """Serve one of `all` in the visitor's language."""
        words = chosen_language(request.cookies.get(COOKIE, ""), request.headers.get("accept-language", ""))
        html = self._html[request.url.path, words.language]
        headers = {
            "cache-control": "private, no-cache",
            "content-language": words.language,
            "etag": f'"{hashlib.sha256(html).hexdigest()[:16]}"',
            "vary": "accept-language, cookie",
        }
        if request.headers.get("if-none-match") == headers["etag"]:
            return Response(status_code=304, headers=headers)
        return HTMLResponse(html, headers=headers)


def _choice(model: str, words: Words) -> dict[str, str]:
    """A model's name, its title and when to use it: from the page's texts, else from its plug-in."""
    if f"model.{model}" in words.texts:
        return {"name": model, "title": words.say(f"model.{model}"), "help": words.say(f"model.{model}.help")}
    title, about = model, ""
    with suppress(UserError):  # said when somebody chooses it
        title, about = KINDS[model].label, KINDS[model].description
    return {"name": model, "title": title, "help": about or words.say("model.plugin.help")}
