"""The studies by name: what `latentarm reproduce` offers. Nothing is imported before a study runs."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from importlib import import_module
from typing import TYPE_CHECKING, Any, Final

from latentarm.tasks.catalogue import SCENE_TASKS

if TYPE_CHECKING:
    from latentarm_research.studies.study import Study


_PAPER: Final = "whole sizes"
_SMOKE: Final = "small ones that only show that it runs"


@dataclass(frozen=True)
class Entry:
    """A study as the command line lists it."""

    summary: str  # the first line of its help
    tasks: tuple[str, ...]  # names of all its tasks, as in its `Study`
    about_tasks: str  # what they are, in a few words
    # what each of its presets is, by its name in the `Study`
    presets: Mapping[str, str] = field(default_factory=lambda: {"paper": _PAPER, "smoke": _SMOKE})
    people: bool = False  # whether one can choose which simulated people drive, and how often


STUDIES: Final[Mapping[str, Entry]] = {
    "properties": Entry(
        "Measure the four properties of all models on the paper's planar tasks (section 8.1), simulated.",
        ("sine", "rotate", "circle", "reach"),
        "One of the tasks, or all four.",
    ),
    "shared-autonomy": Entry(
        "Let simulated people reach and change goals with help and without (section 8.2).",
        ("planar_two_cups", "panda_two_cups"),
        "Two cups in front of one of the arms, or of both.",
    ),
    "alignment": Entry(
        "Learn from few answers what simulated people mean by their stick (section 8.3).",
        ("plane", "pour", "reach_and_pour"),
        "One of the paper's tasks, or all three.",
    ),
    "tasks": Entry(
        "Let simulated people do tasks with things in physics, by mode switching and by latent actions.",
        (*SCENE_TASKS, "moved_marshmallows", "moved_reach_and_pour"),
        "One of the tasks, or all of them; in moved ones things stand where no demonstration had them.",
        {"paper": _PAPER, "small": "few runs and fewer demonstrations", "smoke": _SMOKE},
        people=True,
    ),
}


def load_study(name: str) -> "Study[Any, Any]":
    """The study of that name: ``STUDY`` in the package ``studies/<name>``, module ``study``."""
    return import_module(f"latentarm_research.studies.{name.replace('-', '_')}.study").STUDY
