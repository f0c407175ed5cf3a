"""Redraw the figures of ``docs/figures`` by the commands that the pages name.

``python scripts/docs_figures.py demo alignment`` redraws those of some commands. All take about an
hour of one core: demo 6 minutes, properties 11, shared-autonomy 19, alignment 27 (measured).
``compare`` needs the recordings that are not part of the repository, and about four hours of one core: it
runs only if named.
"""

import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

FIGURES = Path(__file__).resolve().parents[1] / "docs" / "figures"
RECORDINGS = FIGURES.parents[2] / "shared" / "demonstrations"
RECORDED = ("pick_banana", "pick_cereal", "pour_coffee")
"""Archives ``panda_NAME.npz`` there, which `compare` is drawn from."""

COMMANDS = {
    "demo": ["demo"],
    "properties": ["reproduce", "properties", "--preset", "paper"],
    "shared-autonomy": ["reproduce", "shared-autonomy", "--preset", "paper", "--seed", "2"],
    "alignment": ["reproduce", "alignment", "--preset", "paper", "--seed", "2"],
    "tasks": ["reproduce", "tasks", "--preset", "paper"],
    "harmonic": ["study", "run", "harmonic"],
    "compare": ["compare", "--demonstrations", *RECORDED],
}
PREFIXES = {
    "demo": "",
    "properties": "properties_",
    "shared-autonomy": "shared_autonomy_",
    "alignment": "alignment_",
    "tasks": "tasks_",
    "harmonic": "harmonic_",
    "compare": "compare_",
}
"""What a command's figures are called in ``docs/figures``, before their own name."""


def redraw(name: str) -> None:
    """Run one command and put those of its figures in place that a page shows already."""
    with tempfile.TemporaryDirectory() as folder:
        out = Path(folder) / "made"
        latentarm = [sys.executable, "-m", "latentarm"]
        for recorded in RECORDED if name == "compare" else ():
            archive = str(RECORDINGS / f"panda_{recorded}.npz")
            subprocess.run([*latentarm, "import", archive, recorded], cwd=folder, check=True)
        done = subprocess.run([*latentarm, *COMMANDS[name], "--out", str(out)], cwd=folder, check=False)
        if done.returncode not in (0, 1):  # 1: something was measured and not reached
            raise SystemExit(done.returncode)
        for made in sorted(out.glob("*.png")):
            shown = FIGURES / (PREFIXES[name] + made.name)
            if shown.exists():
                shutil.copyfile(made, shown)
                print(f"{name}: {shown.name}")


if __name__ == "__main__":
    for chosen in sys.argv[1:] or [name for name in COMMANDS if name != "compare"]:
        redraw(chosen)
