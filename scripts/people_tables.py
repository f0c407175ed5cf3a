"""Write docs/evidence/simulated_people.md: the simulated people, their calibration, and held-out people.

python scripts/people_tables.py
"""

import json
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any, Final

from latentarm_research.people.calibration import PROVENANCE
from latentarm_research.people.population import MIRRORED, TRAITS

PAGE: Final = Path(__file__).parents[1] / "docs" / "evidence" / "simulated_people.md"
LOGS: Final = Path(__file__).with_name("people_from_logs.json")
"""Written by `people_from_logs.py`."""


def main() -> None:
    """Write them between their marks."""
    PAGE.write_text(written(PAGE.read_text(encoding="utf-8")), encoding="utf-8")


def written(page: str) -> str:
    """The page with its tables anew."""
    for name, table in (("traits", traits()), ("calibration", calibration()), ("held out", held_out())):
        begin, end = f"<!-- {name}: written by scripts/people_tables.py -->", f"<!-- {name}: end -->"
        before, rest = page.split(begin)
        page = f"{before}{begin}\n{table}\n{end}{rest.split(end)[1]}"
    return page


def traits() -> str:
    """A row for each trait."""
    lines = ["| trait | distribution over people | range | source |", "| --- | --- | --- | --- |"]
    for one in TRAITS:
        unit = f", {one.unit}" if one.unit else ""
        lines.append(
            f"| {one.meaning}{unit} | {one.spread.shape}"
            f" | {_short(one.spread.lowest)} to {_short(one.spread.highest)} | {one.source} |"
        )
    lines.append(
        f"| second axis upside down | {100 * MIRRORED:g} % of people | yes or no"
        " | that a minority inverts it: Corbett and Munneke, Cogn. Res. Princ. Implic., 2025; share chosen |"
    )
    return "\n".join(lines)


def calibration() -> str:
    """The figures before and after."""
    before, after, aim = (PROVENANCE[one] for one in ("before", "after", "aimed_at"))
    low, high = aim["slopes_s_per_bit"]
    share = f"{100 * aim['switching_share']:.1f} % (Herlant et al. 2016)"
    slopes = f"{low} to {high} (Draper et al. 1990, Soukoreff and MacKenzie 2004)"
    rows = [
        ("SD of a push, share of its length, median", "", _figure("push_variation", "{:g}")),
        ("median time of a mode switch, first trial (s)", "", _figure("switch_s", "{:.2f}")),
        ("share of time in mode switches, mean ± SD over people", share, _share),
        ("mode switches in a drive", "", _figure("switches_per_drive", "{:.1f}")),
        ("time of a drive (s)", "", _figure("drive_s", "{:.1f}")),
        ("drives done", "", lambda one: f"{one['drives_done']} of {one['drives']}"),
        ("Fitts's law: slope (s/bit)", slopes, _figure("slope_s_per_bit", "{:.2f}")),
        ("Fitts's law: intercept (s)", "", _figure("intercept_s", "{:.2f}")),
        ("Fitts's law: r² over the means of 9 conditions", "", _figure("r2", "{:.2f}")),
        ("movements that failed", "", lambda one: f"{one['movements_failed']} of {one['movements']}"),
    ]
    lines = ["| simulated | published, of people | before | after |", "| --- | --- | ---: | ---: |"]
    lines += [f"| {name} | {aim or '–'} | {of(before)} | {of(after)} |" for name, aim, of in rows]
    return "\n".join(lines)


def held_out() -> str:
    """How well held-out persons are predicted."""
    found = json.loads(LOGS.read_text(encoding="utf-8"))["held_out"]
    names = {
        "fitted_persons": "the other half of the persons themselves",
        "line": "the same, times and errors by a line over the index of difficulty",
        "simulated_before": "simulated people, not fitted to these persons",
        "simulated_after": "simulated people fitted to the other half",
    }
    measures = ("time", "error", "corrections")
    lines = [
        "| predicted by | "
        + " | ".join(f"{one}, nats" for one in measures)
        + " | all, nats | "
        + " | ".join(f"{one}, in 50 / 90 %" for one in measures)
        + " | persons' times, in 50 / 90 % |",
        "| --- |" + " ---: |" * 8,
    ]
    for name, meaning in names.items():
        one = found[name]
        nats = [f"{value:.2f}" for value in (*one["nats"], sum(one["nats"]))]
        inside = zip(one["covered_0.5"], one["covered_0.9"], strict=True)
        shares = [f"{100 * half:.0f} / {100 * most:.0f} %" for half, most in inside]
        persons = f"{one['persons_0.5']} / {one['persons_0.9']} of 12"
        lines.append(f"| {meaning} | " + " | ".join([*nats, *shares, persons]) + " |")
    return "\n".join(lines)


def _short(value: float) -> str:
    """Three digits, and no exponent."""
    return f"{float(f'{value:.3g}'):g}"


def _figure(name: str, form: str) -> Callable[[Mapping[str, Any]], str]:
    return lambda one: form.format(one[name])


def _share(one: Mapping[str, Any]) -> str:
    return f"{100 * one['switching_share']:.1f} ± {100 * one['switching_share_sd']:.1f} %"


if __name__ == "__main__":
    main()
