"""The tables of docs/evidence/simulated_people.md are those of the simulated people."""

import runpy

from documentation import ROOT


def test_the_tables_are_as_the_script_writes_them():
    page = (ROOT / "docs/evidence/simulated_people.md").read_text(encoding="utf-8")
    assert runpy.run_path(str(ROOT / "scripts/people_tables.py"))["written"](page) == page
