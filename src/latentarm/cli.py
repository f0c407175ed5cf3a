"""The command line: assembles the commands and turns their errors into exit codes.

Exit codes: 0 done, 1 not reached or failed, 2 a problem that the user can fix, 130 interrupted.
"""

import io
import os
import sys
import warnings
from collections.abc import Sequence

import tyro
from tyro.extras import SubcommandApp

from latentarm import __version__
from latentarm.commands.align import align
from latentarm.commands.bench import bench
from latentarm.commands.compare import compare
from latentarm.commands.configuration import Command, configurable, file_named_in, read_options
from latentarm.commands.demo import demo
from latentarm.commands.drive import drive
from latentarm.commands.evaluate import evaluate
from latentarm.commands.export import export
from latentarm.commands.import_demonstrations import import_demonstrations
from latentarm.commands.inspect import inspect
from latentarm.commands.reproduce_alignment import alignment
from latentarm.commands.reproduce_properties import properties
from latentarm.commands.reproduce_shared_autonomy import shared_autonomy
from latentarm.commands.robots import robots
from latentarm.commands.teleop import teleop
from latentarm.commands.train import train
from latentarm.errors import UserError
from latentarm.untrusted.terminal import one_line

COMMANDS: dict[str, Command] = {
    "demo": demo,
    "import": import_demonstrations,
    "inspect": inspect,
    "train": train,
    "evaluate": evaluate,
    "compare": compare,
    "align": align,
    "drive": drive,
    "teleop": teleop,
    "export": export,
    "reproduce properties": properties,
    "reproduce shared-autonomy": shared_autonomy,
    "reproduce alignment": alignment,
    "bench": bench,
    "robots": robots,
}
"""Every command by the words that run it, in the order of the help."""

GROUPS = {"reproduce": "Reproduce a study of the paper; `reproduce --help` lists them."}
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
        # Whoever read our output has heard enough; there is nobody left to flush it to.
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return 0
    except OSError as error:
        return _refuse(f"{error.filename or 'The output'} cannot be used: {error.strerror or error}.")
    except KeyboardInterrupt:
        print("latentarm: interrupted.", file=sys.stderr)
        return 130


def _app(words: Sequence[str]) -> SubcommandApp:
    """All commands, and the one that is to run with defaults from its ``--config``.

    Raises:
        UserError: that file is not one of options of that command.
    """
    app = SubcommandApp()
    groups: dict[str, SubcommandApp] = {}
    for name, command in COMMANDS.items():
        group, _, last = name.rpartition(" ")
        if group and group not in groups:
            groups[group] = app.command(SubcommandApp(), name=group, help=GROUPS[group])
        file = file_named_in(words) if list(words[: len(name.split())]) == name.split() else None
        defaults = {} if file is None else read_options(file, command, name)
        (groups[group] if group else app).command(name=last)(configurable(command, name, defaults))
    return app


def _refuse(sentence: str) -> int:
    """Say what the user can mend; the exit code for that."""
    print(f"latentarm: {one_line(sentence)}", file=sys.stderr)
    return 2


def _warn(message: Warning | str, *where: object) -> None:
    """A warning as the sentence that it is, without the line of code that gave it."""
    print(f"latentarm: warning: {one_line(str(message))}", file=sys.stderr)


if __name__ == "__main__":
    sys.exit(main())
