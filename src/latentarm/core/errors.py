"""The error for problems that the user can fix, such as an extra that is not installed."""

from collections.abc import Generator
from contextlib import contextmanager
from typing import Final

TRAINING: Final = ("torch", "sklearn", "joblib")  # packages of the extra ``train``


class UserError(Exception):
    """Raised for problems the user can fix.

    The message is one sentence that names the file, the episode or the field, and says what to do.
    The command line prints it without a traceback and exits with code 2.
    """


@contextmanager
def naming_extras() -> Generator[None]:
    """Turn the lack of a package of the extra ``train`` into a `UserError`."""
    try:
        yield
    except ModuleNotFoundError as error:
        if error.name not in TRAINING:
            raise
        raise UserError(
            f"This needs {error.name}, which is not installed: pip install 'latentarm[train]'."
        ) from error
