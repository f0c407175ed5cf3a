"""A study's folder: claimed before any work is done, and what is written to it."""

import json
import platform
from collections.abc import Mapping
from dataclasses import dataclass
from importlib.metadata import version
from pathlib import Path
from typing import Final

from latentarm.errors import UserError
from latentarm.files import write_text
from latentarm.runs.folder import git_commit
from latentarm.untrusted.documents import read_object

CONFIG: Final = "config.json"
"""What was asked for; it is written first and tells a study's folders from others."""

PACKAGES: Final = ("latentarm", "numpy", "scikit-learn", "scipy", "statsmodels", "torch")
"""Those whose versions the figures may hang on."""


@dataclass(frozen=True)
class Study:
    """A study as its folder knows it.

    Attributes:
        name: as in `CONFIG` and in every row of ``results.json``.
        made: every file that it may write, beside `CONFIG`.
    """

    name: str
    made: tuple[str, ...]

    def claim(self, out: Path, about: Mapping[str, object]) -> None:
        """Make room for a new run: an earlier one is removed, anything else is left alone.

        Args:
            out: the folder.
            about: what the figures depend on; goes to `CONFIG` with the versions of what computes them.

        Raises:
            UserError: the folder holds something that this study did not write, or cannot be written.
        """
        if out.exists() and not (out.is_dir() and (self._wrote(out) or not any(out.iterdir()))):
            raise UserError(
                f"{out} is there already and is no earlier run of this study: choose another folder with"
                " --out."
            )
        if out.exists():
            for name in self.made:
                (out / name).unlink(missing_ok=True)
        versions = {
            "python": platform.python_version(),
            **{package: version(package) for package in PACKAGES},
        }
        write_json(out / CONFIG, {**about, "versions": versions, "git_commit": git_commit()})

    def _wrote(self, out: Path) -> bool:
        """Whether a folder says of itself that it is of this study."""
        try:
            return read_object(out / CONFIG).get("study") == self.name
        except UserError:
            return False


def write_json(path: Path, document: object) -> None:
    """Write a document as JSON, whole or not at all.

    Raises:
        UserError: the file cannot be written.
        ValueError: a figure is NaN or infinite, which JSON does not have.
    """
    write_text(path, json.dumps(document, indent=2, allow_nan=False) + "\n")
