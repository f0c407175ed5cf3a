"""The pages of a study itself: information, practice, trials, questions, and the code."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any, Final, final

from jinja2 import Environment, FileSystemLoader, StrictUndefined
from markdown_it import MarkdownIt
from starlette.requests import Request
from starlette.responses import FileResponse, HTMLResponse, Response

from latentarm.core.untrusted.documents import parse_object
from latentarm.web.server.answers import NO_STORE
from latentarm.web.server.assets import FOLDER, Assets
from latentarm_research.user_studies.answers.items import items_of
from latentarm_research.user_studies.questionnaire import LONGEST_TEXT
from latentarm_research.user_studies.serving.device import Device, shortfalls
from latentarm_research.user_studies.serving.options import PAGES, Serving
from latentarm_research.user_studies.serving.page_drive import ToDrive
from latentarm_research.user_studies.serving.store import Standing
from latentarm_research.user_studies.serving.way import ToAnswer, Way

HOME: Final = "/study"
FILES: Final = ("study.js", "study_device.js", "study_switch.js", "study.css")  # beside the template


@final
class ParticipantPages:
    """Renders the pages."""

    def __init__(self, serving: Serving, way: Way, assets: Assets) -> None:
        self._serving = serving
        self._way = way
        templates = Environment(
            loader=FileSystemLoader((PAGES, FOLDER)),
            autoescape=True,
            undefined=StrictUndefined,
            trim_blocks=True,
        )
        always = {
            "definition": serving.definition,
            "contact": serving.kept.contact,
            "home": HOME,
            "asset": assets.path,
            "modules": assets.path("layout/words.js").removesuffix("/layout/words.js"),
            "words": serving.words.texts,
            "language": serving.words.language,
            "say": serving.words.say,
        }
        self._information = MarkdownIt("commonmark", {"html": False}).render(serving.information)
        self._template = templates.get_template("study.html", globals=always)

    def page(self, name: str, *, status: int = 200, **shown: Any) -> Response:
        """A page; ``name`` is that of a part of the template, and ``shown`` what it needs."""
        return HTMLResponse(self._template.render(name=name, shown=shown), status, headers=NO_STORE)

    def consent(self) -> Response:
        """The information that people consent to."""
        return self.page("consent", information=self._information, digest=self._serving.kept.information)

    def device(self, found: Mapping[str, Any]) -> Response:
        """The check of their device; ``found`` is what the last one found, empty before."""
        serving = self._serving
        if not found:
            return self.page("device", short=())
        device = Device.model_validate(found, strict=False)
        return self.page("device", short=tuple(shortfalls(serving.definition.device, device, serving.words)))

    def comprehension(self, *, again: bool) -> Response:
        """The questions about the information; ``again`` says that some answers were wrong."""
        return self.page("comprehension", information=self._information, again=again)

    def compare(self, number: int) -> Response:
        """The comparison of all conditions, for the person with this number."""
        return self.page("compare", ways=len(self._way.order(number)))

    def due(self, due: ToDrive | ToAnswer, standing: Standing, *, running: bool) -> Response:
        """The page of the next step for a person with a place; ``running``: they have a drive in progress."""
        shown: dict[str, Any] = {"place": due.order + 1, "of": len(self._way.order(standing.number or 0))}
        if isinstance(due, ToAnswer):
            items = items_of(self._serving.definition)
            asked = [(name, items[name][1].text, items[name][0]) for name in due.items if name in items]
            return self.page("questions", **shown, order=due.order, asked=asked, longest=LONGEST_TEXT)
        before = standing.drives[-1] if due.attempt else None
        failed = before is not None and not before.trace.success
        full = before is not None and before.ending == "record_full"
        return self.page(due.kind, **shown, due=due, running=running, failed=failed, full=full)


def own_data(kept: dict[str, list[dict[str, Any]]]) -> dict[str, list[dict[str, Any]]]:
    """A person's rows of all tables, for them: with their conditions only once they have finished."""
    for row in kept["drives"]:
        row["record"] = parse_object(row["record"], "A drive")
    if any(row["completion"] is None for row in kept["people"]):
        for row in kept["drives"]:
            del row["record"]["condition"], row["record"]["trace"]["condition"]
        for row in kept["answers"]:
            del row["condition"]
    return kept


async def answer_file(request: Request) -> Response:
    """The script and the style sheet of the pages."""
    return FileResponse(PAGES / Path(request.url.path).name, headers=NO_STORE)
