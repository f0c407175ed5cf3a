"""The rows of a file of figures, for tests."""

import json

from latentarm.core.types import Row


def rows_in(path):
    return [Row(**entry) for entry in json.loads(path.read_text())["rows"]]
