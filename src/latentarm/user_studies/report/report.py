"""The report of a study: figures, one HTML page, and a PDF of it."""

from pathlib import Path
from typing import Final

from latentarm.files import write_text
from latentarm.style import save_figure
from latentarm.types import Row
from latentarm.user_studies.definition import Definition
from latentarm.user_studies.report.figures import draw, figure_names
from latentarm.user_studies.report.page import Content, report_page
from latentarm.user_studies.report.pdf import WITHOUT, find_browser, print_page
from latentarm.user_studies.report.people import people_lines
from latentarm.user_studies.run import Ran

PAGE: Final = "report.html"
PDF: Final = "report.pdf"

NOT_PRINTED: Final = "Chromium could not print the page, so there is no PDF: open report.html in a browser."


def report_files(definition: Definition) -> tuple[str, ...]:
    """Every file that the report of a study may have."""
    return (PAGE, PDF, *(f"{name}.png" for name in figure_names(definition)))


def write_report(out: Path, ran: Ran, rows: list[Row], command: str) -> str:
    """Draw and write the report of a run with simulated people.

    Args:
        out: the folder of the run.
        ran: what came of it.
        rows: of its ``results.json``.
        command: that repeats it.

    Returns:
        Why there is no PDF, in a sentence; empty where there is one.

    Raises:
        UserError: a file cannot be written.
    """
    who = f"{len(ran.people)} simulated people"
    figures = draw(ran.definition, ran.analysis.trials, ran.traces, who)
    for one in figures:
        save_figure(one.figure, out / f"{one.name}.png")
    people = people_lines(ran.people)
    content = Content(ran.definition, ran.analysis, rows, people, figures, who, command)
    write_text(out / PAGE, report_page(content))
    browser = find_browser()
    if browser is None:
        return WITHOUT
    return "" if print_page(browser, out / PAGE, out / PDF) else NOT_PRINTED
