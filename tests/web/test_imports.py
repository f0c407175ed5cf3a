"""torch, scikit-learn and what decodes video, and their seconds, stay out of the processes that drive."""

import subprocess
import sys


def test_neither_the_server_nor_the_control_process_loads_what_takes_long(trained):
    code = (
        "import sys; from pathlib import Path;"
        "import latentarm.web.server.app, latentarm.web.server.pages, latentarm.web.arm_process.process;"
        "from latentarm.web.arm_process.drive_setup import Spec, load_setup;"
        f"load_setup(Spec(Path({str(trained)!r}))).step();"
        "print({'torch', 'sklearn', 'aiortc', 'av'} & set(sys.modules))"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout == "set()\n"
