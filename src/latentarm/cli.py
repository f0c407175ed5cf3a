"""The command line: assembles the commands and turns their errors into exit codes.

Exit codes: 0 done, 1 not reached or failed, 2 a problem that the user can fix, 130 interrupted.
"""

import io
import os
import sys
import warnings
from collections.abc import Sequence
from importlib import import_module

import tyro
from tyro.extras import SubcommandApp

from latentarm import __version__
from latentarm.commands.configuration import Command, configurable, file_named_in, read_options
from latentarm.errors import UserError
from latentarm.studies.catalogue import STUDIES
from latentarm.untrusted.terminal import one_line

COMMANDS: dict[str, tuple[str, str]] = {
    "demo": (
        "demo:demo",
        "Learn latent actions and stab marshmallows with a 7-DoF Panda in physics, against mode switching.",
    ),
    "import": (
        "import_demonstrations:import_demonstrations",
        "Turn recorded demonstrations into a native dataset (LeRobotDataset v3.0).",
    ),
    "inspect": (
        "inspect:inspect",
        "Show a dataset: episodes, rates, ranges, and a figure of the joints.",
    ),
    "train": (
        "train:train",
        "Learn a latent action model from a dataset.",
    ),
    "evaluate": (
        "evaluate:evaluate",
        "Measure a trained model on held-out episodes: four properties, drift, reversal, and a verdict.",
    ),
    "compare": (
        "compare:compare",
        "Compare all models on recorded demonstrations, with every episode held out once.",
    ),
    "align": (
        "align:align",
        "Ask what a person means by their input, and keep it as their profile (section 6 of the paper).",
    ),
    "drive": (
        "drive:drive",
        "Drive an arm in simulation with a simulated operator, through Algorithm 1 and its safety filters.",
    ),
    "teleop": (
        "teleop:teleop",
        "Drive an arm from a web page, simulated or real: stick, buttons, keyboard, gamepad or switches.",
    ),
    "export": (
        "export:export",
        "List what was recorded, and export it to a native dataset (LeRobotDataset v3.0).",
    ),
    "replay": (
        "replay:replay",
        "Decide again what an arm was commanded on the page, and compare every command to the bit.",
    ),
    **{f"reproduce {name}": (f"reproduce:{name}", entry.summary) for name, entry in STUDIES.items()},
    "study list": (
        "study:list_studies",
        "List the paper's user studies.",
    ),
    "study show": (
        "study:show_study",
        "Show a study's definition: conditions, tasks, hypotheses with their tests, and its hash.",
    ),
    "study run": (
        "study:run_study",
        "Send simulated people through a study, analyse their trials, and write the report.",
    ),
    "study power": (
        "study:power_of_study",
        "Find how many people a study needs: studies drawn from simulated people, through its own analysis.",
    ),
    "study questions": (
        "study_answers:questions",
        "Write a study's questionnaire: after each condition all items, in a random order for each person.",
    ),
    "study analyse": (
        "study_answers:analyse_study",
        "Analyse recorded trials, with the answers of real people, and write the report.",
    ),
    "bench": (
        "bench:bench",
        "Time the online step, and training ten seeds in one fit and one after the other.",
    ),
    "arms list": (
        "arms:list_arms",
        "List what `--arm` takes: simulated arms by name, real ones by the scheme of their address.",
    ),
    "arms check": (
        "arms:check",
        "Look at a real arm without moving it: what it is, whether it can be driven, and if not, why.",
    ),
    "robots": (
        "robots:robots",
        "List the robots, or show one: joints, limits and end-effector.",
    ),
}
"""Every command by the words that run it, in the order of the help.

Its module and function in `latentarm.commands`, or its study, and the first line of its help; only the
module of the command that runs is imported.
"""

GROUPS = {
    "arms": "List what can be driven, and look at a real arm before it moves; `arms --help` lists how.",
    "reproduce": "Reproduce a study of the paper; `reproduce --help` lists them.",
    "study": "Send simulated people through the paper's user studies; `study --help` lists how.",
}
"""Words that have commands under them, and their help."""


def main(arguments: Sequence[str] | None = None) -> int:
    """Run one command.

    Args:
        arguments: the words after ``latentarm``; those of the process by default.

    Returns:
        The exit code.
    """
    if isinstance(sys.stdout, io.TextIOWrapper):
        sys.stdout.reconfigure(errors="replace")  # a terminal without "±" or "…" shows "?" instead
    words = sys.argv[1:] if arguments is None else list(arguments)
    if words == ["--version"]:
        print(f"latentarm {__version__}")
        return 0
    try:
        with warnings.catch_warnings():
            warnings.showwarning = _warn
            code = _app(words).cli(
                prog="latentarm",
                description="Steer a high-DoF assistive arm with a low-DoF input, by latent actions. "
                "`latentarm --version` prints the version.",
                args=words,
                config=(tyro.conf.FlagCreatePairsOff,),
            )
            sys.stdout.flush()  # a full disk shows here and not after the exit code
            return code
    except UserError as error:
        return _refuse(str(error))
    except BrokenPipeError:
        # The reader closed the pipe, as `head` does; there is nothing left to flush to.
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return 0
    except OSError as error:
        return _refuse(f"{error.filename or 'The output'} cannot be used: {error.strerror or error}.")
    except KeyboardInterrupt:
        print("latentarm: interrupted.", file=sys.stderr)
        return 130


def _app(words: Sequence[str]) -> SubcommandApp:
    """Return all commands; the one to run has its defaults from ``--config``.

    Raises:
        UserError: the file does not hold options of that command.
    """
    app = SubcommandApp()
    groups: dict[str, SubcommandApp] = {}
    for name, (place, summary) in COMMANDS.items():
        group, _, last = name.rpartition(" ")
        if group and group not in groups:
            groups[group] = app.command(SubcommandApp(), name=group, help=GROUPS[group])
        add = (groups[group] if group else app).command
        if list(words[: len(name.split())]) == name.split():
            command = _load(place)
            file = file_named_in(words)
            defaults = {} if file is None else read_options(file, command, name)
            add(name=last)(configurable(command, name, defaults))
        else:
            add(name=last, help=summary)(_never_run)
    return app


def _load(place: str) -> Command:
    """The function of a command, from ``module:function``, or from ``reproduce:study``."""
    module, _, name = place.partition(":")
    commands = import_module(f"latentarm.commands.{module}")
    return commands.command_of(name) if module == "reproduce" else getattr(commands, name)


def _never_run() -> int:
    """Placeholder for the commands that will not run."""
    raise AssertionError("a command ran that was not named")


def _refuse(sentence: str) -> int:
    """Say what the user can fix; the exit code for that."""
    print(f"latentarm: {one_line(sentence)}", file=sys.stderr)
    return 2


def _warn(message: Warning | str, *where: object) -> None:
    """Format a warning as its sentence alone, without the line of code that raised it."""
    print(f"latentarm: warning: {one_line(str(message))}", file=sys.stderr)


if __name__ == "__main__":
    sys.exit(main())
