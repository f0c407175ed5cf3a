"""The provenance of an episode as JSON, in journals and in a dataset's ``meta/info.json``."""

from collections.abc import Mapping
from dataclasses import asdict, fields, replace
from datetime import UTC, datetime
from typing import Any, Final, cast

from latentarm import __version__
from latentarm.core.types import Provenance

BY_HAND: Final = "by_hand"  # `Provenance.controller` of hand guiding
FIELDS: Final = tuple(field.name for field in fields(Provenance) if field.name not in ("complete", "shadow"))
"""The fields that are text."""


def provenance_now(provenance: Provenance) -> Provenance:
    """The provenance of an episode that begins now, with this package."""
    now = datetime.now(UTC).isoformat(timespec="seconds")
    return replace(provenance, version=__version__, started_utc=now)


def provenance_json(provenance: Provenance) -> dict[str, object]:
    """Plain mapping, ready for ``json.dumps``, without unknown fields."""
    usual = asdict(Provenance())
    return {name: value for name, value in asdict(provenance).items() if value != usual[name]}


def parse_provenance(document: object) -> Provenance:
    """The inverse of `provenance_json`; missing fields are unknown. ValueError where one has another type."""
    if not isinstance(document, dict):
        raise ValueError("who recorded an episode must be an object with named fields")
    mapping = cast(Mapping[str, Any], document)
    complete, shadow = mapping.get("complete", True), mapping.get("shadow", False)
    texts = {name: mapping.get(name, "") for name in FIELDS}
    if not isinstance(complete, bool) or not isinstance(shadow, bool):
        raise ValueError("complete and shadow of an episode must be true or false")
    if not all(isinstance(text, str) for text in texts.values()):
        raise ValueError("what is said of who recorded an episode must be text")
    return Provenance(**texts, complete=complete, shadow=shadow)
