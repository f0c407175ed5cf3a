"""A study's ``results.md``, rendered from the Jinja template in its package."""

import re
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Any, Final

from jinja2 import Environment, FileSystemLoader, StrictUndefined

from latentarm.evaluation.looks import look_of
from latentarm.evaluation.table import ABSENT

STUDIES: Final = Path(__file__).parent

SMOKE: Final = "smoke"
"""The preset of every study that only shows that it runs: its hypotheses are not judged."""


def render_page(template: str, preset: Any, **content: Any) -> str:
    """A page from its template.

    Templates have the filters ``label`` (of a model, a condition or a task), ``literal`` (as code),
    ``listed`` (``A, B and C``), ``g`` (a number without trailing zeros), ``image`` (a figure by its name) and
    ``plain`` (see `plain`); ``table`` is `plain_table`.

    Args:
        template: path below `STUDIES`, such as ``properties/page.md``, or below the package.
        preset: of the study.
        content: what the template names.
    """
    # Markdown, not HTML: nothing is to be escaped.
    environment = Environment(  # noqa: S701
        loader=FileSystemLoader((STUDIES, STUDIES.parent), encoding="utf-8"),
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
        keep_trailing_newline=True,
    )
    environment.filters.update(label=_label, literal="`{}`".format, listed=listed, g=_short, image=_image)
    environment.filters.update(plain=plain)
    judged = preset.name != SMOKE
    page = environment.get_template(template).render(content, table=plain_table, preset=preset, judged=judged)
    return page if judged else page.replace("\n", f" (preset {SMOKE})\n", 1)


def markdown_table(head: Sequence[str], lines: Iterable[Sequence[str | None]]) -> str:
    """A GitHub table; all columns but the first to the right, and a dash for what is None."""
    rule = ["---", *("---:" for _ in head[1:])]
    texts = [[ABSENT if text is None else text for text in line] for line in (head, rule, *lines)]
    return "\n".join("| " + " | ".join(line) + " |" for line in texts) + "\n"


def plain(text: str) -> str:
    """Text in one line that Markdown shows as it is: a stranger's, such as a name in a definition."""
    return re.sub(r"[\\`*_|\[\]]|<(?=[a-zA-Z/!?])|&(?=[a-zA-Z#])", r"\\\g<0>", " ".join(text.split()))


def plain_table(head: Sequence[str], lines: Iterable[Sequence[str]]) -> str:
    """A GitHub table of cells that are shown as they are, all to the left."""
    texts = [[plain(text) for text in line] for line in (head, *lines)]
    texts.insert(1, ["---"] * len(head))
    return "\n".join("| " + " | ".join(line) + " |" for line in texts) + "\n"


def listed(names: Iterable[str]) -> str:
    """``A, B and C``, each once; empty for none."""
    each = list(dict.fromkeys(names))
    return " and ".join(filter(None, (", ".join(each[:-1]), *each[-1:])))


def _label(name: str) -> str:
    return look_of(name).label


def _short(number: float) -> str:
    return f"{number:g}"


def _image(name: str) -> str:
    return f"![{name.replace('_', ' ')}, simulated]({name}.png)"
