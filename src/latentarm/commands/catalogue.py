"""The commands by the words that run them: ours, and those that other distributions register.

A distribution registers a `CommandSet` as an entry point of the group ``latentarm.commands``. Only the
module of the command that runs is imported.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from pkgutil import resolve_name
from typing import Final, final
from warnings import warn

from latentarm.commands.configuration import Command
from latentarm.core.plugins import Catalogue, PluginWarning


@final
@dataclass(frozen=True)
class CommandEntry:
    """A command as the command line lists it."""

    place: str  # its function, as ``package.module:function``
    summary: str

    def load(self) -> Command:
        """The function."""
        return resolve_name(self.place)


@final
@dataclass(frozen=True)
class CommandSet:
    """Commands of one distribution."""

    commands: Mapping[str, CommandEntry]  # by the words that run each, in the order of the help
    groups: Mapping[str, str]  # words that have commands under them, and their help


def _ours(module: str, summary: str) -> CommandEntry:
    return CommandEntry(f"latentarm.commands.{module}", summary)


OWN: Final = CommandSet(
    {
        "import": _ours(
            "import_demonstrations:import_demonstrations",
            "Turn recorded demonstrations into a native dataset (LeRobotDataset v3.0).",
        ),
        "inspect": _ours(
            "inspect:inspect", "Show a dataset: episodes, rates, ranges, and a figure of the joints."
        ),
        "train": _ours("train:train", "Learn a latent action model from a dataset."),
        "evaluate": _ours(
            "evaluate:evaluate",
            "Measure a trained model on held-out episodes: four properties, drift, reversal, and a verdict.",
        ),
        "align": _ours(
            "align:align",
            "Ask what a person means by their input, and keep it as their profile (section 6 of the paper).",
        ),
        "teleop": _ours(
            "teleop:teleop",
            "Drive an arm from a web page, simulated or real: stick, buttons, keyboard, gamepad or switches.",
        ),
        "export": _ours(
            "export:export",
            "List what was recorded, and export it to a native dataset (LeRobotDataset v3.0) or to MCAP.",
        ),
        "replay": _ours(
            "replay:replay",
            "Decide again what an arm was commanded on the page, and compare every command to the bit.",
        ),
        "report": _ours(
            "report:report",
            "Pack what happened into one file: versions, settings, stops, readings, commands, logs.",
        ),
        "doctor": _ours(
            "doctor:doctor",
            "Look at this computer: priority, cores, pauses, clock, disk, GL, and the port; and at an arm.",
        ),
        "arms list": _ours(
            "arms:list_arms",
            "List what `--arm` takes: simulated arms by name, real ones by the scheme of their address.",
        ),
        "arms check": _ours(
            "arms:check",
            "Look at a real arm without moving it: what it is, whether it can be driven, and if not, why.",
        ),
        "calibrate board": _ours(
            "calibrate:print_board",
            "Write a board to print at its true size; measure a square, and glue it to something flat.",
        ),
        "calibrate intrinsics": _ours(
            "calibrate:intrinsics",
            "Find the optics of a camera from 10 or more pictures of a board.",
        ),
        "calibrate hand-eye": _ours(
            "calibrate:hand_eye",
            "Find where a camera is, from pictures of the board at 12 or more poses of the arm.",
        ),
        "guide": _ours("guide:guide", "Print a page about arms, or a file that it names."),
        "robots": _ours("robots:robots", "List the robots, or show one: joints, limits and end-effector."),
    },
    {
        "arms": "List what can be driven, and look at a real arm before it moves; `arms --help` lists how.",
        "calibrate": "Calibrate the cameras of `--objects tags`; `calibrate --help` lists how.",
    },
)


def _checked(name: str, thing: object) -> CommandSet:
    if not isinstance(thing, CommandSet):
        raise TypeError(f"{thing!r} is no latentarm.commands.catalogue.CommandSet")
    return thing


COMMAND_SETS: Final = Catalogue("latentarm.commands", "set of commands", {}, _checked)
"""Those of other distributions."""


def all_commands() -> CommandSet:
    """Our commands, and then those of other distributions.

    Warns:
        PluginWarning: for each command left out, because its words are taken or its group is missing.
    """
    commands, groups = dict(OWN.commands), dict(OWN.groups)
    for name, added in COMMAND_SETS.usable().items():
        groups = {**added.groups, **groups}
        for words, entry in added.commands.items():
            group = words.rpartition(" ")[0]
            if words in commands:
                _leave_out(name, words, "there is one already")
            elif group and group not in groups:
                _leave_out(name, words, f"there is no group '{group}'")
            else:
                commands[words] = entry
    return CommandSet(commands, groups)


def _leave_out(name: str, words: str, reason: str) -> None:
    warn(PluginWarning(f"The command '{words}' of the set '{name}' is left out: {reason}."), stacklevel=3)
