"""The folder of a command's results, claimed before any work is done, and which code made them."""

import hashlib
import json
import platform
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from importlib.metadata import version
from pathlib import Path
from typing import Any, Final, cast

import latentarm
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

        Raises UserError where `check` does, or the folder cannot be written.
        """
        self.check(out, about)
        if out.exists():
            for name in self.made:
                (out / name).unlink(missing_ok=True)
        write_options(out, about)

    def check(self, out: Path, about: Mapping[str, object]) -> None:
        """Raise a UserError where the folder holds anything else, or the results of other options."""
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

    def _earlier(self, out: Path) -> dict[str, Any] | None:
        """The options of an earlier run of this study; None where the folder holds none."""
        try:
            config = read_object(out / CONFIG)
        except UserError:
            return None
        return config if config.get("study") == self.name else None


def write_options(out: Path, about: Mapping[str, object]) -> None:
    """Write the options of a run to `CONFIG`, with the versions of the packages."""
    write_json(out / CONFIG, {**about, "versions": package_versions(), "git_commit": git_commit()})


def package_versions() -> dict[str, str]:
    """Versions of `PACKAGES` and of Python."""
    return {"python": platform.python_version(), **{package: version(package) for package in PACKAGES}}


_PACKAGES: Final = (Path(latentarm.__file__).parent, Path(__file__).parents[1])

_REPORTS: Final = ("studies", "user_studies", "web", "commands", "testing", "cli.py")
"""Parts of the packages that no part below them computes with."""


def source_digest(modules: Sequence[Path]) -> str:
    """The first 16 digits of the SHA-256 of the code below the studies, and of some modules more."""
    digest = hashlib.sha256()
    below = {
        path
        for package in _PACKAGES
        for path in package.rglob("*")
        if path.suffix in (".py", ".json") and path.relative_to(package).parts[0] not in _REPORTS
    }
    for path in sorted({*below, *modules}, key=_named):
        digest.update(f"{_named(path)}\n".encode())
        digest.update(path.read_bytes())
    return digest.hexdigest()[:16]


def _named(path: Path) -> str:
    """A file's place, the same on every computer."""
    package = next(package for package in _PACKAGES if path.is_relative_to(package))
    return f"{package.name}/{path.relative_to(package).as_posix()}"
