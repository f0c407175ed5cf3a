"""The report of a study: figures, one HTML page, and a PDF of it."""

from pathlib import Path
from typing import TYPE_CHECKING, Final

from latentarm.core.files import write_text
from latentarm.core.style import save_figure
from latentarm.core.types import Row
from latentarm_research.user_studies.analysis.analysis import Analysis
from latentarm_research.user_studies.answers.scales import Ratings
from latentarm_research.user_studies.definition import Definition
from latentarm_research.user_studies.report.figures import draw, figure_names
from latentarm_research.user_studies.report.page import Content, report_page
from latentarm_research.user_studies.report.pdf import WITHOUT, find_browser, print_page
from latentarm_research.user_studies.report.people import people_lines
from latentarm_research.user_studies.report.whose import REAL, SIMULATED

if TYPE_CHECKING:
    from latentarm_research.user_studies.recorded import Recorded
    from latentarm_research.user_studies.run import Ran

PAGE: Final = "report.html"
PDF: Final = "report.pdf"

NOT_PRINTED: Final = "Chromium could not print the page, so there is no PDF: open report.html in a browser."


def report_files(definition: Definition) -> tuple[str, ...]:
    """Every file that the report of a study may have."""
    return (PAGE, PDF, *(f"{name}.png" for name in figure_names(definition)))


def write_report(out: Path, ran: "Ran", rows: list[Row], command: str) -> str:
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
    who, people = ran.sizes.people(len(ran.people)), people_lines(ran.people)
    figures = draw(ran.definition, ran.analysis.trials, ran.traces, who)
    return write_content(
        out, Content(ran.definition, ran.sizes, ran.analysis, rows, people, figures, who, SIMULATED, command)
    )


def write_report_of(
    out: Path,
    recorded: "Recorded",
    analysis: Analysis,
    rows: list[Row],
    ratings: Ratings | None,
    command: str,
) -> str:
    """Draw and write the report of recorded trials.

    Args:
        out: a folder.
        recorded: the trials, and whose they are.
        analysis: of them.
        rows: of ``results.json``.
        ratings: of people's answers, if there are any.
        command: that repeats it.

    Returns:
        Why there is no PDF, in a sentence; empty where there is one.

    Raises:
        UserError: a file cannot be written.
    """
    who = recorded.who
    people = people_lines(recorded.simulated) if recorded.simulated else []
    figures = draw(recorded.definition, analysis.trials, recorded.traces, who, ratings)
    words = SIMULATED if recorded.people_are == "simulated" else REAL
    return write_content(
        out,
        Content(
            recorded.definition, recorded.sizes, analysis, rows, people, figures, who, words, command, ratings
        ),
    )


def write_content(out: Path, content: Content) -> str:
    """Write figures, page and PDF.

    Returns:
        Why there is no PDF, in a sentence; empty where there is one.

    Raises:
        UserError: a file cannot be written.
    """
    for one in content.figures:
        save_figure(one.figure, out / f"{one.name}.png")
    write_text(out / PAGE, report_page(content))
    browser = find_browser()
    if browser is None:
        return WITHOUT
    return "" if print_page(browser, out / PAGE, out / PDF) else NOT_PRINTED
