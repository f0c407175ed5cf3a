"""Write the verdicts of docs/evidence on the paper's figures, and the box that counts them on each study's page.

    python scripts/paper_boxes.py

A table with the columns `the paper`, `ours` and `verdict` is one of verdicts. One rule for all: a figure within one
SD of the paper's, on either side, is reproduced; beyond it, the side decides. A test is reproduced if it has the same
sign and lies on the same side of p = 0.05; a claim, in the cases in which ours shows it.
"""

import re
from collections import Counter
from pathlib import Path

from latentarm_research.studies.properties.cells import HALF_A_DIGIT, PaperVerdict, judge

DOCS = Path(__file__).parents[1] / "docs"
STUDIES = ("properties", "shared_autonomy", "alignment", "tasks", "studies")
BEGIN, END = "<!-- box: written by scripts/paper_boxes.py -->", "<!-- box: end -->"
REPRODUCED, IN_FAVOUR, NOT, NOT_COMPARABLE = KINDS = (
    "reproduced",
    "in the method's favour",
    "not reproduced",
    "not comparable",
)
OF_THE_STUDY = {
    str(PaperVerdict.WITHIN): REPRODUCED,
    str(PaperVerdict.IN_FAVOUR): IN_FAVOUR,
    str(PaperVerdict.MISSED): NOT,
}
FIGURE = re.compile(r"(-?[\d.]+)(?: ± ([\d.]+))?(?: %)?")
SHARE = re.compile(r"(\d+) of (\d+)(?: trials)?")
BOUND = re.compile(r"(over|under) (\d+) minutes")


def counts(row: dict[str, str]) -> Counter[str]:
    """How many comparisons with the paper a row holds, by kind."""
    paper, ours = row["the paper"], row["ours"]
    if row["verdict"] in OF_THE_STUDY:
        return Counter({OF_THE_STUDY[row["verdict"]]: 1})
    same = {row.get("same sign", ""), row.get("same significance", "")}
    if same <= {"yes", "no"}:
        return Counter({NOT if "no" in same else REPRODUCED: 1})
    if paper == "in every case" and (share := SHARE.fullmatch(ours)):
        shown, of = map(int, share.groups())
        return Counter({REPRODUCED: shown, NOT: of - shown})
    if (theirs := SHARE.fullmatch(paper)) and (share := SHARE.fullmatch(ours)):
        (some, of), (other, of_ours) = map(int, theirs.groups()), map(int, share.groups())
        mean = some / of
        near = abs(other / of_ours - mean) <= (mean * (1 - mean) / of) ** 0.5
        return Counter({REPRODUCED if near else NOT: 1})
    if (bound := BOUND.search(paper)) and (seconds := re.match(r"(\d+) s on average", ours)):
        over = int(seconds[1]) > 60 * int(bound[2])
        return Counter({REPRODUCED if over == (bound[1] == "over") else NOT: 1})
    if (theirs := FIGURE.fullmatch(paper)) and (mine := FIGURE.fullmatch(ours)):
        sd = float(theirs[2] or HALF_A_DIGIT)
        found = judge(float(mine[1]), float(theirs[1]), sd, row["better"], sees_context=True)
        return Counter({OF_THE_STUDY[str(found)]: 1})
    return Counter({NOT_COMPARABLE: 1})


def judged(evidence: str) -> tuple[str, Counter[str]]:
    """A page of evidence with its verdicts, and how many comparisons it has of each kind."""
    lines, found, header = evidence.splitlines(), Counter[str](), []
    for number, line in enumerate(lines):
        cells = [cell.strip() for cell in line.strip("|").split("|")] if line.startswith("|") else []
        if not header or len(cells) != len(header):
            header = cells if {"the paper", "ours", "verdict"} <= set(cells) else []
        elif not set(line) <= set("|-: "):
            row = dict(zip(header, cells, strict=True))
            of = counts(row)
            found += of
            if row["verdict"] not in OF_THE_STUDY:
                said = [kind if of.total() == 1 else f"{of[kind]} {kind}" for kind in KINDS if of[kind]]
                lines[number] = "| " + " | ".join([*cells[:-1], ", ".join(said)]) + " |"
    return "\n".join(lines) + "\n", found


def box(found: Counter[str], study: str) -> str:
    """The box of a page."""
    return "\n".join(
        [
            BEGIN,
            f'!!! abstract "Beside the paper: {found[REPRODUCED]} of {found.total()} reproduced"',
            "    | " + " | ".join(KINDS) + " |",
            "    |" + "---:|" * len(KINDS),
            "    | " + " | ".join(str(found[kind]) for kind in KINDS) + " |",
            "",
            "    A figure is *reproduced* within one SD of the paper's, on either side; a test, with the same sign on the same side"
            " of",
            "    p = 0.05; a claim, in each case that shows it. Beyond one SD, better for the method is counted apart. Bars, stars"
            " and",
            f"    opinions cannot be compared. [Each one](evidence/{study}.md#beside-the-paper).",
            END,
        ]
    )


def pages() -> dict[Path, str]:
    """Each page of a study and of its evidence, as it has to be."""
    written: dict[Path, str] = {}
    for study in STUDIES:
        page, evidence = DOCS / f"{study}.md", DOCS / "evidence" / f"{study}.md"
        written[evidence], found = judged(evidence.read_text(encoding="utf-8"))
        text = page.read_text(encoding="utf-8")
        begin, end = text.index(BEGIN), text.index(END) + len(END)
        written[page] = text[:begin] + box(found, study) + text[end:]
    return written


if __name__ == "__main__":
    for path, text in pages().items():
        path.write_text(text, encoding="utf-8")
