"""The tries of `page_person.py` as a table, for the scripted person of each input.

For example:

    python scripts/person_table.py page_drives.json
"""

import argparse
import json
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any, Final

import numpy as np

from person_hands import HANDS

Try = dict[str, Any]
KINDS: Final = {"food": "marshmallow", "pour": "pour", "stir": "stir"}
HEAD: Final = (
    "scripted person",
    "task",
    "done",
    "seconds",
    "presses",
    "first step (s)",
    "stops by itself",
    "begun again",
)


def table(found: Sequence[Try]) -> str:
    """A row for each input and kind of task, as Markdown.

    Args:
        found: as `page_person.py` writes them.
    """
    rows = [HEAD, ("---", "---", *(6 * ("---:",)))]
    for name in HANDS:
        for kind, ending in KINDS.items():
            some = [one for one in found if one["input"] == name and one["task"].endswith(ending)]
            if some:
                rows.append(_row(name, kind, some))
        every = [one for one in found if one["input"] == name]
        if every:
            rows.append((name, "**all**", _share(every), "", "", "", _per_try(every), _restarts(every)))
    return "\n".join(f"| {' | '.join(row)} |" for row in rows)


def _row(name: str, kind: str, some: Sequence[Try]) -> tuple[str, ...]:
    done = [one for one in some if one["success"]]
    first = [one for one in some if one["first_step_s"] is not None]
    return (
        name,
        kind,
        _share(some),
        _spread(done, lambda one: one["seconds"]),
        _spread(done, lambda one: one["presses"]),
        _spread(first, lambda one: one["first_step_s"]),
        _per_try(some),
        _restarts(some),
    )


def _share(some: Sequence[Try]) -> str:
    return f"{sum(one['success'] for one in some)} of {len(some)}"


def _per_try(some: Sequence[Try]) -> str:
    return f"{sum(one['stops'] for one in some)} in {len(some)} tries"


def _restarts(some: Sequence[Try]) -> str:
    return str(sum(one["restarts"] for one in some))


def _spread(some: Sequence[Try], of: Callable[[Try], float]) -> str:
    values = [of(one) for one in some]
    if not values:
        return "–"
    spread = f" ± {np.std(values, ddof=1):.0f}" if len(values) > 1 else ""
    return f"{np.mean(values):.0f}{spread}"


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("files", nargs="+", type=Path)
    print(table([one for file in parser.parse_args().files for one in json.loads(file.read_text())]))


if __name__ == "__main__":
    main()
