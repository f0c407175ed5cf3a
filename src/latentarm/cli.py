"""The command line: assembles the commands and turns their errors into exit codes.

Exit codes: 0 done, 1 not reached or failed, 2 a problem that the user can fix, 130 interrupted (`__main__`).
"""

import io
import os
import sys
import warnings
from collections.abc import Sequence
from typing import Final

import tyro
from tyro.extras import SubcommandApp

from latentarm import __version__
from latentarm.commands.catalogue import COMMAND_SETS, all_commands
from latentarm.commands.configuration import configurable, file_named_in, read_options
from latentarm.core.errors import UserError, naming_extras
from latentarm.core.untrusted.terminal import one_line

_BESIDES: Final = (
    "Demo, simulated drives, studies with people, the paper's studies and benchmarks are in"
    " latentarm-research: pip install 'latentarm[research]', or ./research in a clone."
)


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
        with warnings.catch_warnings(), naming_extras():
            warnings.showwarning = _warn
            code = _app(words).cli(
                prog="latentarm",
                description=_description(),
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


def _app(words: Sequence[str]) -> SubcommandApp:
    """Return all commands; the one to run has its defaults from ``--config``.

    Raises UserError where the file does not hold options of that command.
    """
    app, known = SubcommandApp(), all_commands()
    groups: dict[str, SubcommandApp] = {}
    for name, entry in known.commands.items():
        group, _, last = name.rpartition(" ")
        if group and group not in groups:
            groups[group] = app.command(SubcommandApp(), name=group, help=known.groups[group])
        add = (groups[group] if group else app).command
        if list(words[: len(name.split())]) == name.split():
            command = entry.load()
            file = file_named_in(words)
            defaults = {} if file is None else read_options(file, command, name)
            add(name=last)(configurable(command, name, defaults))
        else:
            add(name=last, help=entry.summary)(_never_run)
    unknown = bool(words) and words[0] not in {name.split()[0] for name in known.commands}
    if unknown and not words[0].startswith("-") and "research" not in COMMAND_SETS:
        raise UserError(f"There is no command {words[0]!r} here. {_BESIDES}")
    return app


def _description() -> str:
    """The program in a sentence, and the extra to install where the research is missing."""
    more = "" if "research" in COMMAND_SETS else f" {_BESIDES}"
    return (
        "Steer a high-DoF assistive arm with a low-DoF input, by latent actions. "
        f"`latentarm --version` prints the version.{more}"
    )


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
