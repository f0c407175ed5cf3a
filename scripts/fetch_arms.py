"""Fetch the model files of the arms in scripts/arms.toml: unpacked into a cache, never installed.

    python scripts/fetch_arms.py [CACHE]

CACHE is $LATENTARM_ARMS, or ~/.cache/latentarm/arms. A package that is there already is left alone.
"""

import os
import subprocess
import sys
import tempfile
import tomllib
import zipfile
from pathlib import Path

ARMS = Path(__file__).with_name("arms.toml")
CACHE = Path(os.environ.get("LATENTARM_ARMS") or Path.home() / ".cache" / "latentarm" / "arms")


def fetch(name: str, version: str, folders: list[str], cache: Path) -> None:
    """Download one package's wheel and unpack some of its folders, and its licences."""
    target = cache / f"{name}-{version}"
    if target.is_dir():
        print(f"{name} {version} is there already")
        return
    cache.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory(dir=cache) as aside:
        pip = [sys.executable, "-m", "pip", "download", "--quiet", "--disable-pip-version-check", "--no-deps"]
        subprocess.run([*pip, "--only-binary=:all:", "--dest", aside, f"{name}=={version}"], check=True)
        (wheel,) = Path(aside).glob("*.whl")
        unpacked = Path(aside) / "unpacked"
        with zipfile.ZipFile(wheel) as archive:
            for member in archive.namelist():
                licence = ".dist-info/" in member and "LICEN" in member.upper()
                if licence or any(member.startswith(f"{folder}/") for folder in folders):
                    archive.extract(member, unpacked)
        unpacked.rename(target)
    print(f"{name} {version} is in {target}")


def main() -> None:
    """Fetch every package."""
    cache = Path(sys.argv[1]) if len(sys.argv) > 1 else CACHE
    packages = tomllib.loads(ARMS.read_text(encoding="utf-8"))["packages"]
    for name, package in packages.items():
        fetch(name, package["version"], package["folders"], cache)


if __name__ == "__main__":
    main()
