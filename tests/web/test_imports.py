"""torch and its seconds stay out of the processes that drive."""

import subprocess
import sys


def test_neither_the_server_nor_the_control_process_loads_torch(trained):
    code = (
        "import sys; from pathlib import Path;"
        "import latentarm.web.server, latentarm.web.page, latentarm.web.control_process;"
        "from latentarm.web.setting import Spec, load_setting;"
        f"load_setting(Spec(Path({str(trained)!r}))).step();"
        "print('torch' in sys.modules)"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout == "False\n"
