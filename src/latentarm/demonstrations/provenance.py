"""The provenance of an episode as JSON, in journals and in a dataset's ``meta/info.json``."""

from collections.abc import Mapping
from dataclasses import asdict, fields
from datetime import UTC, datetime
from typing import Any, Final, cast

from latentarm import __version__
from latentarm.core.types import Provenance

BY_HAND: Final = "by_hand"  # `Provenance.controller` of hand guiding
FIELDS: Final = tuple(field.name for field in fields(Provenance) if field.name != "complete")
"""The fields that are text."""


def provenance_now(
    *,
    person: str = "",
    run: str = "",
    run_fingerprint: str = "",
    profile: str = "",
    device: str = "",
    controller: str = "",
    task_name: str = "",
) -> Provenance:
    """Provenance of an episode that begins now, with this package."""
    return Provenance(
        person=person,
        run=run,
        run_fingerprint=run_fingerprint,
        profile=profile,
        device=device,
        controller=controller,
        task_name=task_name,
        version=__version__,
        started_utc=datetime.now(UTC).isoformat(timespec="seconds"),
    )


def provenance_json(provenance: Provenance) -> dict[str, object]:
    """Plain mapping, ready for ``json.dumps``, without unknown fields."""
    return {name: value for name, value in asdict(provenance).items() if value not in ("", True)}


def parse_provenance(document: object) -> Provenance:
    """The inverse of `provenance_json`; missing fields are unknown. ValueError where one has another type."""
    if not isinstance(document, dict):
        raise ValueError("who recorded an episode must be an object with named fields")
    mapping = cast(Mapping[str, Any], document)
    complete = mapping.get("complete", True)
    texts = {name: mapping.get(name, "") for name in FIELDS}
    if not isinstance(complete, bool) or not all(isinstance(text, str) for text in texts.values()):
        raise ValueError("what is said of who recorded an episode must be text")
    return Provenance(**texts, complete=complete)
