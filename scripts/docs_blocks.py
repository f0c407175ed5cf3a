"""Write what pages take from docs/evidence: the README's table, and what of the paper is reproduced.

    python scripts/docs_blocks.py

A box on each study's page counts the verdicts of its evidence. A table with the columns `the paper`, `ours`
and `verdict` is one of verdicts. One rule for all: a figure within one SD of the paper's, on either side, is
reproduced; beyond it, the side decides. A test is reproduced if it has the same sign and lies on the same
side of p = 0.05; a claim, in the cases in which ours shows it.
"""

import re
from collections import Counter
from pathlib import Path

from latentarm_research.studies.properties.cells import PaperVerdict, judge

ROOT = Path(__file__).parents[1]
DOCS = ROOT / "docs"
README_ROWS = ("success rate", "time (s)", "input magnitude (s)", "mode switches")
STUDIES = ("properties", "shared_autonomy", "alignment", "tasks", "studies")
BEGIN, END = "<!-- written by scripts/docs_blocks.py -->", "<!-- end -->"
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
        decimals = len(theirs[1].partition(".")[2])
        sd = float(theirs[2] or 0.5 * 10**-decimals)  # without an SD, half of the last digit
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
            f'!!! abstract "Beside the paper: {found[REPRODUCED]} of {found.total()} reproduced"',
            "    | " + " | ".join(KINDS) + " |",
            "    |" + "---:|" * len(KINDS),
            "    | " + " | ".join(str(found[kind]) for kind in KINDS) + " |",
            "",
            "    *Reproduced*: within one SD on either side; a test, same sign and significance; a claim,",
            "    in each case. Bars, stars and opinions cannot be compared."
            f" [All](evidence/{study}.md#beside-the-paper).",
        ]
    )


def demo_table() -> str:
    """The README's table: a line for each way to steer in the demo."""
    lines = (DOCS / "evidence" / "demo.md").read_text(encoding="utf-8").splitlines()
    table = [[cell.strip() for cell in line.strip("|").split("|")] for line in lines if line.startswith("| ")]
    header = next(row for row in table if row[0] == "mean ± SD")
    measures = {row[0]: row for row in table if len(row) == len(header)}
    chosen = [header, *(measures[name] for name in README_ROWS)]
    rows = ["| " + " | ".join(row[column] for row in chosen) + " |" for column in range(len(header))]
    return "\n".join([rows[0], "|---|" + "---:|" * len(README_ROWS), *rows[1:]])


def between_markers(text: str, block: str) -> str:
    """A page with what stands between its markers replaced."""
    return text[: text.index(BEGIN)] + f"{BEGIN}\n{block}\n{END}" + text[text.index(END) + len(END) :]


def pages() -> dict[Path, str]:
    """Each page with such a block, and the evidence of each study, as they have to be."""
    readme = ROOT / "README.md"
    written = {readme: between_markers(readme.read_text(encoding="utf-8"), demo_table())}
    for study in STUDIES:
        page, evidence = DOCS / f"{study}.md", DOCS / "evidence" / f"{study}.md"
        written[evidence], found = judged(evidence.read_text(encoding="utf-8"))
        written[page] = between_markers(page.read_text(encoding="utf-8"), box(found, study))
    return written


if __name__ == "__main__":
    for path, text in pages().items():
        path.write_text(text, encoding="utf-8")
