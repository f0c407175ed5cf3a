"""A report's page as PDF, printed by a Chromium where this machine has one."""

import os
import shutil
import subprocess
from collections.abc import Sequence
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Final

from latentarm.core.files import written_whole

HTML: Final = "report.html"
PDF: Final = "report.pdf"

NAMES: Final = ("chromium", "chromium-browser", "google-chrome", "google-chrome-stable")
"""Of the programs that print, in the order in which they are looked for."""

LONGEST_S: Final = 120.0

WITHOUT: Final = "There is no PDF, because no Chromium is installed: print the page from a browser."
NOT_PRINTED: Final = "There is no PDF, because Chromium could not print the page: print it from a browser."


def find_browser() -> str | None:
    """The Chromium of this machine, or None."""
    return next((path for name in NAMES if (path := shutil.which(name))), None)


def print_page(page: Path, pdf: Path) -> str:
    """Print a page to a PDF, whole or not at all.

    Returns:
        Why there is no PDF, in a sentence; empty where there is one.

    Raises:
        UserError: the file cannot be written.
    """
    browser = find_browser()
    if browser is None:
        return WITHOUT
    with TemporaryDirectory(ignore_cleanup_errors=True) as folder:
        printed = Path(folder) / PDF
        command = [
            browser,
            "--headless=new",
            "--disable-gpu",
            "--no-first-run",
            f"--user-data-dir={folder}/profile",
            "--no-pdf-header-footer",
            *_sandboxed(),
            f"--print-to-pdf={printed}",
            page.resolve().as_uri(),
        ]
        try:
            done = subprocess.run(command, capture_output=True, timeout=LONGEST_S, check=False)
        except (OSError, subprocess.TimeoutExpired):
            return NOT_PRINTED
        if done.returncode != 0 or not printed.is_file():
            return NOT_PRINTED
        with written_whole(pdf) as part:
            shutil.copyfile(printed, part)
    return ""


def _sandboxed() -> Sequence[str]:
    """Arguments without which Chromium does not run as root, as in containers: there it has no sandbox."""
    is_root = hasattr(os, "getuid") and os.getuid() == 0
    return ("--no-sandbox",) if is_root else ()
