"""`/health` says whether the server is well and why not; Prometheus can read `/metrics`."""

import os
import re
import signal

import httpx

from latentarm.web.arm_process.drive_setup import Spec

from .conftest import wait_for


def test_health_says_why_and_metrics_can_be_read_by_prometheus(serve, tmp_path):
    with serve(Spec(out=tmp_path)) as site, site.page() as page:
        assert httpx.get(f"{site.origin}/health").json() == {"ok": True, "reason": None}
        page.drive(1.0, 0.0)
        page.send(type="stop")
        page.wait(lambda state: state["phase"] in ("disengaged", "neutral_needed"))
        answer = httpx.get(f"{site.origin}/metrics")
        assert answer.headers["content-type"] == "text/plain; version=0.0.4; charset=utf-8"
        samples = parsed(answer.text)
        assert samples["latentarm_up", ()] == 1.0
        assert samples["latentarm_pages", ()] == 1.0
        assert samples["latentarm_stops_total", (("code", "stop_pressed_by"),)] >= 1.0
        assert samples["latentarm_drive_seconds_total", ()] > 0.1
        assert 0.0 <= samples["latentarm_reading_age_seconds", ()] < 5.0
        assert 0.0 <= samples["latentarm_late_ticks_ratio", ()] <= 1.0
        assert "Ada" not in answer.text
        os.kill(site.control._process.pid, signal.SIGKILL)
        down = wait_for(lambda: (said := httpx.get(f"{site.origin}/health")).status_code == 503 and said)
        assert down.json()["reason"] in ("arm_process_silent", "arm_process_ended")
        assert parsed(httpx.get(f"{site.origin}/metrics").text)["latentarm_up", ()] == 0.0


def parsed(text):
    """The samples of Prometheus' text format 0.0.4: by name and labels. Refuses what its grammar does."""
    samples, types = {}, {}
    assert text.endswith("\n")
    label = r'[a-zA-Z_][a-zA-Z0-9_]*="(?:[^"\\\n]|\\[\\"n])*"'
    for line in text.splitlines():
        if line.startswith("# "):
            _, kind, name, rest = line.split(" ", 3)
            assert kind in ("HELP", "TYPE")
            if kind == "TYPE":
                assert rest in ("counter", "gauge", "histogram", "summary", "untyped")
                assert name not in types
                types[name] = rest
            continue
        found = re.fullmatch(rf"([a-zA-Z_:][a-zA-Z0-9_:]*)(?:\{{((?:{label},?)*)\}})? (\S+)", line)
        assert found, line
        name, labels, value = found.groups()
        assert name in types, "a sample comes after its TYPE"
        assert types[name] != "counter" or name.endswith("_total")
        pairs = tuple(re.findall(r'([a-zA-Z_]\w*)="((?:[^"\\]|\\.)*)"', labels or ""))
        assert (name, pairs) not in samples
        samples[name, pairs] = float(value)
    return samples
