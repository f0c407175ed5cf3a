"""The folder of a command's results: claimed before any work is done, so that nothing is lost silently."""

import json
import platform
from collections.abc import Mapping
from dataclasses import dataclass
from importlib.metadata import version
from pathlib import Path
from typing import Any, Final, cast

from latentarm.core.errors import UserError
from latentarm.core.untrusted.documents import read_object
from latentarm.runs.folder import git_commit
from latentarm.runs.results_folder import refuse_other_results, vacant_name, write_json

CONFIG: Final = "config.json"  # the options; written first, and used to recognise a study's folders

PACKAGES: Final = ("latentarm", "numpy", "scikit-learn", "scipy", "statsmodels", "torch")
"""Packages on whose versions the figures may depend."""


@dataclass(frozen=True)
class ResultsFolder:
    """The folder of a study, or of a command with results of its own."""

    name: str  # as in `CONFIG` and in every row of ``results.json``
    made: tuple[str, ...]  # every file that it may write, beside `CONFIG`
    kept: tuple[str, ...] = ()  # folders of finished parts, which a further run goes on from
    grows: tuple[str, ...] = ()  # options that may differ in a run that goes on

    def claim(self, out: Path, about: Mapping[str, object]) -> None:
        """Make room for a new run: one of the same options is replaced, anything else is left alone.

        Where finished parts are kept, the new run may have more or less of them. The options ``about`` go to
        `CONFIG` with the versions of the packages.

        Raises UserError where the folder holds anything else, or the results of other options, or cannot be
        written.
        """
        earlier = self._earlier(out)
        if out.exists() and earlier is None and not (out.is_dir() and not any(out.iterdir())):
            raise UserError(
                f"{out} already exists and is not an earlier run of this command: choose another folder with"
                f" --out, such as {vacant_name(out)}."
            )
        if earlier is not None and any((out / name).exists() for name in (*self.made, *self.kept)):
            fixed = {key: value for key, value in about.items() if key not in self.grows}
            wanted = cast(dict[str, object], json.loads(json.dumps(fixed)))
            refuse_other_results(out, out, {key: earlier.get(key) for key in wanted}, wanted)
        if out.exists():
            for name in self.made:
                (out / name).unlink(missing_ok=True)
        write_json(out / CONFIG, {**about, "versions": package_versions(), "git_commit": git_commit()})

    def _earlier(self, out: Path) -> dict[str, Any] | None:
        """The options of an earlier run of this study; None where the folder holds none."""
        try:
            config = read_object(out / CONFIG)
        except UserError:
            return None
        return config if config.get("study") == self.name else None


def package_versions() -> dict[str, str]:
    """Versions of `PACKAGES` and of Python."""
    return {"python": platform.python_version(), **{package: version(package) for package in PACKAGES}}
