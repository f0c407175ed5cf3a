"""The error for problems that the user can fix, such as an extra that is not installed."""

from collections.abc import Generator
from contextlib import contextmanager
from typing import Final

TRAINING: Final = ("torch", "sklearn", "joblib")  # packages of the extra ``train``

BAD_GL: Final = "environment variable MUJOCO_GL"  # in the error of MuJoCo where its value is unknown


class UserError(Exception):
    """Raised for problems the user can fix.

    The message is one sentence that names the file, the episode or the field, and says what to do.
    The command line prints it without a traceback and exits with code 2.
    """


@contextmanager
def naming_extras() -> Generator[None]:
    """Turn the lack of a package of the extra ``train``, or an unknown ``MUJOCO_GL``, into a `UserError`."""
    try:
        yield
    except ModuleNotFoundError as error:
        if error.name not in TRAINING:
            raise
        raise UserError(
            f"This needs {error.name}, which is not installed: pip install 'latentarm[train]'."
        ) from error
    except RuntimeError as error:
        if BAD_GL not in str(error):
            raise
        raise UserError(
            f"MuJoCo does not load ({error}): unset it, or set it to egl, osmesa or glfw."
        ) from error
