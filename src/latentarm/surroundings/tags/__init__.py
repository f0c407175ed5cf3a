"""Poses of things from AprilTags and ArUco markers on them, seen by calibrated cameras."""

from collections.abc import Sequence
from importlib.util import find_spec
from pathlib import Path

from latentarm.core.errors import UserError
from latentarm.surroundings.contract import Source


def check_installed(what: str) -> None:
    """Raise UserError if the extra `tags` is not installed, which ``what`` needs."""
    if any(find_spec(name) is None for name in ("cv2", "av", "aiortc")):
        raise UserError(f"{what} needs the extra `tags`: pip install 'latentarm[tags]'.")


def open_tags(rest: str, names: Sequence[str]) -> Source:
    """Open the source; ``rest`` is the path of a tags file."""
    check_installed("--objects tags")
    from latentarm.surroundings.tags.source import TagSource

    return TagSource(Path(rest).expanduser(), names)
