"""Sources of where things are, by name: ours, and those that other distributions register."""

from collections.abc import Callable, Sequence
from typing import Final, cast

from latentarm.core.errors import UserError
from latentarm.core.plugins import Catalogue
from latentarm.surroundings.contract import Source

SourceFactory = Callable[[str, Sequence[str]], Source]
"""Opens a source by the text that follows ``NAME:`` in ``--objects``, for the things of these names. Raises
UserError where the text is malformed, or what it names cannot be opened."""


def _factory(name: str, thing: object) -> SourceFactory:
    if not callable(thing):
        raise TypeError(f"{thing!r} is not a function that opens a source of where things are")
    return cast(SourceFactory, thing)


SOURCES: Final[Catalogue[SourceFactory]] = Catalogue(
    "latentarm.surroundings",
    "source of where things are",
    {
        "http": "latentarm.surroundings.http:open_http",
        "ros2": "latentarm.surroundings.ros2:open_ros2",
        "tags": "latentarm.surroundings.tags:open_tags",
    },
    _factory,
)

TOUCH: Final = "touch"
"""Not opened: a person who brings the tool to a thing may always say so."""

SCENE: Final = "scene"
"""Not opened: a simulation, as recordings name it."""


def check_source(text: str) -> None:
    """Check what ``--objects`` names, without opening it."""
    if text == TOUCH:
        return
    name, colon, _ = text.partition(":")
    SOURCES.find(name, "--objects")
    if not colon:
        raise UserError(
            f"--objects {text} does not say where: write {name}:..., see `latentarm guide objects`."
        )


def open_source(text: str, names: Sequence[str]) -> Source:
    """Open the source that a text such as ``http:8470`` names, for the things of these names."""
    check_source(text)
    name, _, rest = text.partition(":")
    return SOURCES[name](rest, names)
