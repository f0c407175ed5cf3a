"""Options from a YAML file, for every command, and the options of a run written next to its results.

The file gives a command other defaults: the command line is parsed on top of them, so what is typed wins,
and options that are otherwise required may come from the file.
"""

import difflib
import inspect
import json
import logging
from collections.abc import Callable, Mapping, Sequence
from contextvars import ContextVar
from dataclasses import fields, is_dataclass
from pathlib import Path
from types import UnionType
from typing import Annotated, Any, Final, cast, get_args, get_origin, get_type_hints

from tyro.conf import arg

from latentarm import __version__
from latentarm.core.errors import UserError
from latentarm.core.files import write_text
from latentarm.core.logs import LogSettings, logging_as

_LOG: Final = logging.getLogger(__name__)
Command = Callable[..., int]
ConfigFile = Annotated[
    Path | None,
    arg(
        metavar="FILE.yaml",
        help="Take options from a YAML file, by name: `seeds: 5`. The command line takes precedence.",
    ),
]

LogFile = Annotated[
    Path | None, arg(metavar="FILE", help="Add to this file when things happened, and errors in full.")
]
Verbose = Annotated[bool, arg(help="Show in the terminal what is logged, with details.")]

OPTION: Final = "config"
_ALWAYS: Final = {OPTION: (ConfigFile, None), "log_file": (LogFile, None), "verbose": (Verbose, False)}
"""Options of every command, each with its default."""

MOST_BYTES: Final = 1 << 16  # of a file of options
NOT_KEPT: Final = (*_ALWAYS, "json", "resume")
"""Options of reporting and resuming, which do not change results; they are not written."""

_ASKED: ContextVar[tuple[str, Mapping[str, object]] | None] = ContextVar("asked", default=None)
"""Name and options of the command that is running."""


def configurable(command: Command, name: str, defaults: Mapping[str, object]) -> Command:
    """A command with the options of all commands; defaults, by parameter, may come from ``--config``.

    ``name`` is the words that run it, such as ``reproduce properties``.
    """
    known = options_of(command)
    groups = _groups(command)

    def run(**options: Any) -> int:
        del options[OPTION]
        file, verbose = options.pop("log_file"), options.pop("verbose")
        _ASKED.set((name, dict(options)))
        for group, kind in groups.items():
            options[group] = kind(**{one.name: options.pop(one.name) for one in fields(kind)})
        with logging_as(LogSettings(verbose, () if file is None else (file,))):
            _LOG.info("latentarm %s: %s begins.", __version__, name)
            try:
                code = command(**options)
            except BaseException:
                _LOG.info("%s ends.", name, exc_info=True)
                raise
            _LOG.info("%s ends with code %d.", name, code)
            return code

    parameters = [one.replace(default=defaults.get(one.name, one.default)) for one in known.values()]
    always = [
        inspect.Parameter(one, inspect.Parameter.KEYWORD_ONLY, default=default, annotation=annotation)
        for one, (annotation, default) in _ALWAYS.items()
    ]
    run.__name__, run.__doc__ = command.__name__, command.__doc__
    run.__signature__ = inspect.Signature([*parameters, *always])  # pyright: ignore[reportFunctionMemberAccess]
    run.__annotations__ = {one.name: one.annotation for one in (*parameters, *always)}
    return run


def options_of(command: Command) -> dict[str, inspect.Parameter]:
    """A command's options by name: its parameters, and the fields of those that are dataclasses."""
    groups = _groups(command)
    hints = get_type_hints(command, include_extras=True)
    found: dict[str, inspect.Parameter] = {}
    for name, parameter in inspect.signature(command).parameters.items():
        if name in groups:
            found |= options_of(groups[name])
        else:
            found[name] = parameter.replace(kind=inspect.Parameter.KEYWORD_ONLY, annotation=hints[name])
    return found


def _groups(command: Command) -> dict[str, type[Any]]:
    """The parameters of a command that are dataclasses of options."""
    return {name: hint for name, hint in get_type_hints(command).items() if is_dataclass(hint)}  # pyright: ignore[reportReturnType]


def file_named_in(words: Sequence[str]) -> Path | None:
    """The file that ``--config`` names among the words of a command line, or None."""
    found = None
    for word, following in zip(words, [*words[1:], None], strict=True):
        if word == f"--{OPTION}" and following is not None:
            found = Path(following)
        elif word.startswith(f"--{OPTION}="):
            found = Path(word.partition("=")[2])
    return found


def read_options(path: Path, command: Command, name: str) -> dict[str, object]:
    """Options of a command, by parameter, from a YAML file.

    Raises UserError where the file cannot be read, is no mapping from option names to values, or has an
    option that the command lacks or whose value has another type.
    """
    from pydantic import TypeAdapter, ValidationError

    known = options_of(command)
    options: dict[str, object] = {}
    for key, value in _mapping_in(path).items():
        parameter = key.replace("-", "_")
        if parameter not in known:
            near = difflib.get_close_matches(parameter, known, n=1, cutoff=0.0)
            raise UserError(
                f"{path}: `latentarm {name}` has no option {key!r}; the nearest one is {near[0]!r}."
            )
        if parameter in options:
            raise UserError(f"{path}: the option {key!r} is given twice.")
        annotation = known[parameter].annotation
        if isinstance(value, str) and _is_tuple(annotation):
            value = [value]
        try:
            options[parameter] = TypeAdapter(annotation).validate_json(json.dumps(value), strict=True)
        except ValidationError as error:
            said = error.errors()[0]["msg"].replace("array", "list")
            raise UserError(f"{path}: the option {key!r} is {value!r}. {said}.") from error
    return options


def _is_tuple(annotation: object) -> bool:
    """Whether an option takes several values; one name may then stand for a list of one."""
    if get_origin(annotation) is Annotated:
        annotation = get_args(annotation)[0]
    kinds = get_args(annotation) if isinstance(annotation, UnionType) else (annotation,)
    return any(get_origin(kind) is tuple for kind in kinds)


def write_options(folder: Path, name: str, **resolved: object) -> None:
    """Write the options of the running command next to its results, so that ``--config`` can run it again.

    The file is ``<command>-options.yaml``. A command that another one calls writes nothing. ``out`` is
    written as the folder of the results; ``resolved`` has values that were chosen automatically.

    Raises UserError where the file cannot be written.
    """
    asked = _ASKED.get()
    if asked is None or asked[0] != name:
        return
    import yaml

    options = {key: value for key, value in asked[1].items() if key not in NOT_KEPT} | resolved
    if "out" in options:
        options["out"] = folder
    words = name.replace(" ", "-")
    path = folder / f"{words}-options.yaml"
    text = yaml.safe_dump({key: _plain(value) for key, value in options.items()}, sort_keys=False)
    head = f"# latentarm {__version__}; again: latentarm {name} --config {path.name}\n"
    write_text(path, head + text)


def _plain(value: object) -> object:
    """A value as YAML represents it."""
    if isinstance(value, Path):
        return str(value)
    if isinstance(value, tuple):
        return [_plain(entry) for entry in value]  # pyright: ignore[reportUnknownVariableType]
    return value


def _mapping_in(path: Path) -> dict[str, Any]:
    """The mapping from names to numbers, texts and lists of these in a YAML file; UserError for any other."""
    from latentarm.core.untrusted.opening import read_bytes
    from latentarm.core.untrusted.yaml_file import parse_yaml  # most commands get no file

    value = parse_yaml(read_bytes(path, MOST_BYTES), path, "a YAML file of options")
    if value is None:
        return {}
    if not isinstance(value, dict):
        raise UserError(f"{path} must have one option a line, such as `seed: 0`.")
    mapping = cast(dict[object, object], value)
    for key, entry in mapping.items():
        entries = cast(list[object], entry) if isinstance(entry, list) else [entry]
        if not isinstance(key, str):
            raise UserError(f"{path}: {key!r} is not the name of an option.")
        if not all(one is None or isinstance(one, str | bool | int | float) for one in entries):
            raise UserError(f"{path}: the option {key!r} must be a number, a string, or a list of these.")
    return cast(dict[str, Any], value)
