"""`latentarm study progress`: how far the people of a served study have come."""

import json as json_format
from collections import Counter
from datetime import UTC, datetime
from statistics import fmean
from typing import TYPE_CHECKING, Any

from tyro.conf import Positional

from latentarm.commands.output import print_renderables, say
from latentarm.runs.options import Json
from latentarm_research.commands.study_data import ServedFolder
from latentarm_research.commands.study_options import Database

if TYPE_CHECKING:
    from latentarm_research.user_studies.serving.store import Standing
    from latentarm_research.user_studies.serving.way import Way


def progress_of_study(folder: Positional[ServedFolder], database: Database = None, json: Json = False) -> int:
    """Show how far the people of a served study have come, also while it is served.

    It lists each person's place, what is due, their drives so far, and when they were last there (UTC).

    For example: latentarm study progress studies/eating-people
    """
    from rich.box import SIMPLE
    from rich.table import Table

    from latentarm_research.user_studies.recorded import read_definition_of
    from latentarm_research.user_studies.serving.kept_options import KeptOptions, read_kept
    from latentarm_research.user_studies.serving.served_store import served_store
    from latentarm_research.user_studies.serving.way import Way
    from latentarm_research.user_studies.sizes import PRESETS

    definition = read_definition_of(folder)
    kept = read_kept(folder) or KeptOptions(information="")
    with served_store(folder, database) as store:
        people = store.people()
    way = Way(definition, PRESETS[kept.preset], kept.seed)
    rows = sorted((_row(way, one) for one in people), key=lambda row: row["last_there"], reverse=True)
    if json:
        print(json_format.dumps(rows, indent=2))
        return 0
    counts = Counter(row["due"] for row in rows)
    found = ", ".join(f"{due}: {count}" for due, count in sorted(counts.items())) or "nobody has come yet"
    say(f"{definition.people} places; {found}.", json)
    if rows:
        table = Table(*(name.replace("_", " ") for name in rows[0]), box=SIMPLE)
        for row in rows:
            table.add_row(*("–" if value is None else str(value) for value in row.values()))
        print_renderables(table)
    return 0


def _row(way: "Way", person: "Standing") -> dict[str, Any]:
    due, order = _due(way, person)
    delays_s = [one.measures["input_delay_s"] for one in person.drives if "input_delay_s" in one.measures]
    return {
        "place": person.number,
        "due": due,
        "way": None if order is None else order + 1,
        "drives": len(person.drives),
        "done": sum(one.ending == "done" for one in person.drives),
        "stops": round(sum(one.measures.get("stops", 0.0) for one in person.drives)),
        "delay_ms": round(1e3 * fmean(delays_s)) if delays_s else None,
        "last_there": datetime.fromtimestamp(person.seen_s, UTC).strftime("%Y-%m-%d %H:%M"),
    }


def _due(way: "Way", person: "Standing") -> tuple[str, int | None]:
    """Name the stage that a person is at, and the condition's place in their order."""
    if person.finished or person.lapsed:
        return "finished" if person.finished else "lapsed", None
    due = way.after(person)
    return (due, None) if isinstance(due, str) else (getattr(due, "kind", "questions"), due.order)
