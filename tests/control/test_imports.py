import subprocess
import sys
from pathlib import Path

import latentarm

ONLINE = ("control", "recordings", "safety")
HEAVY = ("torch", "mujoco", "mink", "pyarrow", "h5py", "matplotlib", "sklearn", "scipy")


def test_the_online_side_loads_neither_torch_nor_a_physics_engine():
    root = Path(latentarm.__file__).parent
    names = [
        ".".join(["latentarm", *path.relative_to(root).with_suffix("").parts])
        for package in ONLINE
        for path in (root / package).rglob("*.py")
        if path.name != "__init__.py"
    ]
    assert len(names) > 20
    code = f"import sys, {', '.join(names)}; print([name for name in {HEAVY} if name in sys.modules])"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"
