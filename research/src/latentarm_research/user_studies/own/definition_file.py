"""A definition from a JSON file, of the form that ``definition.json`` in a run's folder has."""

from pathlib import Path
from typing import Final

from latentarm.core.errors import UserError
from latentarm.core.untrusted.documents import read_object
from latentarm_research.user_studies.catalogue import NAMES, load_definition
from latentarm_research.user_studies.definition import Definition
from latentarm_research.user_studies.own.checks import check_definition

SUFFIX: Final = ".json"


def find_definition(
    name: str,  # a name in `latentarm_research.user_studies.catalogue.NAMES`, or the path of a JSON file
) -> Definition:
    """The study of that name, or that of a file.

    Raises:
        UserError: there is no such study; or see `read_definition`.
    """
    if name in NAMES:
        return load_definition(name)
    if name.endswith(SUFFIX):
        return read_definition(Path(name))
    raise UserError(f"There is no study {name!r}: choose from {', '.join(NAMES)}, or name a {SUFFIX} file.")


def read_definition(
    path: Path,  # JSON; a field `digest`, if there is one, must be the definition's own
) -> Definition:
    """A definition from a file.

    Raises:
        UserError: the file cannot be read, or a field is wrong: a sentence that names it.
    """
    from latentarm_research.user_studies.own.records import (
        read_record,  # with pydantic, which help does not need
    )

    document = read_object(path)
    digest = document.pop("digest", None)
    definition = read_record(Definition, document, str(path))
    if digest is not None and digest != definition.digest:
        raise UserError(
            f"{path}: digest is not that of the definition, which was changed after it: leave the field out."
        )
    if definition.name in NAMES and definition != load_definition(definition.name):
        raise UserError(
            f"{path}: name {definition.name!r} is that of a study of the paper: choose another one."
        )
    try:
        check_definition(definition)
    except UserError as error:
        raise UserError(f"{path}: {error}") from error
    return definition
