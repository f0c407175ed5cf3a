"""How old the pictures of two cameras are on the page, and whether the arm keeps its deadlines meanwhile.

Both cameras are the test pattern, whose pixels say when each picture was taken; a Chromium on the same
machine reads them as it shows them. The arrow keys drive the arm to and fro. With --loss, a relay
between page and server drops that share of the UDP packets, each way, at random. For example, on two cores:

    taskset -c 0,1 python scripts/camera_latency.py --seconds 60 --loss 0 0.05 --out cameras.json
"""

import argparse
import json
import multiprocessing
import os
import random
import re
import select
import socket
import threading
import time
from collections.abc import Sequence
from contextlib import ExitStack, suppress
from multiprocessing.sharedctypes import Synchronized
from pathlib import Path
from typing import Any

import numpy as np
from playwright.sync_api import Browser, Page, Route
from websockets.sync.client import connect

from latentarm.web.cameras.clock_pattern import BITS, ROWS
from latentarm.web.cameras.picture import MOST_HIGH
from teleop_page import USUAL_GL, chromium, served, tell
from teleop_throttled import VIEWPORT, Watcher, to_and_fro

CAMERAS = ("front", "side")
SETTLE_MS = 5000
READ = """([bits, rows, high]) => {
  window.seen = [];
  window.greyed = [0, 0];
  setInterval(() => {
    for (const { dataset } of document.querySelectorAll(".camera")) {
      window.greyed[Number(dataset.old === "true")] += 1;
    }
  }, 100);
  document.querySelectorAll(".camera video").forEach((video, number) => {
    const canvas = Object.assign(document.createElement("canvas"), { height: 1 });
    const look = (_, { expectedDisplayTime, width, height }) => {
      canvas.width = width;
      const pen = canvas.getContext("2d", { willReadFrequently: true });
      pen.drawImage(video, 0, (rows / 2) * (height / high), width, 1, 0, 0, width, 1);
      const { data } = pen.getImageData(0, 0, width, 1);
      let code = 0n;
      for (let bar = 0; bar < bits; bar += 1) {
        const bit = BigInt(data[4 * Math.floor((bar + 0.5) * (width / bits))] > 128);
        code = (code << 1n) | (bit ^ (code & 1n));
      }
      // The canvas gets what the video shows now, which may be a later picture than this call is about.
      const shown = performance.timeOrigin + Math.max(expectedDisplayTime, performance.now());
      const age = Number(BigInt.asIntN(bits, BigInt(Math.round(shown)) - code));
      window.seen.push([number, age]);
      video.requestVideoFrameCallback(look);
    };
    video.requestVideoFrameCallback(look);
  });
}"""


Counts = Sequence["Synchronized[int]"]
"""Packets that a relay has passed on, and those that it has dropped."""


def relay(port: int, own: socket.socket, loss: float, seed: int, counts: Counts) -> None:
    """Pass UDP packets on between a page and a server, and drop some, each way.

    Args:
        port: of the server, on the loopback.
        own: where the page sends to.
        loss: share of the packets that is dropped.
        seed: of which.
        counts: are counted up.
    """
    draws = random.Random(seed)  # noqa: S311 - nothing is secret here
    page = None
    with own, socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as onward:
        onward.connect(("127.0.0.1", port))
        while True:
            for ready in select.select([own, onward], [], [])[0]:
                with suppress(OSError):
                    if ready is own:
                        packet, page = own.recvfrom(1 << 16)
                    else:
                        packet = onward.recv(1 << 16)
                    drop = draws.random() < loss
                    counts[drop].value += 1
                    if drop:
                        continue
                    if ready is own:
                        onward.send(packet)
                    elif page is not None:
                        own.sendto(packet, page)


def through_relays(page: Page, loss: float, seed: int, counts: Counts, stack: ExitStack) -> None:
    """Have the page's video come through a relay that drops packets.

    Args:
        page: not yet opened.
        loss: share of the packets.
        seed: of which are dropped.
        counts: see `relay`.
        stack: ends the relays.
    """

    def answer(route: Route) -> None:
        response = route.fetch()
        body = response.json()
        if response.ok:
            own = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
            own.bind(("127.0.0.1", 0))
            port = re.search(r"a=candidate:.* 127\.0\.0\.1 (\d+) typ host", body["sdp"])
            assert port is not None  # noqa: S101 - else nothing would be measured
            process = multiprocessing.get_context("fork").Process(
                target=relay, args=[int(port[1]), own, loss, seed, counts], daemon=True
            )
            process.start()
            stack.callback(process.kill)
            body["sdp"] = body["sdp"].replace(f" 127.0.0.1 {port[1]} ", f" 127.0.0.1 {own.getsockname()[1]} ")
            own.close()
        route.fulfill(response=response, body=json.dumps(body))

    page.route("**/cameras", answer)


def measure(browser: Browser, address: str, seconds: float, loss: float, seed: int) -> dict[str, Any]:
    """Drive for so long while both cameras are seen.

    Args:
        browser: opens the page.
        address: of the page.
        seconds: how long.
        loss: share of the packets of the video that is dropped, each way.
        seed: of which.

    Returns:
        The figures.
    """
    watcher = Watcher()
    page = browser.new_page(viewport=VIEWPORT)
    counts = [multiprocessing.Value("q"), multiprocessing.Value("q")]
    with ExitStack() as stack:
        if loss:
            through_relays(page, loss, seed, counts, stack)
        page.goto(address)
        page.locator("#status[data-phase=disengaged]").wait_for()
        while not page.evaluate("[...document.querySelectorAll('video')].every((one) => one.videoWidth)"):
            page.wait_for_timeout(100)
        page.wait_for_timeout(SETTLE_MS)
        socket_address = f"{address.replace('http', 'ws', 1)}/drive"
        with connect(socket_address, origin=address, compression=None) as states:
            listener = threading.Thread(target=watcher.listen, args=[states], daemon=True)
            listener.start()
            states.send(json.dumps({"type": "hello", "version": 1, "name": "counts"}))
            page.evaluate(READ, [BITS, ROWS, MOST_HIGH])
            began_s = time.monotonic()
            presses = to_and_fro(page, watcher, began_s + seconds)
            took_s = time.monotonic() - began_s
            seen = np.array(page.evaluate("seen"), float).reshape(-1, 2)
            clear, grey = page.evaluate("greyed")
        listener.join()
        page.context.close()
    ages = {
        name: {
            "pictures_per_second": round(len(age) / took_s, 1),
            "age_ms": {
                "median": round(float(np.median(age)), 1),
                "p95": round(float(np.percentile(age, 95)), 1),
                "p99": round(float(np.percentile(age, 99)), 1),
            },
        }
        for number, name in enumerate(CAMERAS)
        if len(age := seen[seen[:, 0] == number, 1])
    }
    return {
        "loss": loss,
        "packets_relayed_and_dropped": [count.value for count in counts],
        "seconds": round(took_s, 1),
        "cameras": ages,
        "share_of_time_grey": round(grey / (clear + grey), 4) if ages else None,
        "deadlines_met": round(1.0 - watcher.state["late_share"], 5),
        "enabled_s": round(watcher.enabled_s, 1),
        "presses_of_enable": presses,
        "stops": watcher.stops,
        "load_average": os.getloadavg()[0],
    }


def main() -> None:
    """Print the figures, and write them where asked."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("run", type=Path, nargs="?", help="a trained run; end-effector control without one")
    parser.add_argument("--seconds", type=float, default=60.0, help="of driving, for each loss")
    parser.add_argument(
        "--loss", type=float, nargs="+", default=[0.0, 0.05], help="shares of packets dropped"
    )
    parser.add_argument("--seed", type=int, default=0, help="of which packets are dropped")
    parser.add_argument("--without", action="store_true", help="drive without cameras too, for comparison")
    parser.add_argument("--out", type=Path, help="file for the figures")
    chosen = parser.parse_args()
    words = [word for name in CAMERAS for word in ("--camera", f"{name}=testsrc")]
    found = []
    drives: list[tuple[list[str], float]] = [([], 0.0)] if chosen.without else []
    drives += [(words, loss) for loss in chosen.loss]
    for options, loss in drives:
        with served(chosen.run, options=options) as site, chromium(USUAL_GL) as browser:
            found.append(measure(browser, site.address, chosen.seconds, loss, chosen.seed))
    usable = len(os.sched_getaffinity(0))
    tell({"usable_cores": usable, "seed": chosen.seed, "measured": found}, chosen.out)


if __name__ == "__main__":
    main()
