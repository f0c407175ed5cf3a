"""The report's page as PDF, printed by a Chromium where this machine has one."""

import os
import shutil
import subprocess
from collections.abc import Sequence
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Final

from latentarm.core.files import written_whole

NAMES: Final = ("chromium", "chromium-browser", "google-chrome", "google-chrome-stable")
"""Of the programs that print, in the order in which they are looked for."""

LONGEST_S: Final = 120.0

WITHOUT: Final = (
    "No Chromium is installed, so there is no PDF: open report.html in a browser and print it to a file."
)


def find_browser() -> str | None:
    """The Chromium of this machine, or None."""
    return next((path for name in NAMES if (path := shutil.which(name))), None)


def print_page(browser: str, page: Path, pdf: Path) -> bool:
    """Print a page to a PDF, whole or not at all.

    Args:
        browser: a Chromium.
        page: the HTML file.
        pdf: the file to write.

    Returns:
        Whether the browser printed it.

    Raises:
        UserError: the file cannot be written.
    """
    with TemporaryDirectory(ignore_cleanup_errors=True) as folder:
        printed = Path(folder) / "report.pdf"
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
            return False
        if done.returncode != 0 or not printed.is_file():
            return False
        with written_whole(pdf) as part:
            shutil.copyfile(printed, part)
    return True


def _sandboxed() -> Sequence[str]:
    """Arguments without which Chromium does not run as root, as in containers: there it has no sandbox."""
    is_root = hasattr(os, "getuid") and os.getuid() == 0
    return ("--no-sandbox",) if is_root else ()
