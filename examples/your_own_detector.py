"""Your own detector of things: posts what it sees to `latentarm teleop RUN --objects http:8470`."""

import json
import os
import time
from http.client import HTTPConnection

PORT = int(os.environ.get("OBJECTS_PORT", "8470"))
PROMPTS = {"a white bowl": "bowl", "a blue cup": "cup"}  # what your detector looks for, and the task's names


def detect() -> list[tuple[str, list[float], list[float]]]:
    """Your open-vocabulary detector and pose estimator here: prompts with poses in the arm's base frame."""
    return [("a white bowl", [0.57, 0.18, 0.28], [1.0, 0.0, 0.0, 0.0])]


taken_s = time.monotonic()  # when the picture was taken
things = [
    {
        "name": PROMPTS[prompt],
        "position_m": position,
        "quaternion_wxyz": quaternion,
        "position_sd_m": 0.005,
        "orientation_sd_rad": 0.1,
        "age_s": time.monotonic() - taken_s,
    }
    for prompt, position, quaternion in detect()
]
link = HTTPConnection("127.0.0.1", PORT, timeout=2.0)
try:
    link.request("POST", "/things", json.dumps({"things": things}))
    answer = link.getresponse()
    refused = answer.read()
    print(json.loads(refused)["detail"] if refused else "Posted.")
except OSError:
    print(f"Nobody listens at port {PORT}: start latentarm teleop RUN --objects http:{PORT} first.")
