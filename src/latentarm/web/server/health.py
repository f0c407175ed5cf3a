"""`/health` for what watches the server, and `/metrics` for Prometheus (text format 0.0.4)."""

import logging
from collections import Counter
from collections.abc import Mapping
from typing import Final, final

from starlette.requests import Request
from starlette.responses import PlainTextResponse, Response
from starlette.routing import Route

from latentarm.web.cameras.process import CameraProcess
from latentarm.web.protocol.notice import Notice
from latentarm.web.protocol.report import Report
from latentarm.web.server.answers import NO_STORE, json_answer
from latentarm.web.server.connected_pages import ConnectedPages
from latentarm.web.server.history import History
from latentarm.web.server.security import HEALTH
from latentarm.web.server.states import States

METRICS: Final = "/metrics"
CONTENT_TYPE: Final = "text/plain; version=0.0.4"

_ENABLED: Final = ("ready", "moving")
_LONGEST_TICK_S: Final = 0.5
_LOG: Final = logging.getLogger(__name__)


@final
class Health:
    """Counts and logs what reports say. It knows no names of people."""

    def __init__(
        self, states: States, connected: ConnectedPages, history: History, cameras: CameraProcess | None
    ) -> None:
        self._states, self._connected, self._history, self._cameras = states, connected, history, cameras
        self._before: Report | None = None
        self._stops: Counter[str] = Counter()
        self._drive_s = 0.0
        states.heard.append(self._hear)

    def routes(self) -> list[Route]:
        return [Route(HEALTH, self._health), Route(METRICS, self._metrics)]

    @property
    def trouble(self) -> Notice | None:
        """Why nobody can drive, or nothing is kept; None if all is well. Loading another run is well."""
        report = self._states.report
        if not self._states.loading and (away := self._states.away) is not None:
            return away
        if report is not None and report.lost:
            return report.reason
        return self._history.problem

    def _hear(self, report: Report) -> None:
        before, self._before = self._before, report
        if before is None:
            return
        was, enabled = (one.phase in _ENABLED for one in (before, report))
        if was and enabled:
            self._drive_s += min(max(report.time_s - before.time_s, 0.0), _LONGEST_TICK_S)
        elif enabled:
            _LOG.info("The arm is enabled.")
        elif was:
            why = report.reason or Notice(code="stop_pressed")
            self._stops[why.code] += 1
            _LOG.info("Stopped (%s): %s", why.code, why.unnamed)
        if report.lost and not before.lost:
            why = report.reason or Notice(code="arm_lost")
            _LOG.warning("The connection to the arm is lost (%s): %s", why.code, why.unnamed)
        elif before.lost and not report.lost:
            _LOG.warning("The arm is connected again.")

    async def _health(self, _: Request) -> Response:
        trouble = self.trouble
        said = {"ok": trouble is None, "reason": None if trouble is None else trouble.code}
        return json_answer(said, 200 if trouble is None else 503)

    async def _metrics(self, _: Request) -> Response:
        pictures = {} if self._cameras is None else await self._cameras.ages_s()
        report, quiet_s = self._states.report, self._states.quiet_s
        late = {} if report is None else {(): report.late_share}
        readings = {} if report is None else {(): report.reading_age_s + quiet_s}
        ages = {(("camera", name),): age_s for name, age_s in pictures.items()}
        stops = {(("code", code),): float(count) for code, count in self._stops.items()}
        families = (
            _family("up", "gauge", "1 if /health says ok", {(): float(self.trouble is None)}),
            _family("late_ticks_ratio", "gauge", "share of the control loop's ticks that were late", late),
            _family("reading_age_seconds", "gauge", "age of the arm's newest usable reading", readings),
            _family("picture_age_seconds", "gauge", "age of a watched camera's newest picture", ages),
            _family("stops_total", "counter", "stops of an enabled arm, by code", stops),
            _family("pages", "gauge", "connected pages", {(): float(self._connected.count)}),
            _family("drive_seconds_total", "counter", "time that the arm was enabled", {(): self._drive_s}),
        )
        return PlainTextResponse("".join(families), media_type=CONTENT_TYPE, headers=NO_STORE)


def _family(name: str, kind: str, help_: str, samples: Mapping[tuple[tuple[str, str], ...], float]) -> str:
    """The lines of a metric; a sample has the pairs of its labels, and a value."""
    lines = [f"# HELP latentarm_{name} {help_}", f"# TYPE latentarm_{name} {kind}"]
    for labels, value in samples.items():
        pairs = ",".join(f'{label}="{_escaped(text)}"' for label, text in labels)
        lines.append(f"latentarm_{name}{f'{{{pairs}}}' if pairs else ''} {value!r}")
    return "\n".join(lines) + "\n"


def _escaped(text: str) -> str:
    return text.replace("\\", r"\\").replace('"', r"\"").replace("\n", r"\n")
